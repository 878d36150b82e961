#!/bin/bash
# Cuts the power while the appliance runs in QEMU, at points of the log of its disk's writes (powercut.py,
# docs/powercut.md). CUTS=N cuts (1, with a look at 6 more disks), SEED=N others; "system": the session contains an update of the system. Failed cuts
# are kept in build/qemu-image/powercut, and CUT=N with its SEED makes the same disk again while the same session
# exists.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
image=build/qemu-image/image work=build/qemu-image/powercut
sticks=$work/sticks
mkdir -p "$sticks"
tests/qemu/lib-image.sh "$image"

# stick NAME MIB COMMAND...: a stick, filled by the command
stick() {
	local file=$sticks/$1.img mib=$2
	shift 2
	rm -f "$file"
	truncate -s "${mib}M" "$file"
	mformat -i "$file" -F ::
	# mformat's boot sector looks like a table of partitions too; a stick has the one or the other.
	dd if=/dev/zero of="$file" bs=1 seek=446 count=64 conv=notrunc status=none
	mcopy -s -Q -i "$file" "$@" ::/
}

# A newer release by the same keys, of another temple.
content=$work/content
if [ ! -f "$work/next/release/release.json" ] || [ build/qemu/release/release.json -nt "$work/next/release/release.json" ]; then
	rm -rf "$content" "$work/next"
	mkdir -p "$work/next"
	cp -r build/qemu/content "$content"
	cp -r build/qemu/release "$work/next/release"
	sed -i -e 's/^background *=.*/background = #503018/' "$content/temple.ini"
	build/gopura-content temple --triangles 50000 --seed 2 --regions "$content/regions" --out "$content/scan.ply"
	build/gopura-content build "$content" --out "$work/next/release" --keys build/qemu/keys
fi
# release NAME FOLDER: on a stick, and its sequence beside it
release() {
	stick "$1" 64 "$2"
	find "$2/history" -name '*.json' -printf '%f\n' | sort -n | tail -n 1 | cut -d. -f1 >"$sticks/$1"
}
release first build/qemu/release
release next "$work/next/release"
[ -n "${CUT:-}" ] || rm -f "$sticks/system.img"
if [ "${1:-}" = system ] && [ ! -f "$sticks/system.img" ]; then
	# The same system under another version: what is written to the other slot, and when, does not depend on what is in it.
	mkdir -p "$work/system"
	ln -f "$image/root.squashfs" "$image/boot.img" "$work/system/"
	of_image() { sed -n "s/^IMAGE_$1=//p" "$image/tree/usr/lib/os-release"; }
	VERSION=$(of_image VERSION)-next SEQUENCE=$(($(of_image SEQUENCE) + 1)) image/bundle.sh "$work/system"
	stick system "$(($(stat -c %s "$work/system/gopura.raucb") / 1048576 + 40))" "$work/system/gopura.raucb"
fi
[ -n "${CUTS:-}" ] || export CUTS=1 GLANCES=6
exec python3 tests/qemu/powercut.py "$image/gopura.img" "$sticks" "$work"
