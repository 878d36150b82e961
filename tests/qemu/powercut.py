"""powercut.py IMAGE STICKS WORK: cuts the power while the appliance runs (docs/powercut.md).
powercut.py FOLDER: only looks at GLANCES disks of a session that appliance.py recorded there.

A session runs once, with a log of all writes of its disk: first start on a larger card, provisioning, a release from a stick, a tap, a
newer release, marking the slot as good; if STICKS has an update of the system, that too. Then, for each cut, a disk is made as it may
be after a power cut at some point of the log, started and checked.

  CUTS=N      number of cuts that are started (100)   SEED=N      other cuts and other losses
  GLANCES=N   number of disks that are only checked by the tools of the loader and the file system (3 times as many)
  CUT=N       only cut N, in the existing session: the same disk again, bit by bit
  AGAIN=yes   more cuts in the existing session
  LIES=yes    the disk acknowledges flushes but does not perform them: damage must be found"""
import json
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import time
import zlib

sys.path.insert(0, os.path.dirname(__file__))
import writelog
from appliance import ANSWER_S, BOOT_S, INSTALL_S, Appliance, table
from machine import read_ppm, share_that_differs

CARD_MIB = 2048  # the card is larger than the image
MIB = 1 << 20
TOOLS = {**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}
# Which writes are cut at: a share of the cuts each, so that 200 MiB of an update do not hide four sectors of the loader's.
SHARES = {"data": 0.55, "esp": 0.25, "table": 0.1, "slot": 0.1}
SAME_SHARE = 0.2  # of the panel: two pictures of one release differ less, by what was not yet brought; of two releases more
COMPLAINTS = ("corrupt", "malformed", ".broken", "beyond repair", "damaged", "EXT4-fs error", "SQUASHFS error", "environment block", "crashed",
              "core dump", "Failed with result", "gopura-safe.service", "self-test failed", "restarting in 10 s", "nothing is stored")
RELEASE = r"release (\d+) is (?:shown|stored)"
# journald begins a new file after a cut, and says so in these words; the old one stays readable. The loader's FAT keeps a mark of a
# cut while it was writable; nothing of its structure is ever changed.
HARMLESS = r"systemd-journald\[\d+\]: File /\S+/journal/\S+ corrupted or uncleanly shut down|FAT-fs \(vda1\): Volume was not properly unmounted"


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def partitions(image):
    """[(first byte, byte behind, what SHARES calls it)]"""
    kinds = {"esp": "esp", "data": "data"}
    return [(part["start"] * 512, (part["start"] + part["size"]) * 512, kinds.get(part["name"].removeprefix("gopura-"), "slot")) for part in table(image)]


def prepare(image, base):
    """The card as it comes to the museum: larger than the image, and with a gopura.conf."""
    run("cp", "--sparse=always", image, base)
    os.truncate(base, CARD_MIB * MIB)
    conf = base + ".conf"
    with open(conf, "w") as out:
        out.write("[terminal]\nname = Power cut\n[release]\nurl = https://museum.invalid/\ntrust = root.json\n")
    run("mcopy", "-o", "-i", f"{base}@@1M", conf, "::/gopura.conf")


