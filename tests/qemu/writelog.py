"""Reads the writes of a disk as QEMU's driver blklogwrites records them (the format of dm-log-writes), and makes the disk as it may be
after a power cut at a point of that log.

What was written before the last flush is on the disk. Each later write is there, is missing, or is torn between sectors of 512 bytes.
A forced write (FUA) is there. The driver records a write when it is finished, so a write that was in flight during a flush counts as
flushed if it finished first; the guest relies on no more than that."""
import random
import struct
import sys

SECTOR = 512  # of the log; the smallest thing a disk writes whole
MAGIC, VERSION = 0x6A736677736872, 1
FLUSH, FUA, DISCARD, MARK = 1, 2, 4, 8


class Write:
    """One entry: where, how much (bytes), and where its bytes lie in the log. A flush alone has none."""

    __slots__ = ("offset", "size", "flags", "at")

    def __init__(self, offset, size, flags, at):
        self.offset, self.size, self.flags, self.at = offset, size, flags, at


def read(path, most=None):
    """The entries of a log that may still grow: those that are whole."""
    writes = []
    with open(path, "rb") as log:
        log.seek(0, 2)
        end = log.tell()
        log.seek(0)
        head = log.read(28)
        if len(head) < 28:
            return writes
        magic, version, _, sector = struct.unpack("<QQQI", head)
        if magic != MAGIC or version != VERSION or sector != SECTOR:
            raise ValueError(f"{path} is no log of writes")
        at = SECTOR
        while at + SECTOR <= end and (most is None or len(writes) < most):
            log.seek(at)
            where, count, flags, _ = struct.unpack("<QQQQ", log.read(32))
            if not (where or count or flags):
                break
            size = count * SECTOR
            data = 0 if flags & DISCARD else size
            if at + SECTOR + data > end:
                break
            writes.append(Write(where * SECTOR, size, flags, at + SECTOR))
            at += SECTOR + data
    return writes


def last_flush(writes, cut):
    """How many of the first CUT writes are on the disk for certain."""
    return next((i for i in range(cut, 0, -1) if writes[i - 1].flags & FLUSH), 0)


def survivors(writes, cut, rng, durable=None):
    """Yields (write, sectors or None for all of them) in order: one disk as it may be after the power went behind the first CUT
    writes. DURABLE instead of the last flush is for a disk that lies."""
    durable = last_flush(writes, cut) if durable is None else durable
    keep = rng.choice((0.0, 0.2, 0.5, 0.8, 0.95))  # of what was not flushed: from hardly anything to nearly all
    for i, write in enumerate(writes[:cut]):
        if i < durable or write.flags & FUA:
            yield write, None
            continue
        fate = rng.random()
        if fate < keep:
            yield write, None
        elif rng.random() < 0.3 and write.size > SECTOR and not write.flags & DISCARD:
            yield write, [n for n in range(write.size // SECTOR) if rng.random() < 0.5]


def replay(log_path, disk_path, chosen):
    """Writes what was chosen onto the disk's file."""
    with open(log_path, "rb") as log, open(disk_path, "r+b") as disk:
        for write, sectors in chosen:
            if write.flags & DISCARD or not write.size:
                continue  # what is discarded may be read as before
            log.seek(write.at)
            data = log.read(write.size)
            if sectors is None:
                disk.seek(write.offset)
                disk.write(data)
                continue
            for n in sectors:
                disk.seek(write.offset + n * SECTOR)
                disk.write(data[n * SECTOR : (n + 1) * SECTOR])


def self_test():
    """What the rules above promise, on a log made here."""
    entry = lambda offset, size, flags=0: Write(offset * SECTOR, size * SECTOR, flags, 0)
    writes = [entry(0, 1), entry(1, 8), entry(0, 0, FLUSH), entry(9, 8), entry(20, 1, FUA), entry(30, 2), entry(40, 1)]
    seen, torn = {3: set(), 5: set()}, 0
    for seed in range(400):
        rng = random.Random(seed)
        there = {id(write): sectors for write, sectors in survivors(writes, 6, rng)}
        assert id(writes[0]) in there and there[id(writes[1])] is None, "a flushed write was lost or torn"
        assert id(writes[4]) in there, "a write that was forced through was lost"
        assert id(writes[6]) not in there, "a write that was never made is there"
        for i in seen:
            seen[i].add(id(writes[i]) in there)
        torn += there.get(id(writes[3])) is not None
    assert all(len(fates) == 2 for fates in seen.values()) and torn, "what was not flushed is always lost, or never, or never torn"
    assert last_flush(writes, 2) == 0 and last_flush(writes, 6) == 3
    lied = sum(id(writes[0]) not in {id(w) for w, _ in survivors(writes, 6, random.Random(seed), 0)} for seed in range(50))
    assert lied, "a disk that lies loses nothing"


if __name__ == "__main__":
    self_test()
    sys.exit(0)
