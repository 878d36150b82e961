#!/bin/bash
# The appliance's own image, started as a box would start it, in QEMU without KVM: the loader, the slot, systemd, the temple on the
# panel, a tap and its card. With "updates" also what happens to updates from sticks: one that is good, one that was tampered with,
# one that shows nothing and one that hangs. Pictures and the journal: build/qemu-image.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
work=build/qemu-image
mkdir -p "$work"
tests/qemu/release.sh build/qemu
cp build/qemu/release/root/1.json "$work/root.json"
printf '%s\n' '[release]' 'url = /usr/share/gopura/release' 'trust = root.json' '[health]' 'listen = 0.0.0.0:9100' >"$work/gopura.conf"
CONF=$work/gopura.conf RELEASE=build/qemu/release OUT=$work/image KERNEL="console=ttyS0 systemd.journald.forward_to_console=1" LEVEL=${LEVEL:-3} image/build.sh
sticks=
if [ "${1:-}" = updates ]; then
	sticks=$work/sticks
	tests/qemu/sticks.sh "$work/image" "$sticks"
fi
# shellcheck disable=SC2086
exec python3 tests/qemu/appliance.py "$work/image/gopura.img" "$work" $sticks
