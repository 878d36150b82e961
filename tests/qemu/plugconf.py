"""plugconf.py IMAGE WORK: the appliance's image without a gopura.conf says so on the panel; one on a stick is applied as soon as the
stick is plugged in, and a second time changes nothing (docs/terminal.md). WORK has the gopura.conf and root.json of the image."""
import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from appliance import ANSWER_S, BOOT_S, Appliance, paper, table


def make_stick(work):
    stick = os.path.join(work, "conf.img")
    with open(stick, "wb") as file:
        file.truncate(64 << 20)  # mformat -F takes no less
    subprocess.run(["mformat", "-i", stick, "-F", "::"], check=True)
    with open(stick, "r+b") as file:  # mformat writes a table of partitions too, whose one lies over all
        file.seek(446)
        file.write(bytes(64))
    subprocess.run(["mcopy", "-i", stick, os.path.join(work, "gopura.conf"), os.path.join(work, "root.json"), "::/"], check=True)
    return stick


def set_up(machine, stick):
    machine.said("/efi/gopura.conf does not exist; the defaults are used", BOOT_S)
    machine.wait_for("page about the missing gopura.conf", ANSWER_S, lambda: paper(machine.picture("unset")) > 0.5)
    machine.plug(stick)
    print(machine.said("gopura-stick/gopura.conf is applied", ANSWER_S))
    machine.said("app: first picture", ANSWER_S)
    machine.temple("set-up")
    machine.unplug()
    machine.plug(stick)
    print(machine.said("gopura-stick/gopura.conf is in use already", ANSWER_S))
    machine.unplug()


def main():
    image, work = sys.argv[1:3]
    disk = os.path.join(work, "unset.img")
    subprocess.run(["cp", "--sparse=always", image, disk], check=True)
    esp = table(image)[0]["start"] * 512
    subprocess.run(["mdel", "-i", f"{disk}@@{esp}", "::/gopura.conf"], check=True)
    began = time.monotonic()
    stick = make_stick(work)
    machine = Appliance(disk, work, "unset")
    try:
        set_up(machine, stick)
    finally:
        machine.stop()
    print(f"done in {time.monotonic() - began:.0f} s")


if __name__ == "__main__":
    main()
