"""appliance.py IMAGE WORK [STICKS [CASE...]]: boots the appliance's image, waits for the temple, taps it, expects a card, and checks the journal.
STICKS is a folder of update bundles by name (docs/image.md); each is plugged in as a stick. Without it, what was written to the disk is noted in
WORK/writes, a session for powercut.py. Of the CASES below only those named are run, or all. With ARCH=arm64 in the environment the image is of
that architecture."""
import http.client
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request

sys.path.insert(0, os.path.dirname(__file__))
from machine import Machine, tones

# What emulates the box, its firmware and that one's variables, and how many times longer than a PC's it may take.
KIND, CODE, VARIABLES, SLOW = {
    # of a box without AVX, which this QEMU emulates slowly and not always rightly
    "amd64": (("qemu-system-x86_64", "-cpu", "Nehalem"), "/usr/share/OVMF/OVMF_CODE_4M.fd", "/usr/share/OVMF/OVMF_VARS_4M.fd", 1),
    "arm64": (("qemu-system-aarch64", "-machine", "virt", "-cpu", "cortex-a72"), "/usr/share/AAVMF/AAVMF_CODE.fd", "/usr/share/AAVMF/AAVMF_VARS.fd", 3),
}[os.environ.get("ARCH") or "amd64"]
BOOT_S, ANSWER_S, INSTALL_S, BACK_S = 420 * SLOW, 300 * SLOW, 900 * SLOW, 1500 * SLOW
LOADER_S = 15 * SLOW  # for which keys are pressed, so that firmware and loader see some
DISK_BYTES = 2 << 30  # the disk is larger than the image: the data partition takes what is left
CARD_SHARE = 0.1  # of the panel, in its own colour; without a card it is 0.02


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def table(image):
    """The partitions, in order: start and size in sectors, name."""
    found = subprocess.run(["sfdisk", "--json", image], check=True, capture_output=True, env={**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"})
    return json.loads(found.stdout)["partitiontable"]["partitions"]


def asked(port, path):
    """What the health page behind the port answers to a question from outside, whatever its status; nothing when no answer comes, as on a machine that
    is too busy to give one in time."""
    try:
        return urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=60).read().decode()
    except urllib.error.HTTPError as error:
        return error.read().decode()
    except (OSError, http.client.HTTPException):
        return ""


class Appliance(Machine):
    """A box with the disk's file; LOG: where what is written to the disk is noted too (writelog.py); MORE devices; DRIVE: what
    QEMU takes for the disk, if not simply the file (worn.py)."""

    def __init__(self, disk, work, case, log=None, more=(), drive=None):
        variables, self.disk = os.path.join(work, "variables.fd"), disk
        self.health = free_port()
        shutil.copy(VARIABLES, variables)
        drive = drive or ["-blockdev", f"driver=file,filename={disk},node-name={'file' if log else 'disk'},cache.no-flush=on"]
        if log:
            open(log, "w").close()
            drive += ["-blockdev", f"driver=file,filename={log},node-name=log,cache.no-flush=on",
                      "-blockdev", "driver=blklogwrites,node-name=disk,file=file,log=log,log-sector-size=512"]
        super().__init__(work, case, [
            "-drive", f"if=pflash,format=raw,readonly=on,file={CODE}",
            "-drive", f"if=pflash,format=raw,file={variables}",
            *drive, "-device", "virtio-blk-pci,drive=disk,bootindex=0",
            "-netdev", f"user,id=net,restrict=on,hostfwd=tcp:127.0.0.1:{self.health}-:9100", "-device", "virtio-net-pci,netdev=net,romfile=",
            "-device", "virtio-keyboard-pci,id=keys", "-device", "qemu-xhci", "-device", "i6300esb", "-action", "watchdog=reset", *more], KIND)
        self.seen = 0

    def since(self):
        """What the log says since the last look that found something."""
        return self.log()[self.seen :]

    def said(self, what, seconds):
        """Waits for a line with the pattern, which is returned."""
        found = self.wait_for(what, seconds, lambda: re.search(what, self.since()))
        self.seen += found.end()
        return found.group(0)

    def installed(self, name):
        """Waits until the update of a stick is in the other slot and the machine starts again."""
        self.said(f"{name}.raucb: installing", INSTALL_S)
        if "GRUB" not in self.said("Welcome to GRUB|could not be installed", INSTALL_S):
            raise SystemExit(f"{name} was not installed:\n" + self.log()[-3000:])

    def plug(self, stick, name="stick"):
        self.qmp.command("blockdev-add", driver="raw", **{"node-name": name, "read-only": True, "file": {"driver": "file", "filename": stick}})
        self.qmp.command("device_add", driver="usb-storage", id=name, drive=name)

    def unplug(self, name="stick"):
        self.qmp.command("device_del", id=name)
        time.sleep(2)
        self.qmp.command("blockdev-del", **{"node-name": name})

    def temple(self, name):
        self.wait_for("temple", ANSWER_S, lambda: tones(self.picture(name)) > 300)


def paper(rows):
    """Share of the panel in the colour of cards and pages."""
    light = lambda r, g, b: r > 235 and g > 228 and b > 205
    return sum(light(*row[x : x + 3]) for row in rows for x in range(0, len(row), 3)) / (len(rows) * len(rows[0]) / 3)


def stages(log):
    """Seconds of the kernel's clock at which the boot came to each stage."""
    marks = {"systemd runs": "systemd", "units may start": "Reached target basic.target", "fetcher runs": "Started gopura-fetch",
             "kiosk begins": "Starting gopura-kiosk", "panel is set": "KMS display", "first picture": "app: first picture"}
    for name, mark in marks.items():
        found = re.search(r"\[ *([\d.]+)\][^\n]*" + mark, log)
        print(f"  {name:16} {found.group(1) if found else '-':>8} s")


def keyboard(machine):
    """Whoever plugs in a keyboard meets no console, no shell and no restart: the panel stays the kiosk's."""
    machine.picture("before-keys")
    said = len(machine.log())
    for keys in (("ctrl", "alt", "f2"), ("alt", "f3"), ("alt", "up"), *[("ctrl", "alt", "delete")] * 8, ("alt", "sysrq", "b"), ("alt", "sysrq", "k"),
                 ("ctrl", "c"), ("ctrl", "alt", "f1"), *[("ret",)] * 3):
        machine.qmp.press(*keys)
    time.sleep(15)
    if tones(machine.picture("after-keys")) < 300:
        raise SystemExit("a keyboard took the panel away: " + os.path.join(machine.work, "after-keys.ppm"))
    if "Received SIGINT" not in machine.log()[said:]:  # of Ctrl-Alt-Del
        raise SystemExit("no key came to the system:\n" + machine.log()[said:][-3000:])
    answer = re.search("GRUB|login:|[Rr]ebooting|Stopping gopura-kiosk|Started .*(getty|shell)|sysrq: (Resetting|SAK)", machine.log()[said:])
    if answer:
        raise SystemExit(f"a keyboard was answered by '{answer.group(0)}':\n" + machine.log()[said:][-3000:])
    print("a keyboard opens nothing")


def own(machine):
    """The system is that of the loader's disk, whose identities are no longer those of every image."""
    if "the loader does not say" in machine.log() or not re.search("starting slot a of /dev/vda", machine.log()):
        raise SystemExit("the loader did not name its disk:\n" + machine.log()[:3000])
    identities = [part["uuid"] for part in table(machine.disk)]
    known = [identity for identity in identities if identity.startswith("6F707572-6100-4000-8000")]
    if known != identities[:1]:
        raise SystemExit(f"partitions have the identities of the image: {identities}")


def usb(machine):
    """What is plugged in by USB is storage or touch, or it is not taken up."""
    said = len(machine.log())
    add = lambda driver, **rest: machine.qmp.command("device_add", driver=driver, id=driver, **rest)
    add("usb-kbd")
    machine.said("is not taken up: keyboard", ANSWER_S)
    machine.qmp.command("netdev_add", type="user", id="gadget", restrict=True)
    add("usb-net", netdev="gadget")
    machine.said("is not taken up: network", ANSWER_S)
    add("usb-tablet")
    machine.said("QEMU USB Tablet", ANSWER_S)  # says the kiosk
    time.sleep(10)  # in which an address would come
    taken = re.search("QEMU USB Keyboard as|(usb|enx|enp)[^ ]*: (Gained carrier|DHCPv4 address)|register 'cdc_ether'", machine.log()[said:])
    if taken:
        raise SystemExit(f"by USB was taken up: '{taken.group(0)}'\n" + machine.log()[said:][-3000:])
    for driver in ("usb-kbd", "usb-net", "usb-tablet"):
        machine.qmp.command("device_del", id=driver)
    print("by USB a touchscreen is taken up, a keyboard and a network are not")


def visit(machine):
    began = time.monotonic()
    while time.monotonic() - began < LOADER_S:
        machine.qmp.press(*"ce")  # GRUB's keys for its shell and its editor
    machine.said("app: first picture", BOOT_S)
    machine.temple("temple")
    print(f"first temple {time.monotonic() - began:.0f} s after power, by the kernel's clock:")
    stages(machine.log())
    machine.resting_picture("temple")
    until = time.monotonic() + ANSWER_S
    while paper(machine.picture("card")) < CARD_SHARE:  # the first touch may only close the help
        if time.monotonic() > until:
            raise SystemExit("no tap opens a card:\n" + machine.log()[-3000:])
        machine.qmp.tap(0.5, 0.38)
        time.sleep(5)
    print("a tap opened a card")
    grown = re.search(r"gopura-data was enlarged to (\d+) MiB", machine.log())
    rest = DISK_BYTES - sum(part["size"] * 512 for part in table(machine.disk)[:-1])
    if not grown or int(grown.group(1)) < (rest >> 20) - 3 or "could not be enlarged" in machine.log():
        raise SystemExit(f"the data partition did not grow to the disk's {rest >> 20} MiB that are left:\n" + machine.log()[:3000])
    print(grown.group(0))
    own(machine)
    keyboard(machine)
    usb(machine)
    well(machine)
    for fault in ("crashed", "core dump", "Failed with result"):
        if fault in machine.log():
            raise SystemExit(f"the journal says '{fault}':\n" + machine.log()[-3000:])


def well(machine):
    """The health page, asked over the network, knows both programs and finds nothing critical."""
    up = {f"gopura_{what} 1" for what in ("kiosk_up", "fetch_up", "kiosk_picture")}
    until = time.monotonic() + ANSWER_S
    while True:
        verdict, figures = asked(machine.health, "/health"), asked(machine.health, "/metrics")
        if verdict and "critical" not in verdict.split() and up <= set(figures.splitlines()):
            break
        if time.monotonic() > until:
            raise SystemExit("the health page is wrong:\n" + verdict + figures)
        time.sleep(5)  # an emulated kiosk is silent while it draws a frame of the attract tour
    print("the health page says: " + verdict.replace("\n", "; "))


def good(machine):
    """Waits until the system that runs was found good, which on a busy machine may have been long ago; returns its slot."""

    def slot():
        starts = list(re.finditer(r"starting slot (\w)", machine.log()))
        name = starts[-1].group(1).upper() if starts else None
        return name if name and re.search(f"slot {name}, .* is good", machine.log()[starts[-1].end() :]) else None

    return machine.wait_for("good slot", BOOT_S, slot)


def tampered(machine, stick):
    good(machine)
    machine.plug(stick)
    print(machine.said("tampered.raucb: could not be installed", INSTALL_S))
    machine.unplug()


def newer(machine, stick):
    good(machine)
    machine.plug(stick)
    machine.installed("next")
    print(machine.said("slot B, .*next, is good", BOOT_S))
    machine.temple("next")
    machine.unplug()


def older(machine, stick):
    machine.plug(stick)
    print(machine.said(r"older.raucb is refused: before \(sequence \d+\) is older than [^ ]*next \(sequence \d+\)", ANSWER_S))
    machine.unplug()


def faulty(machine, stick, name):
    """What runs is good again after an update that shows nothing or hangs."""
    slot = good(machine)
    machine.plug(stick)
    machine.installed(name)
    print(machine.said(f"slot {slot}, .*, is good", BACK_S), f"again, after {name}")
    machine.temple(name + "-back")
    machine.unplug()


def changed(machine):
    """With one changed byte in the root of the slot that runs, the other one starts. The byte tells when the file system was made: nothing but
    its hash tree would notice. Returns the machine that was started for it."""
    machine.stop()
    where = next(part["start"] for part in table(machine.disk) if part["name"] == "gopura-root-b") * 512 + 8
    with open(machine.disk, "r+b") as disk:
        disk.seek(where)
        byte = disk.read(1)[0]
        disk.seek(where)
        disk.write(bytes([byte ^ 1]))
    machine = Appliance(machine.disk, machine.work, "changed")
    try:
        print(machine.said("verity: .*data block 0 is corrupted", BOOT_S))
        print(machine.said("slot A, .* is good", BACK_S), "again")
    except BaseException:
        machine.stop()
        raise
    return machine


# What is tested, in this order, with the stick of the same name if there is one. older and changed need a good slot B;
# changed also a good slot A, in which blank or hangs may lie after their turn, so it comes before them.
CASES = {
    "visit": lambda machine, stick: visit(machine),
    "tampered": tampered,
    "next": newer,
    "older": older,
    "changed": lambda machine, stick: changed(machine),
    "blank": lambda machine, stick: faulty(machine, stick, "blank"),
    "hangs": lambda machine, stick: faulty(machine, stick, "hangs"),
}


def cases(sticks, chosen):
    """Names of the cases to run: those chosen, or all that have what they need."""
    unknown = set(chosen) - set(CASES)
    if unknown:
        raise SystemExit(f"appliance.py: no case {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")
    if not sticks:
        return ["visit"]
    there = {name.removesuffix(".img") for name in os.listdir(sticks)} | {"visit", "changed"}
    return chosen or [name for name in CASES if name in there]


def main():
    image, work = sys.argv[1:3]
    sys.stdout.reconfigure(line_buffering=True)  # a log shows each part when it is done
    began = time.monotonic()
    disk = os.path.join(work, "disk.img")
    subprocess.run(["cp", "--sparse=always", image, disk], check=True)
    os.truncate(disk, DISK_BYTES)
    sticks = sys.argv[3] if len(sys.argv) > 3 else None
    writes = os.path.join(work, "writes")
    shutil.rmtree(writes, ignore_errors=True)
    if not sticks:
        os.makedirs(writes)
        subprocess.run(["cp", "--sparse=always", disk, os.path.join(writes, "base.img")], check=True)
    machine = Appliance(disk, work, "appliance", None if sticks else os.path.join(writes, "writes.log"))
    try:
        for name in cases(sticks, sys.argv[4:]):
            since = time.monotonic()
            machine = CASES[name](machine, os.path.join(sticks or "", name + ".img")) or machine
            print(f"{name}: {time.monotonic() - since:.0f} s")
    finally:
        machine.stop()
    print(f"done in {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
