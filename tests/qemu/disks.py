"""disks.py BOOT WORK [all]: boots kernel and initrd of BOOT with the disks own.img, stick.img (the same names) and copy.img (the same
GUIDs too) of WORK, which disks.sh makes. Whichever is found first, the disk that the loader names is started and used, or none."""
import os
import re
import subprocess
import sys
import time

BOOT_S = 240
OWN = "gopura.root=11111111-0000-4000-8000-00000000000"  # and the number of the partition
PANEL = " quiet loglevel=3"  # as the loader has it: why a terminal restarts is seen all the same
# An internal disk on USB answers a second after a stick on UAS does.
USB, UAS, BOARD = ["-device", "usb-storage,drive={}"], ["-device", "usb-uas,id=uas", "-device", "scsi-hd,bus=uas.0,drive={}"], ["-device", "virtio-blk-pci,drive={}"]
OWN_RUNS = r"test: the root of own runs, /efi is of own, /var of own, links( {0}1)( {0}2)( {0}3)( {0}4)( {0}5)( {0}6)"
NAMED = re.compile(OWN_RUNS.format(r"/dev/[sv]d[ab]"))
REFUSED = re.compile(r"gopura: 2 disks say that they are the terminal's")
SHORT = 4  # of the cases without "all"
CASES = [
    # name, {disk: where}, slot, what the loader says, what must be said
    ("a stick with the slots' names", {"stick": UAS, "own": USB}, "A", OWN + "4", NAMED),
    ("a stick with the disk's identities, the disk on the board", {"copy": UAS, "own": BOARD}, "A", OWN + "4", NAMED),
    ("a stick with the disk's identities, the disk on USB", {"copy": UAS, "own": USB}, "A", OWN + "4" + PANEL, REFUSED),
    ("a changed byte in the root", {"changed": BOARD}, "A", OWN + "4", re.compile(r"verity: .*data block 0 is corrupted(?![\s\S]*test: the root)")),
    # The rest with "all" only.
    ("a stick with the slots' names, slot B", {"stick": UAS, "own": USB}, "B", OWN + "5", NAMED),
    ("an older loader, the disk on the board", {"stick": UAS, "own": BOARD}, "A", "", NAMED),
    ("an older loader, the disk on USB", {"stick": UAS, "own": USB}, "A", PANEL, REFUSED),
    ("a stick alone", {"stick": UAS}, "A", OWN + "4" + PANEL, re.compile("gopura: no disk has the partition gopura-root-a that the loader started from")),
]


def start(boot, work, disks, slot, said):
    """What the kernel logs until it ends or one of the answers is there."""
    log = os.path.join(work, "disks.log")
    open(log, "w").close()
    devices = []
    for name, where in disks.items():
        devices += ["-blockdev", f"driver=file,filename={work}/{name}.img,node-name={name}-file", "-blockdev",
                    f"driver=raw,file={name}-file,node-name={name}", *[part.format(name) for part in where]]
    process = subprocess.Popen(
        ["qemu-system-x86_64", "-accel", "tcg,thread=multi", "-cpu", "Nehalem", "-smp", "2", "-m", "512", "-display", "none", "-nodefaults", "-vga", "none",
         "-no-reboot", "-kernel", f"{boot}/vmlinuz", "-initrd", f"{boot}/initrd", "-serial", f"file:{log}", "-device", "qemu-xhci", *devices,
         "-append", f"console=ttyS0 loglevel=7 panic=1 rauc.slot={slot} {said}"])
    text, until = "", time.monotonic() + BOOT_S
    try:
        while time.monotonic() < until:
            ended = process.poll() is not None
            text = open(log, errors="replace").read()
            if ended or re.search("test: the root of .*links.*\n|restarting in 10 s", text):
                break
            time.sleep(0.2)
    finally:
        process.kill()
        process.wait()
    return text


def main():
    boot, work = sys.argv[1:3]
    failed = []
    for name, disks, slot, said, expected in CASES if sys.argv[3:] == ["all"] else CASES[:SHORT]:
        began = time.monotonic()
        text = start(boot, work, disks, slot, said)
        found = expected.search(text)
        if not found:
            failed.append(name)
            print(f"{name}: no '{expected.pattern}' but\n" + "\n".join(line for line in text.splitlines() if "gopura:" in line or "test:" in line) + "\n" + text[-1500:])
            continue
        print(f"{name}: {found.group(0).strip()} ({time.monotonic() - began:.0f} s)")
    if failed:
        raise SystemExit("the terminal starts what is not its own: " + "; ".join(failed))


main()
