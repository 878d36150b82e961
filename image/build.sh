#!/bin/bash
# image/build.sh: builds the bootable disk image of a terminal, build/image/gopura.img, from Debian 12 packages and the
# programs of this tree. Runs as root or as a user (mmdebstrap then needs user namespaces).
#
#   ARCH=arm64      for boards with UEFI firmware of that architecture (default: amd64); in build/image-arm64
#   BOARD=raspberry-pi   for a Raspberry Pi 4: the slots of arm64, and the board's own firmware; in build/image-raspberry-pi
#   MIRROR=URL      of Debian (default: http://deb.debian.org); a date of snapshot.debian.org pins every package, with % for
#                   debian and debian-security: http://snapshot.debian.org/archive/%/20261101T000000Z
#   FRESH=yes       install the packages anew: otherwise those of the last build are used (docs/upgrades.md)
#   RELEASE=FOLDER  a release to include, for a terminal that never gets a network
#   UNITS=FOLDER    drop-ins for systemd's units, as gopura-kiosk.service.d/later.conf
#   DATA=tpm        the terminal encrypts its data partition with a key of its TPM (docs/image.md)
#   CONF=FILE       the gopura.conf of the image; the files that it names must be beside it
#   KEYS=FOLDER     key.pem and cert.pem that sign updates, loader.key, secure-boot.key and provenance.key (docs/image.md; default:
#                   build/image-keys, created if missing)
#   SEQUENCE=N      of this system and its update bundle: a terminal installs none with a lower number than one it found good
#                   (default: the time of the commit, in seconds since 1970)
#   VERSION=TEXT    of this system (default: by git, followed by .N with SEQUENCE=N)
#   TRACKER=FILE    of Debian's known vulnerabilities, or its address (default: that of security-tracker.debian.org); "no" for
#                   no report
#   BUILDER=URI     of who builds, in provenance.json
#   OUT=FOLDER      instead of build/image, build/image-arm64 or build/image-raspberry-pi
#
# Output: base.tar (the packages), tree/ (the complete root), root.squashfs and boot.img (a slot), esp.vfat, gopura.img,
# gopura.raucb (an update to the same system), packages.txt and sbom.spdx.json: what it is made of, vulnerabilities.txt:
# what is known about that, provenance.json: where it comes from, signed, and left-out.txt: files of the packages that
# are not in the image.
# docs/image.md explains the layout of the disk.
set -eu
cd "$(dirname "$0")/.."
. image/arch.sh
. image/apt.sh
here=$PWD/image out=${OUT:-$image_folder} mirror=${MIRROR:-http://deb.debian.org}
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)} LC_ALL=C TZ=UTC
export PATH=$PATH:/usr/sbin:/sbin
slot_mib=300 boot_mib=48 esp_mib=64 data_mib=${DATA_MIB:-512}
case ${DATA:-plain} in
plain | tpm) ;;
*) echo "image: DATA must be plain or tpm, not '$DATA'" >&2; exit 1 ;;
esac
# There the loader starts the kernel through the firmware, which may measure it: then each update would lose the data.
[ "${DATA:-plain}" != tpm ] || [ "$ARCH" = amd64 ] || { echo "image: DATA=tpm was never tried on $ARCH: leave it out (docs/image.md)" >&2; exit 1; }
mkdir -p "$out"
out=$(cd "$out" && pwd)
say() { echo "image: $*"; }
list() { grep -v '^#' "$1"; }

