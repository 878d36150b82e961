#!/bin/bash
# loader.sh [all]: tests in QEMU what the firmware and the loader start, with Secure Boot on and off: a loader that the firmware's key
# signed, and one that another key signed; a kernel and an initramfs as they were signed, and with one changed byte. The
# firmware has the key that Debian's ovmf brings for tests. Without "all" only the changed initramfs.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
export PATH=$PATH:/usr/sbin:/sbin
image=build/qemu-image/image work=build/qemu-loader firmware=/usr/share/OVMF snakeoil=/usr/share/ovmf/PkKek-1-snakeoil
tests/qemu/lib-image.sh "$image"
rm -rf "$work"
mkdir -p "$work"
trap 'rm -f "$work"/*.img' EXIT

# place NAME: where on the disk the partition begins, in bytes
place() { sfdisk --json "$image/gopura.img" | jq ".partitiontable.partitions[] | select(.name == \"$1\").start * 512"; }
# starts CASE VARIABLES EXPECTED UNEXPECTED: boots the disk CASE until the serial line says what is expected
starts() {
	local log=$work/$1.log qemu until=$((SECONDS + 300)) began=$SECONDS
	cp "$firmware/$2" "$work/variables.img"
	: >"$log"
	qemu-system-x86_64 -machine q35,smm=on -global driver=cfi.pflash01,property=secure,value=on -accel tcg,thread=multi \
		-cpu Nehalem -m 1024 -display none -nodefaults -vga none -no-reboot -serial "file:$log" \
		-drive "if=pflash,format=raw,readonly=on,file=$firmware/OVMF_CODE_4M.secboot.fd" \
		-drive "if=pflash,format=raw,file=$work/variables.img" \
		-drive "file=$work/$1.img,if=none,id=disk,format=raw" -device virtio-blk-pci,drive=disk,bootindex=0 &
	qemu=$!
	until grep -qa "$3" "$log" || [ $SECONDS -ge $until ] || ! kill -0 $qemu 2>/dev/null; do sleep 0.5; done
	kill $qemu 2>/dev/null || true
	wait $qemu 2>/dev/null || true
	if ! grep -qa "$3" "$log" || grep -qa "$4" "$log"; then
		tail -c 1500 "$log" | tr -d '\033'
		echo "$1: no '$3', or '$4'"
		exit 1
	fi
	echo "$1: $(grep -ao "$3" "$log" | head -n 1) ($((SECONDS - began)) s)"
}
# disk CASE: a copy of the image's disk
disk() { cp --sparse=always "$image/gopura.img" "$work/$1.img"; }

# change FILE: one byte in the middle of a file of slot A
change() {
	local block
	block=$(debugfs -R "blocks /$1" "$image/boot.img" 2>/dev/null | tr ' ' '\n' | grep . | sed -n 100p)
	tests/tools/flip_byte.sh "$work/$1.img" $(($(place gopura-boot-a) + block * $(dumpe2fs -h "$image/boot.img" 2>/dev/null |
		sed -n 's/^Block size: *//p') + 17))
}
refused() {
	disk "$1"
	change "$1"
	starts "$1" OVMF_VARS_4M.fd 'bad signature' 'gopura: starting slot'
}
refused initrd
[ "${1:-}" = all ] || exit 0
refused vmlinuz
disk others
starts others OVMF_VARS_4M.snakeoil.fd 'Access Denied' 'GRUB'

disk trusted
openssl rsa -in $snakeoil.key -passin pass:snakeoil -out "$work/key.pem" 2>/dev/null
sbsign --key "$work/key.pem" --cert $snakeoil.pem --output "$work/BOOTX64.EFI" "$image/BOOTX64.EFI" 2>/dev/null
mcopy -o -i "$work/trusted.img@@$(place gopura-esp)" "$work/BOOTX64.EFI" ::/EFI/BOOT/BOOTX64.EFI
starts trusted OVMF_VARS_4M.snakeoil.fd 'gopura: starting slot a' 'bad signature'
