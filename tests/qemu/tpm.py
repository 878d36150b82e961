"""tpm.py IMAGE WORK: boots the image of an encrypting terminal (DATA=tpm) with swtpm as its TPM; WORK has two other loaders and another kernel, which
tpm.sh makes. The power is cut at the end of each start: neither disk nor TPM is told. One disk goes through all CASES, in their order."""
import hashlib
import mmap
import os
import re
import shutil
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(__file__))
from appliance import ANSWER_S, BOOT_S, DISK_BYTES, asked, free_port, table
from machine import Machine

FIRMWARE = "/usr/share/OVMF"
KIND = ("qemu-system-x86_64", "-machine", "q35,smm=on", "-global", "driver=cfi.pflash01,property=secure,value=on", "-cpu", "Nehalem")
ANEW, UNLOCKED = "gopura: /dev/vda6 cannot be unlocked and is created anew, encrypted", "gopura: /dev/vda6 is unlocked"
NO_TPM = "gopura: /dev/vda6 is NOT encrypted: The computer has no TPM"
LOCKED = "gopura: nothing is stored: /dev/vda6 cannot be unlocked. The computer has no TPM"
WARNINGS = {NO_TPM: "The data partition is not encrypted", LOCKED: "Nothing is stored on the disk"}  # of the health page
IDENTITY = r"cat\[\d+\]: ([0-9a-f]{32})\s"  # the machine's, which is on the data partition (lib-image.sh)
# What SQLite, the journal and e2fsprogs write at the beginning of their files.
PLAIN = {"a database": b"SQLite format 3\0", "the journal": b"LPKSHHRH", "the file system's name": b"gopura-data"}


class Terminal(Machine):
    """The box with its disk, its firmware's variables and the TPM with this name, or none."""

    def __init__(self, work, case, tpm):
        self.tpm = None
        more = []
        if tpm:
            state, control = os.path.join(work, tpm), os.path.join(work, "tpm.sock")
            os.makedirs(state, exist_ok=True)
            self.tpm = subprocess.Popen(["swtpm", "socket", "--tpm2", "--tpmstate", f"dir={state}", "--ctrl", f"type=unixio,path={control}"])
            while not os.path.exists(control):
                if self.tpm.poll() is not None:
                    raise SystemExit("swtpm does not run")
                time.sleep(0.1)
            more = ["-chardev", f"socket,id=tpm,path={control}", "-tpmdev", "emulator,id=tpm,chardev=tpm", "-device", "tpm-tis,tpmdev=tpm"]
        self.health = free_port()
        super().__init__(work, case, [
            "-drive", f"if=pflash,format=raw,readonly=on,file={FIRMWARE}/OVMF_CODE_4M.secboot.fd",
            "-drive", f"if=pflash,format=raw,file={work}/variables.img",
            "-blockdev", f"driver=file,filename={work}/disk.img,node-name=disk,cache.no-flush=on,discard=unmap",
            "-device", "virtio-blk-pci,drive=disk,bootindex=0",
            "-netdev", f"user,id=net,restrict=on,hostfwd=tcp:127.0.0.1:{self.health}-:9100", "-device", "virtio-net-pci,netdev=net,romfile=", *more], KIND)

    def stop(self):
        super().stop()
        if self.tpm:
            self.tpm.kill()
            self.tpm.wait()
            os.unlink(os.path.join(self.work, "tpm.sock"))

    def said(self, what):
        return self.wait_for(what, BOOT_S, lambda: re.search(what, self.log()))


def start(work, case, tpm, expected, unexpected, until=IDENTITY):
    """Starts the terminal until it has said what is expected, and the pattern `until`. Returns the machine's id."""
    began = time.monotonic()
    machine = Terminal(work, case, tpm)
    try:
        for what in expected:
            machine.said(re.escape(what))
        identity = machine.said(IDENTITY).group(1)
        machine.said(until)
        for warning in (WARNINGS[what] for what in expected if what in WARNINGS):
            machine.wait_for("warning on the health page", ANSWER_S, lambda: warning in asked(machine.health, "/health"))
        for what in unexpected:
            if what in machine.log():
                raise SystemExit(f"{case}: the terminal said '{what}':\n" + machine.log()[-3000:])
    finally:
        machine.stop()
    print(f"{case}: {'; '.join(expected)} ({time.monotonic() - began:.0f} s)")
    return identity


def data(work):
    """Where the data partition is on the disk: first byte and size."""
    part = next(part for part in table(f"{work}/disk.img") if part["name"] == "gopura-data")
    return part["start"] * 512, part["size"] * 512


def readable(work):
    """What can be read on the data partition without its key."""
    first, size = data(work)
    with open(f"{work}/disk.img", "rb") as disk, mmap.mmap(disk.fileno(), 0, access=mmap.ACCESS_READ) as seen:
        return [name for name, text in PLAIN.items() if seen.find(text, first, first + size) >= 0]


def save_header(work):
    """Copies the LUKS2 header into a file, whose path is returned."""
    with open(f"{work}/disk.img", "rb") as disk, open(f"{work}/header", "wb") as header:
        disk.seek(data(work)[0])
        header.write(disk.read(17 << 20))
    return header.name


def loader(work, file):
    """Puts the loader in the place of the terminal's."""
    first = next(part for part in table(f"{work}/disk.img") if part["name"] == "gopura-esp")["start"] * 512
    subprocess.run(["mcopy", "-o", "-i", f"{work}/disk.img@@{first}", file, "::/EFI/BOOT/BOOTX64.EFI"], check=True)


