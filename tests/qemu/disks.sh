#!/bin/bash
# disks.sh [all]: tests in QEMU which disk the terminal starts from: image/init finds the terminal's disk and a stick
# whose partitions have the same names, or the same GUIDs too. It does not boot the whole appliance, only kernel and
# initrd of its image, and slots that print whose they are and end. BOOT=FOLDER has others.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
export PATH=$PATH:/usr/sbin:/sbin
image=build/qemu-image/image work=build/qemu-disks
mkdir -p "$work"
tests/qemu/lib-image.sh "$image"

# disk NAME IDENTITY: makes a disk whose slot, loader's partition and data partition print NAME
disk() {
	local tree=$work/tree disk=$work/$1.img
	rm -rf "$tree" "$disk"
	mkdir -p "$tree"/{bin,dev,proc,sys,run,var,efi,etc,lib/systemd}
	cp /bin/busybox "$tree/bin/"
	ln -s busybox "$tree/bin/sh"
	echo gopura:x:990: >"$tree/etc/group"
	: >"$tree/etc/machine-id"
	cat >"$tree/lib/systemd/systemd" <<-I
		#!/bin/sh
		b=/bin/busybox
		\$b mount -t devtmpfs dev /dev
		for name in esp boot-a boot-b root-a root-b data; do links="\$links \$(\$b readlink /dev/gopura/\$name)"; done
		echo "test: the root of $1 runs, /efi is of \$(\$b cat /efi/whose), /var of \$(\$b cat /var/whose), links\$links" >/dev/kmsg
		exec \$b poweroff -f
	I
	chmod 755 "$tree/lib/systemd/systemd"
	mksquashfs "$tree" "$work/root" -all-root -comp zstd -quiet -no-progress -noappend
	image/verity.sh "$work/root" >"$work/$1.verity"
	rm -rf "$work/data"
	mkdir -p "$work/data"
	echo "$1" >"$work/data/whose"
	rm -f "$work/data.ext4" "$work/esp.vfat"
	mke2fs -q -t ext4 -d "$work/data" "$work/data.ext4" 8M >/dev/null 2>&1
	truncate -s 40M "$work/esp.vfat"
	mformat -i "$work/esp.vfat" -F ::
	mcopy -i "$work/esp.vfat" "$work/data/whose" ::/
	truncate -s 72M "$disk"
	{
		echo 'label: gpt'
		local start=1 number=0 entry
		for entry in esp:40 boot-a:1 boot-b:1 root-a:8 root-b:8 data:8; do
			number=$((number + 1))
			echo "start=${start}MiB, size=${entry#*:}MiB, name=gopura-${entry%:*}, uuid=$2-0000-4000-8000-00000000000$number"
			start=$((start + ${entry#*:}))
		done
	} | sfdisk -q "$disk"
	dd if="$work/esp.vfat" of="$disk" bs=1M seek=1 conv=notrunc status=none
	dd if="$work/root" of="$disk" bs=1M seek=43 conv=notrunc status=none
	dd if="$work/root" of="$disk" bs=1M seek=51 conv=notrunc status=none
	dd if="$work/data.ext4" of="$disk" bs=1M seek=59 conv=notrunc status=none
}
disk own 11111111
disk stick 22222222
disk copy 11111111
cp "$work/own.img" "$work/changed.img"
tests/tools/flip_byte.sh "$work/changed.img" $((43 * 1048576 + 8)) # when the file system was made
# The initramfs of the image, which trusts the root of own instead: what is appended to it replaces its files.
boot=${BOOT:-$image/boot}
rm -rf "$work/boot"
mkdir -p "$work/boot/early"
cp "$work/own.verity" "$work/boot/early/verity"
cp "$boot/vmlinuz" "$work/boot/"
{ cat "$boot/initrd" && head -c $((-$(stat -c %s "$boot/initrd") & 3)) /dev/zero && (cd "$work/boot/early" && echo verity | cpio -o -H newc --quiet); } \
	>"$work/boot/initrd"
exec python3 tests/qemu/disks.py "$work/boot" "$work" "$@"
