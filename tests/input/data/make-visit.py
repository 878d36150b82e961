#!/usr/bin/env python3
"""Writes panel-visit.events beside this file: a visitor's two fingers and a tap on the test panel.

After a word that touches nothing there is time for a kiosk to start; then, with pauses, two fingers
part to twice their distance, one drags, and one taps in twenty places, some of them a part.
"""
import os

SLOT, ID, X, Y, SIZE = 0x2F, 0x39, 0x35, 0x36, 0x30
lines = ["# EVEMU 1.2", "# device /dev/input/event5", "# Written by make-visit.py."]
clock_us = 100_100_000
next_id = 1


def say(kind, code, value):
    # umockdev reads a fraction with leading zeros as octal: there are none.
    assert clock_us % 1_000_000 >= 100_000
    lines.append(f"E: {clock_us // 1_000_000}.{clock_us % 1_000_000:06d} {kind:04X} {code:04X} {value}")


def sync():
    say(0, 0, 0)


def wait(us):
    global clock_us
    clock_us += us
    if clock_us % 1_000_000 < 100_000:
        clock_us += 100_000


def down(slot, x, y, first=True):
    global next_id
    say(3, SLOT, slot)
    say(3, ID, next_id)
    say(3, SIZE, 120)
    say(3, X, x)
    say(3, Y, y)
    if first:
        say(1, 0x14A, 1)
    sync()
    next_id += 1


def up(slot, last=True):
    say(3, SLOT, slot)
    say(3, ID, -1)
    if last:
        say(1, 0x14A, 0)
    sync()


def pinch(middle_x, y, start, end, steps):
    down(0, middle_x - start, y)
    wait(10_000)
    down(1, middle_x + start, y, first=False)
    for step in range(1, steps + 1):
        wait(20_000)
        half = start + (end - start) * step // steps
        for slot, x in ((0, middle_x - half), (1, middle_x + half)):
            say(3, SLOT, slot)
            say(3, X, x)
        sync()
    wait(100_000)
    up(0, last=False)
    wait(10_000)
    up(1)


def drag(x, y, dx, steps):
    down(0, x, y)
    for step in range(1, steps + 1):
        wait(20_000)
        say(3, SLOT, 0)
        say(3, X, x + dx * step // steps)
        sync()
    wait(150_000)
    up(0)


def tap(x, y):
    down(0, x, y)
    wait(60_000)
    up(0)


say(3, SLOT, 0)
sync()
wait(15_000_000)
pinch(2048, 1900, 400, 800, 20)
wait(4_000_000)
drag(2300, 2000, -500, 20)
wait(3_000_000)
for y in (1200, 1700, 2200, 2700):
    for x in (1200, 1600, 2000, 2400, 2800):
        tap(x, y)
        wait(900_000)
tap(2048, 4090)  # a last word, so that the pause before it is kept

with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), "panel-visit.events"), "w") as out:
    out.write("\n".join(lines) + "\n")