# ---- Debian's packages; made again if asked for, or if their list or the mirror changes
package_form='\${Package}\t\${Version}\t\${Architecture}\t\${source:Package}\t\${source:Version}\n'
key=$({ list image/packages; echo "$ARCH $mirror $package_form"; } | sha256sum | cut -c1-16)
if [ "${FRESH:-no}" = yes ] || [ "$(cat "$out/base.key" 2>/dev/null)" != "$key" ]; then
	if [ -n "$cross" ] && ! arch-test "$ARCH" >/dev/null; then
		echo "image: this machine cannot run programs for $ARCH, as installing packages needs: install image/tools-arm64.txt," \
			"and as root: mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc; update-binfmts --enable" >&2
		exit 1
	fi
	say "installing packages into base.tar"
	rm -rf "$out/base.key" "$out/kernel"
	mmdebstrap --architectures="$ARCH" --variant=essential --include="$(list image/packages | paste -sd,)" \
		--aptopt='APT::Install-Recommends "false"' \
		--dpkgopt='path-exclude=/usr/share/man/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
		--customize-hook='chroot "$1" dpkg-query -W -f "'"$package_form"'" >"$1/packages.txt"' \
		bookworm "$out/base.tar" - <<<"$(apt_from "$mirror")" >"$out/base.log" 2>&1 ||
		{ tail -n 20 "$out/base.log" >&2; exit 1; }
	echo "$key" >"$out/base.key"
fi
COMPONENTS=$components image/kernel.sh "$out/kernel" busybox-static "grub-efi-$ARCH-bin" grub-common "${board_packages[@]}"

# ---- the programs, without support for a desktop window
compiler=()
if [ -n "$cross" ]; then
	image/sysroot.sh
	root=$PWD/build/$ARCH/sysroot
	export PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root/usr/lib/$triplet/pkgconfig:$root/usr/share/pkgconfig
	compiler=(CC="$(command -v ccache || true) ${cross}gcc --sysroot=$root")
fi
make --no-print-directory -j"$(nproc)" WINDOW=no BUILD="$programs" "${compiler[@]}" \
	"$programs"/gopura-{kiosk,fetch,setup,health}

# ---- the key that signs updates
keys=${KEYS:-build/image-keys}
if [ ! -f "$keys/key.pem" ]; then
	mkdir -p "$keys"
	(umask 077 && openssl req -x509 -newkey rsa:3072 -nodes -days 7300 -subj '/CN=Gopura updates' \
		-keyout "$keys/key.pem" -out "$keys/cert.pem" 2>/dev/null)
	say "made keys for updates in $keys: keep a copy of key.pem in a safe place"
fi
KEYS=$keys image/loader-keys.sh make 2>/dev/null

# ---- root, slot and disk; all files belong to root
say "assembling the root"
. image/version.sh
export here out keys triplet grub loader compatible cross programs version_text sequence slot_mib boot_mib esp_mib data_mib
KEYS=$keys fakeroot image/assemble.sh
image/sbom.sh "$out/packages.txt" "$version_text" >"$out/sbom.spdx.json"
VERSION=$version_text SEQUENCE=$sequence image/bundle.sh "$out"
KEYS=$keys MIRROR=$mirror VERSION=$version_text SEQUENCE=$sequence \
	image/provenance.sh make "$out" gopura.img gopura.raucb root.squashfs boot.img >"$out/provenance.json"
rm -f "$out/vulnerabilities.txt"
tracker=${TRACKER:-https://security-tracker.debian.org/tracker/data/json}
if [ "$tracker" != no ]; then
	status=0
	image/vulnerabilities.sh "$out/packages.txt" "$tracker" >"$out/vulnerabilities.new" || status=$?
	case $status in
	0 | 3) mv "$out/vulnerabilities.new" "$out/vulnerabilities.txt" ;;
	*) rm "$out/vulnerabilities.new"; say "no report of known vulnerabilities; make it where the tracker can be reached (docs/upgrades.md)" ;;
	esac
	[ $status != 3 ] || say "an update mends known vulnerabilities of these packages: build with FRESH=yes (docs/upgrades.md)"
fi
say "$(stat -c %s "$out/root.squashfs" | awk '{ printf "a slot has %.0f MB", $1 / 1e6 }'), the image $(du -m "$out/gopura.img" | cut -f1) MiB: $out/gopura.img"
