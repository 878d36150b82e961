#!/bin/bash
# kernel.sh FOLDER: unpacks Debian's generic kernel into the folder without installing it (the cloud kernel has no GPU
# drivers), and writes package.txt. Exit status 77 if no kernel can be downloaded.
set -eu
folder=$1
ls "$folder"/boot/vmlinuz-* "$folder/package.txt" >/dev/null 2>&1 && exit 0
skip() { echo "$*"; exit 77; }
package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '/Depends: linux-image/ { print $2; exit }')
[ -n "$package" ] || skip "no kernel package to be had (apt-cache knows no linux-image-amd64)"
mkdir -p "$folder"
(cd "$folder" && apt-get download "$package" >/dev/null 2>&1) || skip "the kernel package cannot be fetched"
dpkg-deb -x "$folder"/linux-image-*.deb "$folder"
# As a line of packages.txt (build.sh). Its own source, linux-signed-amd64, only adds signatures to what linux builds.
dpkg-deb -W --showformat '${Package}\t${Version}\t${Architecture}\tlinux\t${Version}\n' \
	"$folder"/linux-image-*.deb >"$folder/package.txt"
rm -f "$folder"/linux-image-*.deb
