"""usb.py IMAGE WORK: a USB network adapter that is plugged in before gopura.conf is read. It gets an address if [usb] allows it, and
none otherwise. WORK has the gopura.conf of the image."""
import os
import re
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from appliance import ANSWER_S, BOOT_S, Appliance, table

GADGET = ["-netdev", "user,id=gadget,restrict=on,net=10.9.0.0/24", "-device", "usb-net,netdev=gadget", "-device", "usb-kbd"]


def main():
    image, work = sys.argv[1:3]
    disk, conf = os.path.join(work, "usb.img"), os.path.join(work, "usb.conf")
    for words in ("network, keyboard", ""):
        subprocess.run(["cp", "--sparse=always", image, disk], check=True)
        with open(conf, "w") as out:
            out.write(open(os.path.join(work, "gopura.conf")).read() + (f"[usb]\nallow = {words}\n" if words else ""))
        esp = table(image)[0]["start"] * 512
        subprocess.run(["mcopy", "-o", "-i", f"{disk}@@{esp}", conf, "::/gopura.conf"], check=True)
        machine = Appliance(disk, work, "usb", more=GADGET)
        try:
            said = lambda what: machine.wait_for(what, BOOT_S + ANSWER_S, lambda: re.search(what, machine.log()))
            said(r"DHCPv4 address 10\.0\.2\.")  # of the board's own
            if words:
                print("allowed: " + said(r"DHCPv4 address 10\.9\.0\.[^ ]*").group(0))
                continue
            said("is not taken up: network")
            said("is not taken up: keyboard")
            time.sleep(30)  # in which an address would come
            if "10.9.0." in machine.log():
                raise SystemExit("a network by USB has an address:\n" + machine.log()[-5000:])
            print("not allowed: no address")
        finally:
            machine.stop()


if __name__ == "__main__":
    main()
