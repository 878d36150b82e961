"""The machine that runs the kiosk: boot, log, pictures."""
import os
import re
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from qmp import Qmp

signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # whoever ends us ends the machine too

WIDTH, HEIGHT = 640, 360
BOOT_S, ANSWER_S = 300, 180  # emulated beside other work, a frame with new programs took 17 s


def read_ppm(path):
    """Rows of RGB bytes of a binary PPM of 8 bits, as QEMU writes it: unlike a PNG it costs Python nothing, which would take the time of the
    guest."""
    kind, size, most, pixels = open(path, "rb").read().split(b"\n", 3)
    assert kind == b"P6" and most == b"255", f"{path} is no PPM of 8 bits"
    stride, height = 3 * int(size.split()[0]), int(size.split()[1])
    return [pixels[y * stride : (y + 1) * stride] for y in range(height)]


def share_that_differs(a, b):
    """Of the pixels, how many differ by more than 24 in some channel."""
    count = 0
    for row_a, row_b in zip(a, b):
        if row_a == row_b:
            continue
        for x in range(0, len(row_a), 3):
            if row_a[x : x + 3] != row_b[x : x + 3] and any(abs(row_a[x + c] - row_b[x + c]) > 24 for c in range(3)):
                count += 1
    return count / (WIDTH * HEIGHT)


def tones(rows):
    return len({bytes(row[x : x + 3]) for row in rows[::4] for x in range(0, len(row), 12)})


class Machine:
    """A machine under TCG with a panel, a tablet and a log on its serial line; `kind` is the program that emulates it and its processor,
    `arguments` say what it starts from. QEMU keeps little translated code: what it translated before a restart makes each byte slow that the loader
    copies over it, minutes with the usual 1 GiB, seconds with 256 MiB."""

    def __init__(self, work, case, arguments, kind=("qemu-system-x86_64", "-cpu", "max")):
        self.work, self.serial = work, os.path.join(work, f"{case}.log")
        socket_path = os.path.join(work, "qmp.sock")
        for path in (socket_path, self.serial):
            if os.path.exists(path):
                os.unlink(path)
        self.process = subprocess.Popen(
            [*kind, "-accel", "tcg,thread=multi,tb-size=256", "-smp", "2", "-m", "1536",
             "-display", "none", "-nodefaults", "-vga", "none",
             "-device", f"virtio-gpu-pci,xres={WIDTH},yres={HEIGHT}", "-device", "virtio-tablet-pci",
             "-serial", f"file:{self.serial}", "-qmp", f"unix:{socket_path},server,nowait", *arguments])
        self.qmp = Qmp(socket_path)

    def stop(self):
        self.process.kill()
        self.process.wait()

    def log(self):
        try:
            return open(self.serial, errors="replace").read()
        except FileNotFoundError:
            return ""

    def picture(self, name):
        path = os.path.join(self.work, name + ".ppm")
        self.qmp.screendump(path)
        return read_ppm(path)

    def wait_for(self, what, seconds, condition):
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            if self.process.poll() is not None or re.search("the kiosk ended with status (?!7[56])", self.log()):
                raise SystemExit(f"the machine or the kiosk ended while waiting for {what}:\n" + self.log()[-3000:])
            found = condition()
            if found:
                return found
            time.sleep(0.5)
        raise SystemExit(f"no {what} in {seconds} s:\n" + self.log()[-3000:])

    def tap_for_card(self):
        """Taps a tower, above the help, until its card is open: another touch may have been for something else."""
        until = time.monotonic() + ANSWER_S
        while "app: card of" not in self.log():
            if time.monotonic() > until:
                raise SystemExit("no tap opens a card:\n" + self.log()[-3000:])
            self.qmp.tap(0.5, 0.38)
            time.sleep(3)

    def resting_picture(self, name):
        """The picture once two dumps half a second apart are the same."""
        last = [None]

        def same():
            now = self.picture(name)
            still = last[0] is not None and share_that_differs(now, last[0]) < 0.002
            last[0] = now
            return now if still else None

        return self.wait_for("picture at rest", ANSWER_S, same)


class Kiosk(Machine):
    """Nothing but the kiosk in an initramfs (make-initramfs.sh), which ends with it."""

    def __init__(self, kernel, initramfs, work, case):
        super().__init__(work, case, ["-no-reboot", "-kernel", kernel, "-initrd", initramfs,
                                      "-append", f"console=ttyS0 quiet panic=1 gopura.case={case}"])
