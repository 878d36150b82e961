#!/bin/bash
# bundle.sh FOLDER: root.squashfs and boot.img there as a signed update, gopura.raucb (KEYS and VERSION as in build.sh).
set -eu
cd "$(dirname "$0")/.."
out=$1 keys=${keys:-${KEYS:-build/image-keys}}
work=$out/bundle
rm -rf "$work" "$out/gopura.raucb"
mkdir -p "$work"
ln "$out/root.squashfs" "$out/boot.img" "$work/"
cat >"$work/manifest.raucm" <<M
[update]
compatible=gopura-x86-64
version=${version_text:-${VERSION:-$(git describe --always --dirty)}}

[bundle]
format=verity

[image.rootfs]
filename=root.squashfs

[image.boot]
filename=boot.img
M
rauc --cert="$keys/cert.pem" --key="$keys/key.pem" bundle "$work" "$out/gopura.raucb" >"$out/bundle.log" 2>&1 ||
	{ tail -n 5 "$out/bundle.log" >&2; exit 1; }
rm -rf "$work"
