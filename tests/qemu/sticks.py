"""sticks.py IMAGE WORK: plugs sticks into the running appliance. A stick with another file system has no effect, not even an ext4 that
tells the kernel to panic; FAT and exFAT are accepted; each of two sticks keeps its own mount."""
import os
import re
import struct
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from appliance import ANSWER_S, BOOT_S, Appliance

SETTLE_S = 15  # for whatever may still happen to a stick
TOOLS = {**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}


def tool(*command):
    subprocess.run(command, check=True, capture_output=True, env=TOOLS)


def image(work, name, mib, *parts):
    """A disk's file with bytes at some places: [(place, bytes)]."""
    path = os.path.join(work, f"stick-{name}.img")
    with open(path, "wb") as file:
        file.truncate(mib << 20)
        for at, data in parts:
            file.seek(at)
            file.write(data)
    return path


def hostile_ext4(work):
    """Its superblock says errors=panic, and the inode of its gopura.conf was cleared: whoever opens that file panics."""
    path, conf = image(work, "ext4", 16), os.path.join(work, "stick-gopura.conf")
    with open(conf, "w") as file:
        file.write("[terminal]\nname = Hostile\n")
    tool("mke2fs", "-q", "-F", "-t", "ext4", "-e", "panic", path)
    tool("debugfs", "-w", "-R", f"write {conf} gopura.conf", path)
    tool("debugfs", "-w", "-R", "clri gopura.conf", path)
    return path


def squashfs(work):
    path = os.path.join(work, "stick-squashfs.img")
    tool("mksquashfs", os.path.join(work, "stick-gopura.conf"), path, "-noappend", "-quiet")
    os.truncate(path, 16 << 20)
    return path


def btrfs(work):
    block = bytearray(4096)
    block[0x40:0x48] = b"_BHRfS_M"
    struct.pack_into("<Q", block, 0x30, 65536)
    struct.pack_into("<Q", block, 0x70, 128 << 20)
    struct.pack_into("<I", block, 0x90, 4096)
    return image(work, "btrfs", 128, (65536, block))


def xfs(work):
    block = bytearray(512)
    block[0:4] = b"XFSB"
    struct.pack_into(">IQ", block, 4, 4096, 4096)
    struct.pack_into(">Q", block, 48, 64)
    struct.pack_into(">IIII", block, 80, 1, 1024, 4, 0)
    struct.pack_into(">I", block, 96, 512)
    struct.pack_into(">HHHH", block, 100, 4, 512, 256, 16)
    block[120:128] = bytes([12, 9, 8, 4, 10, 0, 0, 25])
    return image(work, "xfs", 64, (0, block))


def iso9660(work):
    volume = b"\x01CD001\x01\0" + b"LINUX".ljust(32) + b"GOPURA".ljust(32) + bytes(1976)
    return image(work, "iso9660", 16, (32768, volume), (34816, b"\xffCD001\x01"))


def kind(path):
    """What udev will take it for."""
    found = subprocess.run(["blkid", "-p", "-o", "value", "-s", "TYPE", path], check=True, capture_output=True, text=True, env=TOOLS)
    return found.stdout.strip()


def vfat(work, name):
    path, conf = image(work, name, 64), os.path.join(work, "stick-gopura.conf")
    tool("mformat", "-i", path, "-F", "::")
    with open(path, "r+b") as file:  # mformat writes a table of partitions too, whose one lies over all
        file.seek(446)
        file.write(bytes(64))
    tool("mcopy", "-i", path, conf, "::/gopura.conf")
    return path


def exfat(work):
    path = image(work, "exfat", 64)
    tool("mkfs.exfat", path)
    return path


def refused(machine, work):
    """Each file system of another kind is looked at by udev, and by nobody else. When a FAT that was plugged in after them is
    mounted, they would have been."""
    makers = {"ext4": hostile_ext4, "squashfs": squashfs, "btrfs": btrfs, "xfs": xfs, "iso9660": iso9660}
    sticks = {name: make(work) for name, make in makers.items()}
    sentinel = vfat(work, "sentinel")
    for group in (("ext4", "btrfs", "xfs"), ("squashfs", "iso9660")):
        begin = len(machine.log())
        for name in group:
            if kind(sticks[name]) != name:
                raise SystemExit(f"{sticks[name]} is a {kind(sticks[name])}: the test tests nothing")
            machine.plug(sticks[name], name)
            time.sleep(2)
        machine.plug(sentinel, "sentinel")
        said = lambda: machine.log()[begin:]
        answer = lambda: re.search(r"Kernel panic|GRUB|EXT4-fs \(sd|BTRFS[^\n]*\bsd[a-z]|XFS \(sd|squashfs[^\n]*\bsd[a-z]|sd[a-z] \((?!vfat)", said())
        mounted = lambda: re.search(r"sd[a-z] \(vfat\) is mounted", said())
        machine.wait_for("mount of the FAT beside " + ", ".join(group), ANSWER_S, lambda: answer() or mounted())
        time.sleep(SETTLE_S)
        if answer() or len(re.findall("Starting gopura-stick@", said())) != 1:
            raise SystemExit(f"a stick with one of {group} was answered:\n" + said()[-3000:])
        for name in (*group, "sentinel"):
            machine.unplug(name)
    print("not taken: " + ", ".join(sticks))


def taken(machine, work):
    """FAT and exFAT; a second stick waits for the first, and neither ends the other's."""
    first, second = vfat(work, "first"), vfat(work, "second")
    machine.seen = len(machine.log())
    machine.plug(exfat(work), "exfat")
    print(machine.said(r"sd[a-z]+ \(exfat\) is mounted", ANSWER_S))
    machine.unplug("exfat")

    machine.plug(first, "first")
    one = machine.said(r"(sd[a-z]+) \(vfat\) is mounted", ANSWER_S).split()[0]
    machine.said("the gopura.conf of the stick is not used", ANSWER_S)
    machine.plug(second, "second")
    other = machine.said(r"(sd[a-z]+) waits: another stick", ANSWER_S).split()[0]
    # The one that waits goes: the other's stays, so that it need not be mounted again.
    machine.unplug("second")
    machine.said(f"Stopped gopura-stick@{other}", ANSWER_S)
    time.sleep(SETTLE_S)
    if re.search(r"is mounted|Unmounted run-gopura|Deactivated successfully[^\n]*run-gopura", machine.since()):
        raise SystemExit("a stick that only waited took the other's mount along:\n" + machine.since()[-3000:])
    # The first goes, and the second is taken: its text is read.
    machine.plug(second, "second")
    other = machine.said(r"(sd[a-z]+) waits: another stick", ANSWER_S).split()[0]
    machine.unplug("first")
    machine.said(rf"{other} \(vfat\) is mounted", ANSWER_S)
    machine.said("the gopura.conf of the stick is not used", ANSWER_S)
    machine.unplug("second")
    machine.plug(first, "first")
    machine.said(r"sd[a-z]+ \(vfat\) is mounted", ANSWER_S)
    machine.unplug("first")
    print(f"of two sticks {one} held, {other} waited and was taken; pulled out and plugged in again, too")


def main():
    image_file, work = sys.argv[1:3]
    disk = os.path.join(work, "sticks.img")
    subprocess.run(["cp", "--sparse=always", image_file, disk], check=True)
    began = time.monotonic()
    machine = Appliance(disk, work, "sticks")
    try:
        machine.said("app: first picture", BOOT_S)
        refused(machine, work)
        taken(machine, work)
    finally:
        machine.stop()
    print(f"done in {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