def above_the_help(picture):
    """The upper part of the picture: the help covers the lower part until the visitor has touched the model."""
    return picture[: len(picture) * 2 // 5]


class Session:
    """The log of one run, and what was true from which of its writes on."""

    def __init__(self, folder):
        self.folder = folder
        self.path = lambda name: os.path.join(folder, name)
        self.events, self.sequences = {}, []

    def mark(self, name):
        self.events[name] = len(writelog.read(self.path("writes.log")))
        print(f"  {name}: {self.events[name]} writes")

    def record(self, image, sticks):
        shutil.rmtree(self.folder, ignore_errors=True)
        os.makedirs(self.folder)
        self.sequences = [int(open(os.path.join(sticks, name)).read()) for name in ("first", "next")]
        prepare(image, self.path("base.img"))
        run("cp", "--sparse=always", self.path("base.img"), self.path("disk.img"))
        began = time.monotonic()
        machine = Appliance(self.path("disk.img"), self.folder, "session", self.path("writes.log"))
        stick = lambda name: os.path.join(sticks, name + ".img")
        said = lambda what, seconds=ANSWER_S: machine.wait_for(what, seconds, lambda: re.search(what, machine.log()))
        try:
            machine.plug(stick("first"))
            said("app: first picture", BOOT_S)
            said("objects of the picture are stored")
            self.mark("first is shown")
            machine.temple("first")
            machine.resting_picture("first")
            machine.unplug()
            said("the stick was removed")
            self.mark("next is there")
            machine.plug(stick("next"))
            said(f"release {self.sequences[1]} is shown")
            self.mark("next is shown")
            first = above_the_help(read_ppm(self.path("first.ppm")))
            # The panel follows what is remembered, on a loaded machine by many seconds.
            machine.wait_for("newer release on the panel", ANSWER_S,
                             lambda: share_that_differs(first, above_the_help(machine.picture("next"))) > SAME_SHARE)
            time.sleep(5)  # what fades in
            machine.resting_picture("next")
            machine.qmp.tap(0.5, 0.38)
            said("slot A, .* is good")
            self.mark("slot A is good")
            machine.unplug()
            if os.path.exists(stick("system")):
                self.mark("system is there")
                machine.plug(stick("system"))
                said("installing")
                said("starting slot b", INSTALL_S)
                self.mark("restarted")
                machine.unplug()
                said("slot B, .* is good", BOOT_S)
                self.mark("slot B is good")
        finally:
            machine.stop()
        self.mark("end")
        json.dump([self.events, self.sequences], open(self.path("events.json"), "w"))
        print(f"session of {time.monotonic() - began:.0f} s")

    def load(self):
        if os.path.exists(self.path("events.json")):
            self.events, self.sequences = json.load(open(self.path("events.json")))
        self.writes = writelog.read(self.path("writes.log"), self.events.get("end"))
        self.places = partitions(self.path("base.img"))
        self.kinds = {}
        for i, write in enumerate(self.writes):
            if write.size:
                self.kinds.setdefault(self.kind(write), []).append(i)

    def kind(self, write):
        if write.offset >= self.places[-1][0] and write.offset < CARD_MIB * MIB - MIB:
            return "data"
        return next((kind for first, behind, kind in self.places if first <= write.offset < behind), "table")

    def figures(self):
        flushes = sum(1 for write in self.writes if write.flags & writelog.FLUSH)
        sizes = {kind: sum(self.writes[i].size for i in where) for kind, where in self.kinds.items()}
        print(f"{len(self.writes) - flushes} writes and {flushes} flushes: "
              + ", ".join(f"{kind} {len(where)} writes {sizes[kind] / 1024:.0f} KiB" for kind, where in sorted(self.kinds.items())))

    def after(self, name, cut):
        return name in self.events and cut >= self.events[name]


class Cut:
    def __init__(self, session, seed, number, lies):
        self.session, self.name = session, f"{seed}-{number}"
        self.rng = random.Random(self.name)
        kinds = sorted(session.kinds)
        self.kind = self.rng.choices(kinds, [SHARES[kind] for kind in kinds])[0]
        at = self.rng.choice(session.kinds[self.kind]) + 1
        flush = next((i for i in range(at, len(session.writes)) if session.writes[i].flags & writelog.FLUSH), len(session.writes))
        self.cut = self.rng.randint(at, flush) if self.rng.random() < 0.5 else at
        self.durable = max(0, self.cut - 2000) if lies else writelog.last_flush(session.writes, self.cut)

    def disk(self, path):
        """Makes the disk; returns how many of the writes not known to be on it were lost, and how many torn."""
        session = self.session
        run("cp", "--sparse=always", session.path("base.img"), path)
        chosen = list(writelog.survivors(session.writes, self.cut, self.rng, self.durable))
        writelog.replay(session.path("writes.log"), path, chosen)
        made = sum(1 for write in session.writes[: self.cut])
        return made - len(chosen), sum(1 for _, sectors in chosen if sectors is not None)

    def releases(self):
        """Those of which one must be shown."""
        if self.session.after("next is shown", self.cut):
            return set(self.session.sequences[1:])
        return set(self.session.sequences if self.session.after("next is there", self.cut) else self.session.sequences[:1])

    def slots(self):
        if self.session.after("slot B is good", self.cut):
            return {"b"}
        return {"a", "b"} if self.session.after("system is there", self.cut) else {"a"}


def complaints(log):
    lines = [line for line in log.splitlines() if not re.search(HARMLESS, line)]
    return [line for line in lines if any(word in line for word in COMPLAINTS)]


def loader_is_ill(disk):
    """What must hold before anything can be mended: the table of partitions and the loader's environment. None, or what is wrong."""
    with open(disk, "rb") as file:
        file.seek(512)
        header = bytearray(file.read(92))
        said, at, entries_said = struct.unpack_from("<I", header, 16)[0], struct.unpack_from("<Q", header, 72)[0], struct.unpack_from("<I", header, 88)[0]
        header[16:20] = bytes(4)
        file.seek(at * 512)
        if zlib.crc32(header) != said or zlib.crc32(file.read(128 * 128)) != entries_said:
            return "the table of partitions is damaged"
    read = subprocess.run(["mtype", "-i", f"{disk}@@1M", "::/gopura/grubenv"], capture_output=True)
    if len(read.stdout) != 1024 or not read.stdout.startswith(b"# GRUB Environment Block\n") or b"\nORDER=" not in read.stdout:
        return f"the loader's environment is damaged, {len(read.stdout)} bytes"
    return None


def glance(cut, disk):
    """The disk without starting it: what the loader reads, and whether the data partition's file system can be repaired without asking."""
    cut.disk(disk)
    wrong = loader_is_ill(disk)
    run("dd", f"if={disk}", f"of={disk}.data", "bs=1M", f"skip={cut.session.places[-1][0] // MIB}", "conv=sparse", "status=none")
    repair = subprocess.run(["e2fsck", "-p", f"{disk}.data"], capture_output=True, env=TOOLS)
    if not wrong and repair.returncode > 2:
        wrong = f"e2fsck -p ends with {repair.returncode}: {repair.stdout.decode().splitlines()[-1:]}"
    return wrong


def look(cut, work, sticks):
    """Starts the disk. Returns (what is wrong or None, what was seen)."""
    session, disk = cut.session, os.path.join(work, "disk.img")
    lost, torn = cut.disk(disk)
    began = time.monotonic()
    seen = {"cut": cut.cut, "at": cut.kind, "lost": lost, "torn": torn}
    wrong = loader_is_ill(disk)
    if wrong:
        return wrong, seen
    machine = Appliance(disk, work, "cut")
    try:
        if not session.after("first is shown", cut.cut):
            machine.plug(os.path.join(sticks, "first.img"))  # as its owner would leave it in
        machine.wait_for("first picture", BOOT_S, lambda: "app: first picture" in machine.log() or complaints(machine.log()))
        if complaints(machine.log()):
            return "complains: " + complaints(machine.log())[0], seen
        machine.wait_for("release", ANSWER_S, lambda: re.search(RELEASE, machine.log()))
        seen["seconds"] = round(time.monotonic() - began)
        machine.temple("cut")
        time.sleep(3)  # what fades in
        picture = machine.resting_picture("cut")
    except SystemExit as ended:
        if not isinstance(ended.code, str):
            raise  # somebody ended us
        return f"does not come back: {str(ended).splitlines()[0]}", seen
    finally:
        machine.stop()
    log = machine.log()
    seen["release"] = int(re.findall(RELEASE, log)[-1])
    seen["slot"] = re.findall(r"starting slot (\w)", log)[-1]
    seen["repaired"] = "repaired" in log
    likeness = lambda name: share_that_differs(above_the_help(picture), above_the_help(read_ppm(session.path(name + ".ppm"))))
    seen["differs"] = {name: round(likeness(name), 3) for name in ("first", "next")}
    nearest = min(seen["differs"], key=seen["differs"].get)
    wrong = complaints(log)
    if log.count("starting slot") > 1:
        return "restarted before it came back", seen
    if wrong:
        return "complains: " + wrong[0], seen
    if seen["release"] not in cut.releases():
        return f"shows release {seen['release']}, not {cut.releases()}", seen
    if nearest != ("first", "next")[session.sequences.index(seen["release"])] or seen["differs"][nearest] > SAME_SHARE:
        return f"the panel does not show release {seen['release']}", seen
    if seen["slot"] not in cut.slots():
        return f"starts slot {seen['slot']}, not {cut.slots()}", seen
    return None, seen


def look_at_disks(session, seed, count, lies, disk):
    """Of so many disks; returns how many are ill."""
    failed = 0
    for number in range(count):
        cut = Cut(session, seed, f"glance-{number}", lies)
        wrong = glance(cut, disk)
        if wrong:
            failed += 1
            print(f"disk {cut.name}, cut {cut.cut} at {cut.kind}: FAILED, {wrong}", flush=True)
    print(f"{count} disks looked at without starting them")
    return failed


def main():
    cuts, seed, only = int(os.environ.get("CUTS") or 100), os.environ.get("SEED") or "1", os.environ.get("CUT")
    lies, glances = bool(os.environ.get("LIES")), int(os.environ.get("GLANCES") or 3 * cuts)
    writelog.self_test()
    if len(sys.argv) == 2:
        session = Session(sys.argv[1])
        session.load()
        session.figures()
        sys.exit(1 if look_at_disks(session, seed, glances, lies, session.path("disk.img")) else 0)
    image, sticks, work = sys.argv[1:4]
    session = Session(os.path.join(work, "session"))
    if not (only or os.environ.get("AGAIN")) or not os.path.exists(session.path("events.json")):
        session.record(image, sticks)
    session.load()
    session.figures()
    failed = look_at_disks(session, seed, 0 if only else glances, lies, os.path.join(work, "disk.img"))
    numbers = [int(only)] if only else range(cuts)
    with open(os.path.join(work, "cuts.jsonl"), "a") as results:
        for number in numbers:
            cut = Cut(session, seed, number, lies)
            wrong, seen = look(cut, work, sticks)
            print(f"cut {cut.name}: {'FAILED, ' + wrong if wrong else 'well'} {seen}", flush=True)
            results.write(json.dumps({"name": cut.name, "wrong": wrong, **seen}) + "\n")
            results.flush()
            if wrong:
                failed += 1
                kept = os.path.join(work, "failed-" + cut.name)
                os.makedirs(kept, exist_ok=True)
                cut.__init__(session, seed, number, lies)
                cut.disk(os.path.join(kept, "disk.img"))
                for name in ("cut.log", "cut.ppm"):
                    if os.path.exists(os.path.join(work, name)):
                        shutil.copy(os.path.join(work, name), kept)
                print(f"  kept in {kept}; again: CUT={number} SEED={seed} make powercut")
    print(f"{len(numbers)} cuts of {len(session.writes)} writes, {failed} failed")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
