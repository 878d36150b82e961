#!/bin/bash
# kernel.sh FOLDER [PACKAGE...]: unpacks Debian's generic kernel into the folder without installing it (the cloud kernel
# has no GPU drivers), and other packages beside it, and writes package.txt. MIRROR and ARCH as in build.sh; COMPONENTS of
# Debian (main). Exit status 77 if they cannot be downloaded.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/apt.sh"
folder=$1 arch=${ARCH:-amd64} mirror=${MIRROR:-http://deb.debian.org} components=${COMPONENTS:-main}
shift
key="$arch $mirror $components $*"
[ "$(cat "$folder/key" 2>/dev/null)" != "$key" ] || exit 0
skip() { echo "$*"; exit 77; }
rm -rf "$folder"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
lists=$folder/apt
apt_start "$lists" "$arch" "$mirror" "$components" >"$folder/apt.log" 2>&1 || skip "no lists of packages to be had: $(tail -n 1 "$folder/apt.log")"
kernel=$(apt_in "$lists" cache depends "linux-image-$arch" 2>/dev/null | awk '/Depends: linux-image/ { print $2; exit }')
[ -n "$kernel" ] || skip "no kernel package to be had (apt-cache knows no linux-image-$arch)"
(cd "$lists" && apt_in . get -qq download "$kernel" "$@" >"$folder/apt.log" 2>&1) || skip "packages cannot be fetched: $(tail -n 1 "$folder/apt.log")"
for package in "$lists"/*.deb; do
	dpkg-deb -x "$package" "$folder"
	# As a line of packages.txt (build.sh). The kernel's own source, linux-signed-*, only adds signatures to what linux builds.
	dpkg-deb -W --showformat '${Package}\t${Version}\t${Architecture}\t${source:Package}\t${source:Version}\n' "$package" |
		awk -F '\t' -v OFS='\t' '$4 ~ /^linux-signed/ { $4 = "linux"; $5 = $2 } { print }'
done >"$folder/package.txt"
rm -r "$lists" "$folder/apt.log"
echo "$key" >"$folder/key"
