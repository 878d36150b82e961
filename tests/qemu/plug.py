"""plug.py KERNEL INITRAMFS WORK: shows the safe page on a panel while a kiosk waits for its end. Then the panel is off
outside its hours until a touch wakes it, and another touch opens a card. Then the kiosk starts without a panel, which is plugged in,
out and in again, and at last the GPU is reset. A process exits only to fit the first panel, and for the GPU."""
import os
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from machine import ANSWER_S, BOOT_S, Kiosk, share_that_differs, tones

CARD_SHARE = 0.15  # of the panel: a card covers about 0.3, what still refines behind it much less


def safe_page(kernel, initramfs, work):
    """Without GPU and release: a page that moves, on the card's own memory. A kiosk that begins meanwhile waits for the card."""
    machine = Kiosk(kernel, initramfs, work, "safe")
    try:
        machine.wait_for("safe page", BOOT_S, lambda: "KMS canvas" in machine.log() and tones(machine.picture("safe")) > 20)
        before = machine.picture("safe")
        machine.wait_for("movement", ANSWER_S, lambda: share_that_differs(before, machine.picture("safe")) > 0.01)
        machine.wait_for("kiosk that waits", ANSWER_S, lambda: "uses /dev/dri/card0; waiting until it ends" in machine.log())
        machine.wait_for("end of the safe page", ANSWER_S, lambda: "init: the safe page ends" in machine.log())
        machine.wait_for("temple after it", ANSWER_S, lambda: "app: first picture" in machine.log() and tones(machine.picture("after")) > 300)
    finally:
        machine.stop()


def plugging(kernel, initramfs, work):
    began = time.monotonic()
    machine = Kiosk(kernel, initramfs, work, "unplugged")
    said = lambda what: lambda: what in machine.log()
    try:
        machine.wait_for("self-test that misses the panel", BOOT_S, said("fail  panel    not connected"))
        machine.wait_for("panel plugged in", ANSWER_S, said("init: plugged in"))
        machine.wait_for("temple", ANSWER_S, lambda: said("app: first picture")() and tones(machine.picture("plugged")) > 300)
        before = machine.picture("plugged")
        machine.wait_for("panel unplugged", ANSWER_S, said("the panel was unplugged"))
        machine.wait_for("panel back", ANSWER_S, said("the panel is connected again"))
        print(f"unplugged and back {time.monotonic() - began:.0f} s after QEMU's start")
        machine.tap_for_card()
        machine.wait_for("card on the panel", ANSWER_S, lambda: share_that_differs(before, machine.picture("replugged")) > CARD_SHARE)
        machine.wait_for("lost context", ANSWER_S, said("the GPU lost its context"))
        began_anew = lambda: machine.log().count("app: first picture") == 2
        machine.wait_for("start after the lost context", ANSWER_S, lambda: began_anew() and tones(machine.picture("anew")) > 300)
        if machine.log().count("the kiosk ended") != 2:  # for the first panel, and for the GPU
            raise SystemExit("the kiosk ended over a panel:\n" + machine.log()[-3000:])
    finally:
        machine.stop()
    print(f"done in {time.monotonic() - began:.0f} s")


def closed(kernel, initramfs, work):
    """Outside its hours the panel is off; a touch wakes it, and opens nothing. The next one opens a card."""
    machine = Kiosk(kernel, initramfs, work, "closed")
    said = lambda what: lambda: what in machine.log()
    try:
        machine.wait_for("panel that is off", BOOT_S, said("app: the panel is off"))
        if "ok    panel    640 x 360, shows a picture (KMS)" not in machine.log():
            raise SystemExit("the self-test does not find the panel well:\n" + machine.log()[-2000:])
        machine.wait_for("touchscreen", ANSWER_S, said("Tablet"))
        machine.wait_for("release, brought in the dark", ANSWER_S, said("app: showing"))
        if tones(machine.picture("closed")) > 20:
            raise SystemExit("the panel shows a picture outside its hours")
        machine.qmp.tap(0.5, 0.38)
        machine.wait_for("panel that is on", ANSWER_S, said("app: the panel is on"))
        machine.wait_for("temple", ANSWER_S, lambda: tones(machine.picture("woken")) > 300)
        if "app: card of" in machine.log():
            raise SystemExit("the touch that woke the panel did something else")
        before = machine.resting_picture("woken")
        machine.tap_for_card()
        # The log is ahead of the panel, on a loaded machine by many seconds: wait for the picture.
        machine.wait_for("card on the panel", ANSWER_S, lambda: share_that_differs(before, machine.picture("card")) > CARD_SHARE)
        share = share_that_differs(before, machine.resting_picture("card"))
        print(f"card: {share:.1%} of the panel changed")
        if not CARD_SHARE < share < 0.9:
            raise SystemExit("the screendump shows no card")
        if "KMS display" not in machine.log():
            raise SystemExit("the picture did not come through KMS:\n" + machine.log()[-2000:])
    finally:
        machine.stop()


safe_page(*sys.argv[1:4])
closed(*sys.argv[1:4])
plugging(*sys.argv[1:4])