def update(work, image):
    """What an update does: the other slot gets a system, of another kernel and initramfs, and the loader is told to start it."""
    parts = {part["name"]: part["start"] * 512 for part in table(f"{work}/disk.img")}
    for file, slot in ((f"{work}/boot.img", "gopura-boot-b"), (f"{os.path.dirname(image)}/root.squashfs", "gopura-root-b")):
        with open(file, "rb") as new, open(f"{work}/disk.img", "r+b") as disk:
            disk.seek(parts[slot])
            shutil.copyfileobj(new, disk, 1 << 20)
    environment, loader = f"{work}/grubenv", f"{work}/disk.img@@{parts['gopura-esp']}"
    subprocess.run(["mcopy", "-n", "-i", loader, "::/gopura/grubenv", environment], check=True)
    subprocess.run(["grub-editenv", environment, "set", "ORDER=B A", "B_OK=1", "B_TRY=0"], check=True)
    subprocess.run(["mcopy", "-o", "-i", loader, environment, "::/gopura/grubenv"], check=True)


def no_cipher(work):
    """Names another cipher in both copies of the LUKS2 header, one that leaves everything readable; their checksums need no key."""
    with open(f"{work}/disk.img", "r+b") as disk:
        for copy in (0, 16384):
            disk.seek(data(work)[0] + copy)
            header = bytearray(disk.read(16384))
            area = header.index(b'"segments":')
            name = header.index(b'"aes-xts-plain64"', area)
            header[name : name + len(b'"aes-xts-plain64"')] = b'"cipher_null-ecb"'
            header[448:512] = bytes(64)
            header[448:480] = hashlib.sha256(header).digest()
            disk.seek(data(work)[0] + copy)
            disk.write(header)
    opened = subprocess.run(["cryptsetup", "luksDump", save_header(work)], check=True, capture_output=True, text=True).stdout
    if "cipher: cipher_null-ecb" not in opened:
        raise SystemExit("cryptsetup does not take the changed header, so this tests nothing:\n" + opened)


def same(what, a, b, expected):
    if (a == b) != expected:
        raise SystemExit(f"{what}: the machine's id was {a} and is {b}")


def first(work):
    """Created encrypted, as large as the disk allows, and in use; nothing of it can be read."""
    identity = start(work, "first", "tpm", [ANEW, UNLOCKED], [NO_TPM, "could not be", "measures nothing"], "app: first picture")
    rest = DISK_BYTES - data(work)[0]
    if data(work)[1] < rest - (3 << 20):
        raise SystemExit(f"the data partition has {data(work)[1]} bytes of {rest}")
    slots = subprocess.run(["cryptsetup", "luksDump", save_header(work)], check=True, capture_output=True, text=True).stdout
    keys, bound = re.findall(r"^  \d+: luks2$", slots, re.M), re.findall(r"tpm2-hash-pcrs: *(.*)", slots)
    if len(keys) != 1 or bound != ["4+7"]:
        raise SystemExit("more opens the partition than the TPM:\n" + slots)
    found = readable(work)
    if found:
        raise SystemExit("without the key can be read: " + ", ".join(found))
    return identity


def main():
    image, work = sys.argv[1:3]
    sys.stdout.reconfigure(line_buffering=True)
    for name in ("tpm", "new-tpm"):
        shutil.rmtree(os.path.join(work, name), ignore_errors=True)
    subprocess.run(["cp", "--sparse=always", image, f"{work}/disk.img"], check=True)
    os.truncate(f"{work}/disk.img", DISK_BYTES)
    shutil.copy(f"{FIRMWARE}/OVMF_VARS_4M.fd", f"{work}/variables.img")

    zero = start(work, "no TPM", None, [NO_TPM], [UNLOCKED, LOCKED], "app: first picture")
    if sorted(readable(work)) != sorted(PLAIN):
        raise SystemExit(f"of a plain partition can be read only: {readable(work)}")  # so it proves nothing that the encrypted one hides it
    one = first(work)
    same("encrypted", zero, one, False)
    same("the second start", one, start(work, "second", "tpm", [UNLOCKED], [ANEW, NO_TPM]), True)
    update(work, image)
    same("an update to another kernel", one, start(work, "another kernel", "tpm", ["gopura: starting slot b", UNLOCKED], [ANEW, NO_TPM]), True)
    no_cipher(work)
    changed = start(work, "without a cipher", "tpm", [ANEW, UNLOCKED], [NO_TPM])
    same("without a cipher", one, changed, False)
    loader(work, f"{work}/changed.efi")
    two = start(work, "changed loader", "tpm", [ANEW, UNLOCKED], [NO_TPM])
    same("with a changed loader", changed, two, False)
    loader(work, f"{work}/trusted.efi")
    shutil.copy(f"{FIRMWARE}/OVMF_VARS_4M.snakeoil.fd", f"{work}/variables.img")
    three = start(work, "Secure Boot switched on", "tpm", [ANEW, UNLOCKED], [NO_TPM])
    same("with Secure Boot", two, three, False)
    # Until the picture: the disk needs a while to have the machine's id, and each start ends with a power cut.
    four = start(work, "a new TPM", "new-tpm", [ANEW, UNLOCKED], [NO_TPM], "app: first picture")
    same("with a new TPM", three, four, False)
    same("without its TPM", four, start(work, "the TPM switched off", None, [LOCKED], [ANEW, UNLOCKED, NO_TPM], "app: first picture"), False)
    same("with its TPM again", four, start(work, "the TPM switched on again", "new-tpm", [UNLOCKED], [ANEW, NO_TPM]), True)


main()
