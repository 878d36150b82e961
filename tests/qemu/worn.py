"""worn.py IMAGE WORK: boots the appliance's image from disks that fail: one shows its picture, the health page tells, and no data is lost."""
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.dirname(__file__))
from appliance import ANSWER_S, BOOT_S, Appliance, asked, table

LOST = "Nothing is stored on the disk: /dev/vda6 cannot be read or written."


def data(disk):
    """First byte of the data partition."""
    return next(part["start"] for part in table(disk) if part["name"] == "gopura-data") * 512


def identity(disk):
    """That of the file system on the data partition, which a new one would not have."""
    with open(disk, "rb") as file:
        file.seek(data(disk) + 1024 + 104)
        return file.read(16)


def read_errors(disk, count):
    """A disk whose data partition cannot be read the first times: the sector with ext4's superblock."""
    rules = [f"inject-error.{n}.{rule}" for n in range(count) for rule in ("event=none", "iotype=read", "once=on", f"sector={data(disk) // 512 + 2}")]
    return ["-blockdev", f"driver=file,filename={disk},node-name=file,cache.no-flush=on",
            "-blockdev", "driver=blkdebug,node-name=disk,image=file," + ",".join(rules)]


def start(disk, work, case, drive, lost, look):
    """Starts the terminal until its system runs, and looks at it. The data partition is lost to it or not, and never created anew."""
    before = identity(disk)
    machine = Appliance(disk, work, case, drive=drive)
    try:
        machine.said(r"systemd\[1\]", BOOT_S)
        look(machine)
        if ("gopura: nothing is stored: /dev/vda6 cannot be read or written." in machine.log()) != lost or identity(disk) != before:
            raise SystemExit(f"{case}:\n" + machine.log()[-3000:])
    finally:
        machine.stop()
    print(f"{case}: {'memory takes its place' if lost else 'the data is there'}")


def visitors_see_it(machine):
    machine.said("app: first picture", BOOT_S)
    machine.wait_for("warning on the health page", ANSWER_S, lambda: LOST in asked(machine.health, "/health"))


def errors(count):
    """That the disk did fail, so often."""

    def look(machine):
        found = len(re.findall("I/O error, dev vda, sector", machine.log()))
        if found != count:
            raise SystemExit(f"the disk failed {found} times, not {count}:\n" + machine.log()[-3000:])

    return look


def main():
    image, work = sys.argv[1:3]
    sys.stdout.reconfigure(line_buffering=True)
    disk = os.path.join(work, "disk.img")
    subprocess.run(["cp", "--sparse=always", image, disk], check=True)
    start(disk, work, "40 errors of the data partition", read_errors(disk, 40), True, errors(5))
    start(disk, work, "3 errors of the data partition", read_errors(disk, 3), False, errors(3))
    start(disk, work, "a disk that can only be read", ["-blockdev", f"driver=file,filename={disk},node-name=disk,read-only=on"], True, visitors_see_it)


main()
