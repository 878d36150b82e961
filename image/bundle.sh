#!/bin/bash
# bundle.sh FOLDER: makes a signed update, gopura.raucb, from root.squashfs and boot.img in FOLDER (ARCH, KEYS, VERSION
# and SEQUENCE as in build.sh).
set -eu
cd "$(dirname "$0")/.."
. image/arch.sh
. image/version.sh
out=$1 keys=${keys:-${KEYS:-build/image-keys}}
work=$out/bundle
# A terminal never accepts a sequence below one that it found good. A sequence that is too high by mistake would block
# every later update.
case $sequence in '' | *[!0-9]*) echo "bundle: SEQUENCE must be a number, not '$sequence'" >&2; exit 1 ;; esac
[ "$sequence" -le $(($(date +%s) + 86400)) ] || {
	echo "bundle: SEQUENCE $sequence is later than tomorrow; use \$(date +%s)" >&2
	exit 1
}
case $version_text in
*[!A-Za-z0-9._+~-]*) echo "bundle: VERSION may contain only letters, digits and . _ + ~ -, not '$version_text'" >&2; exit 1 ;;
esac
rm -rf "$work" "$out/gopura.raucb"
mkdir -p "$work"
ln "$out/root.squashfs" "$out/boot.img" "$work/"
cat >"$work/manifest.raucm" <<M
[update]
compatible=$compatible
version=$version_text
build=$sequence

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
