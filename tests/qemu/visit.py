"""visit.py KERNEL INITRAMFS WORK: boots the kiosk, waits for the temple, taps it, expects a card."""
import os
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from machine import ANSWER_S, BOOT_S, Kiosk, share_that_differs, tones

CARD_SHARE = 0.15  # of the panel: a card covers about 0.3, what still refines behind it much less


def main():
    kernel, initramfs, work = sys.argv[1:4]
    began = time.monotonic()
    machine = Kiosk(kernel, initramfs, work)
    try:
        machine.wait_for("temple", BOOT_S, lambda: "app: showing" in machine.log() and tones(machine.picture("temple")) > 300)
        if "ok    panel    640 x 360, shows a picture (KMS)" not in machine.log():
            raise SystemExit("the self-test does not find the panel well:\n" + machine.log()[-2000:])
        print(f"first temple {time.monotonic() - began:.0f} s after QEMU's start")
        before = machine.resting_picture("temple")
        machine.tap_for_card()
        # The log is ahead of the panel, on a loaded machine by many seconds: wait for the picture.
        shows_card = lambda: share_that_differs(before, machine.picture("card")) > CARD_SHARE
        machine.wait_for("card on the panel", ANSWER_S, shows_card)
        share = share_that_differs(before, machine.resting_picture("card"))
        print(f"card: {share:.1%} of the panel changed")
        if not CARD_SHARE < share < 0.9:
            raise SystemExit("the screendump shows no card")
        if "KMS display" not in machine.log():
            raise SystemExit("the picture did not come through KMS:\n" + machine.log()[-2000:])
    finally:
        machine.stop()
    print(f"done in {time.monotonic() - began:.0f} s")


main()
