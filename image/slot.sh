#!/bin/bash
# slot.sh FOLDER: makes what a slot holds, root.squashfs and boot.img in FOLDER, of FOLDER's tree/ (the root), early/
# (the initramfs) and vmlinuz. The root ends in dm-verity's hash tree, and the initramfs has its root hash: a changed
# byte of the root is never used (image/init). The loader starts initramfs and kernel only with their signatures by
# loader.key of KEYS. LEVEL of compression (15); SOURCE_DATE_EPOCH.
set -eu
export SOURCE_DATE_EPOCH
cd "$(dirname "$0")/.."
out=$1 slot_mib=${slot_mib:-300} boot_mib=${boot_mib:-48}
export PATH=$PATH:/usr/sbin:/sbin
root=$out/root.squashfs boot=$out/boot
rm -f "$root" "$out/boot.img"
mksquashfs "$out/tree" "$root" -all-root -comp zstd -Xcompression-level "${LEVEL:-15}" -quiet -no-progress -noappend
image/verity.sh "$root" >"$out/early/verity"
[ "$(stat -c %s "$root")" -le $((slot_mib << 20)) ] || {
	echo "image: the root is larger than a slot of $slot_mib MiB; see $out/tree" >&2
	exit 1
}

find "$out/early" -exec touch -hcd "@$SOURCE_DATE_EPOCH" {} +
rm -rf "$boot"
mkdir -p "$boot"
(cd "$out/early" && find . | LC_ALL=C sort | cpio -o -H newc --quiet --reproducible) | zstd -q -19 -T0 >"$boot/initrd"
cp "$out/vmlinuz" "$boot/vmlinuz"
image/loader-keys.sh sign "$boot/initrd" "$boot/vmlinuz" 2>"$out/sign.log" || { cat "$out/sign.log" >&2; exit 1; }
touch -d "@$SOURCE_DATE_EPOCH" "$boot"/* "$boot"
export E2FSPROGS_FAKE_TIME=$SOURCE_DATE_EPOCH
mke2fs -q -t ext2 -U 6f707572-6100-4000-8000-000000000000 \
	-E hash_seed=6f707572-6100-4000-8000-000000000001,root_owner=0:0 -d "$boot" "$out/boot.img" "${boot_mib}M" 2>/dev/null
# mke2fs copies the change times of the files in $boot, which touch cannot set.
for file in initrd initrd.sig vmlinuz vmlinuz.sig; do
	echo "set_inode_field $file ctime @$SOURCE_DATE_EPOCH"
done | debugfs -w -f - "$out/boot.img" >/dev/null 2>&1
