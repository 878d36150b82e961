#!/bin/bash
# tpm.sh: tests in QEMU the data partition that is encrypted with a key of the TPM (DATA=tpm, docs/image.md), with swtpm as
# the TPM: tpm.py has the cases. The logs are in build/qemu-tpm.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
export PATH=$PATH:/usr/sbin:/sbin
work=build/qemu-tpm image=build/qemu-tpm/image other=build/qemu-image/image snakeoil=/usr/share/ovmf/PkKek-1-snakeoil
mkdir -p "$work"
# Debian's packages are the same as in the image of the other tests.
if [ ! -e "$image/base.key" ] && [ -e "$other/base.key" ]; then
	mkdir -p "$image"
	cp -a "$other"/base.{tar,key} "$other/kernel" "$image/"
fi
DATA=tpm tests/qemu/lib-image.sh "$image"

# Two other loaders: one with a changed letter, and one that Debian's firmware for tests trusts when its Secure Boot is on.
sed 's/This program cannot be run in DOS mode/This program cannot be run in dos mode/' "$image/BOOTX64.EFI" >"$work/changed.efi"
! cmp -s "$image/BOOTX64.EFI" "$work/changed.efi" || { echo "the loader has no text to change"; exit 1; }
openssl rsa -in $snakeoil.key -passin pass:snakeoil -out "$work/snakeoil.pem" 2>/dev/null
sbsign --key "$work/snakeoil.pem" --cert $snakeoil.pem --output "$work/trusted.efi" "$image/BOOTX64.EFI" 2>/dev/null
trap 'rm -f "$work"/*.img' EXIT

# What an update puts into the other slot: a kernel and an initramfs with more bytes at their end, where neither minds.
cp "$image/boot.img" "$work/boot.img"
cp "$image/boot"/{vmlinuz,initrd} "$work/"
truncate -s +4096 "$work/vmlinuz" "$work/initrd"
KEYS=${KEYS:-build/image-keys} SOURCE_DATE_EPOCH=$(date +%s) image/loader-keys.sh sign "$work"/{vmlinuz,initrd} 2>"$work/sign.log"
for file in {vmlinuz,initrd}{,.sig}; do printf 'rm /%s\nwrite %s /%s\n' "$file" "$work/$file" "$file"; done |
	debugfs -w -f - "$work/boot.img" >"$work/debugfs.log" 2>&1
for file in {vmlinuz,initrd}{,.sig}; do # debugfs ends with 0 whatever happened
	debugfs -R "cat /$file" "$work/boot.img" 2>/dev/null | cmp - "$work/$file"
done
python3 tests/qemu/tpm.py "$image/gopura.img" "$work" "$@"
