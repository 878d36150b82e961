#!/bin/bash
# What of the image's recipe differs between architectures (image/arch.sh): an update bundle names its own, the lists of
# kernel modules have only architectures that exist, and no other architecture is taken.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
for tool in rauc mksquashfs openssl; do
	command -v $tool >/dev/null || skip "$tool is not installed"
done
work=build/e2e/arch
rm -rf "$work"
mkdir -p "$work/keys"
openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj '/CN=Test' -keyout "$work/keys/key.pem" -out "$work/keys/cert.pem" 2>/dev/null
found=()
for arch in amd64 arm64; do
	out=$work/$arch
	mkdir -p "$out"
	head -c 65536 /dev/urandom | tee "$out/root.squashfs" >"$out/boot.img"
	ARCH=$arch KEYS=$work/keys VERSION=v9 SEQUENCE=17 image/bundle.sh "$out"
	rauc --keyring="$work/keys/cert.pem" info --output-format=shell "$out/gopura.raucb" >"$out/info" 2>"$out/log" || fail "$arch: no bundle: $(cat "$out/log")"
	. "$out/info"
	found+=("$RAUC_MF_COMPATIBLE")
done
[ "${found[*]}" = "gopura-x86-64 gopura-arm64" ] || fail "bundles are for ${found[*]}"
# A terminal takes only bundles for what its own system.conf says, which image/assemble.sh sets in the same way.
grep -qx 'compatible=gopura-x86-64' image/root/etc/rauc/system.conf || fail "system.conf names another architecture"
status=0
ARCH=mips image/build.sh >"$work/log" 2>&1 || status=$?
[ $status = 1 ] && grep -q "ARCH must be amd64 or arm64, not 'mips'" "$work/log" || fail "ARCH=mips ends with $status: $(cat "$work/log")"
! grep -vE '^(#|((amd64|arm64) )?(early )?[a-zA-Z0-9_]+( [a-zA-Z0-9_]+)*$)' image/modules || fail "image/modules: a line in another form"

# ---- a date of snapshot.debian.org
. image/apt.sh
pinned=$(apt_from http://snapshot.debian.org/archive/%/20261101T000000Z | cut -d' ' -f4-)
[ "$pinned" = "http://snapshot.debian.org/archive/debian/20261101T000000Z bookworm main
http://snapshot.debian.org/archive/debian/20261101T000000Z bookworm-updates main
http://snapshot.debian.org/archive/debian-security/20261101T000000Z bookworm-security main" ] || fail "the lists of a date: $pinned"
[ "$(apt_from http://deb.debian.org | cut -d' ' -f3 | sort -u | paste -sd' ')" = "http://deb.debian.org/debian http://deb.debian.org/debian-security" ] ||
	fail "the lists of the mirror"
