#!/bin/bash
# sysroot.sh: unpacks what the programs for arm64 are compiled and linked against, Debian's packages, into
# build/arm64/sysroot; nothing of another architecture is installed. They are fetched again only if the lists of
# packages or MIRROR change. Exit status 77 if they cannot be had.
set -eu
cd "$(dirname "$0")/.."
. image/apt.sh
root=$PWD/build/arm64/sysroot packages=build/arm64/packages mirror=${MIRROR:-http://deb.debian.org}
wanted=$(grep -h -- '-dev$' packages.txt tests/tools.txt)
key="$mirror $wanted"
[ "$key" != "$(cat "$root/.of" 2>/dev/null)" ] || exit 0
rm -rf "$root"
mkdir -p "$root"
# shellcheck disable=SC2086
{ apt_start "$packages" arm64 "$mirror" && apt_in "$packages" get -qq install -y --download-only $wanted; } >build/arm64/apt.log 2>&1 ||
	{ tail -n 3 build/arm64/apt.log; echo "packages of arm64 could not be fetched"; exit 77; }
for deb in "$packages"/cache/archives/*.deb; do
	dpkg-deb -x "$deb" "$root"
done
# Names that begin at the root would be this machine's. And qemu-user takes every file from here that is here: fonts,
# settings and folders for temporary files are to be this machine's.
find "$root"/usr/lib "$root"/lib -type l -lname '/*' | while read -r link; do
	ln -sfnr "$root$(readlink "$link")" "$link"
done
rm -rf "$root"/{etc,var,tmp,bin,sbin} "$root"/usr/{bin,sbin,share/fonts,share/doc} "$packages"
echo "$key" >"$root/.of"
