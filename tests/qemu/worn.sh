#!/bin/bash
# Boots the appliance's image in QEMU from disks that can only be read, or that fail at first (worn.py). The logs are in
# build/qemu-worn. tests/e2e/init.sh has more faults.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
./deps.sh image/tools.txt || skip "what makes an image cannot be installed here"
export PATH=$PATH:/usr/sbin:/sbin
image=build/qemu-image/image work=build/qemu-worn
mkdir -p "$work"
tests/qemu/lib-image.sh "$image"
trap 'rm -f "$work"/disk.img' EXIT
python3 tests/qemu/worn.py "$image/gopura.img" "$work"
