#!/bin/bash
# loader.sh [all]: tests in QEMU what the firmware and the loader start, with Secure Boot on and off: a loader that the firmware's key
# signed, and one that another key signed; a kernel and an initramfs as they were signed, and with one changed byte. The
# firmware has the key that Debian's firmware brings for tests. Without "all" only the changed initramfs. With ARCH=arm64 the
# image and the firmware of that architecture.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
. image/arch.sh
for list in image/tools.txt "${tools[@]}"; do
	./deps.sh "$list" || skip "what makes an image cannot be installed here"
done
export PATH=$PATH:/usr/sbin:/sbin
case $ARCH in
amd64)
	machine=(qemu-system-x86_64 -machine q35,smm=on -global driver=cfi.pflash01,property=secure,value=on -cpu Nehalem -vga none)
	code=/usr/share/OVMF/OVMF_CODE_4M.secboot.fd variables=/usr/share/OVMF/OVMF_VARS_4M snakeoil=/usr/share/ovmf/PkKek-1-snakeoil
	;;
arm64)
	machine=(qemu-system-aarch64 -machine virt -cpu cortex-a72)
	code=/usr/share/AAVMF/AAVMF_CODE.fd variables=/usr/share/AAVMF/AAVMF_VARS snakeoil=/usr/share/qemu-efi-aarch64/PkKek-1-snakeoil
	;;
esac
image=build/qemu-$(basename "$image_folder")/image work=build/qemu-loader-$ARCH
tests/qemu/lib-image.sh "$image"
rm -rf "$work"
mkdir -p "$work"
trap 'rm -f "$work"/*.img' EXIT

# place NAME: where on the disk the partition begins, in bytes
place() { sfdisk --json "$image/gopura.img" | jq ".partitiontable.partitions[] | select(.name == \"$1\").start * 512"; }
# starts CASE KEYS EXPECTED UNEXPECTED: boots the disk CASE until the serial line says what is expected. KEYS: those in the
# firmware, none or snakeoil
starts() {
	local log=$work/$1.log qemu until=$((SECONDS + 300)) began=$SECONDS
	cp "$variables${2:+.$2}.fd" "$work/variables.img"
	: >"$log"
	"${machine[@]}" -accel tcg,thread=multi -m 1024 -display none -nodefaults -no-reboot -serial "file:$log" \
		-drive "if=pflash,format=raw,readonly=on,file=$code" \
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
	starts "$1" "" 'bad signature' 'gopura: starting slot'
}
refused initrd
[ "${1:-}" = all ] || exit 0
refused vmlinuz
disk others
starts others snakeoil 'Access Denied' 'GRUB'

disk trusted
openssl rsa -in $snakeoil.key -passin pass:snakeoil -out "$work/key.pem" 2>/dev/null
sbsign --key "$work/key.pem" --cert $snakeoil.pem --output "$work/$loader" "$image/$loader" 2>/dev/null
mcopy -o -i "$work/trusted.img@@$(place gopura-esp)" "$work/$loader" "::/EFI/BOOT/$loader"
starts trusted snakeoil 'gopura: starting slot a' 'bad signature'
