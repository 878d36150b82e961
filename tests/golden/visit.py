"""Writes one visit through every state, for a panel of 960 x 540: visit.py FOLDER makes visit.touch
(docs/input.md) and shots.txt. The bar, the first row of the search, a card and the closing controls are at the
same place in every language."""
import sys

HOME, SEARCH, TOURS, LIGHT, SECTION, LARGE, REACH = [(x, 516) for x in (23, 128, 163, 199, 234, 269, 304)]
ROW, CARD, CLOSE, PICTURE_CLOSE, SECOND_TOUR = (720, 75), (480, 430), (915, 22), (933, 27), (480, 420)
WIDEN = (824, 20)

touches, shots = [], []
now = 9500


def say(what, finger, place):
    touches.append(f"{now} {what} {finger} {place[0]:.0f} {place[1]:.0f}")


def tap(place, then=600):
    global now
    say("down", 0, place)
    now += 80
    say("up", 0, place)
    now += then


def move(*fingers, then=600, steps=20):
    """Each finger from a place to a place, and still before it lifts: nothing is flung."""
    global now
    for finger, (begin, _) in enumerate(fingers):
        say("down", finger, begin)
    for step in range(1, steps + 1):
        now += 20
        for finger, (begin, end) in enumerate(fingers):
            say("move", finger, [a + (b - a) * step / steps for a, b in zip(begin, end)])
    now += 200
    for finger, (_, end) in enumerate(fingers):
        say("up", finger, end)
    now += then


def shot(name, after):
    """The picture is at rest by then."""
    global now
    now += after
    shots.append(f"{now} {name}")
    now += 500


shots.append("8800 help")
move(((480, 200), (640, 200)))
shot("far", 5000)
move(((440, 260), (330, 260)), ((520, 260), (630, 260)))
shot("near", 6000)
tap(HOME, 3000)
tap(LIGHT)
shot("light", 4000)
tap(LIGHT)
tap(SECTION)
shot("section", 4000)
tap(SECTION)
tap(SEARCH, 1500)
shot("search", 1500)
tap(ROW)
shot("card", 6000)
tap(CARD)
shot("page", 6000)
move(((720, 470), (720, 130)))
shot("read", 2000)
move(((720, 130), (720, 530)))
tap(WIDEN, 1000)
shot("full", 3000)
tap(WIDEN, 2000)
tap((720, 300))
shot("picture", 2500)
tap(PICTURE_CLOSE, 1000)
tap(LARGE)
tap(REACH)
shot("comfort", 5000)
tap(LARGE)
tap(REACH)
tap(CLOSE, 3000)
tap(TOURS)
shot("tours", 1500)
tap(SECOND_TOUR, 5500)
tap((60, 440))  # beside the model: it halts at its first stop
shot("tour", 5000)
tap(HOME)
# Asked 20 s after the last touch, and gone 15 s later; the eye is under way for 2.5 s.
last = now - 600
now = last + 20000
shot("asked", 3400)
now = last + 35000
shot("attract", 8000)

open(f"{sys.argv[1]}/visit.touch", "w").write("\n".join(touches) + "\n")
open(f"{sys.argv[1]}/shots.txt", "w").write("\n".join(shots) + "\n")
