#!/bin/bash
# Boots the appliance's own image in QEMU without KVM: the loader, the slot, systemd, the temple on the panel, a tap and
# its card; then disks as power cuts meanwhile could have left them are looked at. With "updates" instead updates from sticks (a good one, a tampered one, an older one, one that shows nothing
# and one that hangs), sticks with other file systems, two sticks at once, a USB network adapter, and a gopura.conf on a
# stick. Pictures and the journal are in build/qemu-image. With ARCH=arm64 the image of that architecture, in
# build/qemu-image-arm64: the same visit, and of the updates the good, the tampered and the older one.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
. image/arch.sh
for list in image/tools.txt "${tools[@]}"; do
	./deps.sh "$list" || skip "what makes an image cannot be installed here"
done
work=build/qemu-$(basename "$image_folder")
mkdir -p "$work"
tests/qemu/lib-image.sh "$work/image"
lib=$work/image/tree/usr/lib
[ "$(stat -c %Y "$lib/clock-epoch")" = "$(stat -c %Y "$lib/os-release")" ] || { echo "a terminal's clock may be behind its image"; exit 1; }
sticks=
if [ "${1:-}" = updates ]; then
	sticks=$work/sticks
	faulty='blank hangs'
	[ "$ARCH" = amd64 ] || faulty= # what goes back is the same everywhere, and takes emulated minutes
	# shellcheck disable=SC2086
	tests/qemu/make-sticks.sh "$work/image" "$sticks" $faulty
fi
# shellcheck disable=SC2086
python3 tests/qemu/appliance.py "$work/image/gopura.img" "$work" $sticks
[ "$ARCH" = amd64 ] || exit 0
[ -n "$sticks" ] || GLANCES=6 python3 tests/qemu/powercut.py "$work/writes"
[ -z "$sticks" ] || python3 tests/qemu/usb.py "$work/image/gopura.img" "$work"
[ -z "$sticks" ] || python3 tests/qemu/sticks.py "$work/image/gopura.img" "$work"
[ -z "$sticks" ] || python3 tests/qemu/plugconf.py "$work/image/gopura.img" "$work"
