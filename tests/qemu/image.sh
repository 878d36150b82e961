#!/bin/bash
# The appliance's own image, started as a box would start it, in QEMU without KVM: the loader, the slot, systemd, the temple on the
# panel, a tap and its card. With "updates" also what happens to updates from sticks: one that is good, one that was tampered with,
# one that is older, one that shows nothing and one that hangs; to sticks with other file systems, and to two at once; then to a network by USB, and to a
# gopura.conf on a stick. Pictures and the journal: build/qemu-image.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
work=build/qemu-image
mkdir -p "$work"
tests/qemu/lib-image.sh "$work/image"
sticks=
if [ "${1:-}" = updates ]; then
	sticks=$work/sticks
	tests/qemu/make-sticks.sh "$work/image" "$sticks"
fi
# shellcheck disable=SC2086
python3 tests/qemu/appliance.py "$work/image/gopura.img" "$work" $sticks
[ -z "$sticks" ] || python3 tests/qemu/usb.py "$work/image/gopura.img" "$work"
[ -z "$sticks" ] || python3 tests/qemu/sticks.py "$work/image/gopura.img" "$work"
[ -z "$sticks" ] || python3 tests/qemu/plugconf.py "$work/image/gopura.img" "$work"
