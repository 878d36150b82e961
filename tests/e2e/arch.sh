#!/bin/bash
# What of the image's recipe differs between architectures (image/arch.sh): an update bundle names its own, the lists of
# kernel modules have only architectures that exist, and no other architecture is taken. And bundles of one commit.
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
# ---- a rebuild of the same commit with a number of its own is another version, which terminals tell systems apart by
facts() { # facts WITH...: those of a bundle that is built so
	env -u VERSION -u SEQUENCE ARCH=amd64 KEYS="$work/keys" "$@" image/bundle.sh "$work/amd64"
	rauc --keyring="$work/keys/cert.pem" info --output-format=shell "$work/amd64/gopura.raucb" 2>/dev/null |
		sed -nE "s/^RAUC_MF_(VERSION|BUILD)='(.*)'\$/\2/p" | paste -sd' '
}
described=$(git describe --always --dirty)
[ "$(facts SOURCE_DATE_EPOCH=16)" = "$described 16" ] || fail "a bundle of the commit is $(facts SOURCE_DATE_EPOCH=16)"
[ "$(facts SEQUENCE=18)" = "$described.18 18" ] || fail "a bundle with a number of its own is $(facts SEQUENCE=18)"
[ "$(facts SEQUENCE=18 VERSION=v8)" = "v8 18" ] || fail "a bundle with a name of its own is $(facts SEQUENCE=18 VERSION=v8)"

# ---- a terminal whose clock is years behind the certificate takes a bundle
if command -v faketime >/dev/null; then
	sed "s#^path=.*#path=$PWD/$work/keys/cert.pem#" image/root/etc/rauc/system.conf >"$work/system.conf"
	faketime 2020-01-01 rauc --conf="$work/system.conf" info "$work/amd64/gopura.raucb" >"$work/log" 2>&1 || fail "a clock that is behind: $(tail -n 1 "$work/log")"
else
	echo "not tested, faketime is not installed: a clock that is behind"
fi

refused() { # refused WHAT SETTING...: image/build.sh says so
	status=0
	env "${@:2}" image/build.sh >"$work/log" 2>&1 || status=$?
	[ $status = 1 ] && grep -qF "$1" "$work/log" || fail "${*:2} ends with $status: $(cat "$work/log")"
}
refused "ARCH must be amd64 or arm64, not 'mips'" ARCH=mips
refused "DATA=tpm was never tried on arm64" DATA=tpm ARCH=arm64
refused "BOARD must be raspberry-pi or nothing, not 'beagle'" BOARD=beagle
refused "BOARD=raspberry-pi has ARCH=arm64, not 'amd64'" BOARD=raspberry-pi ARCH=amd64
refused "DATA must be plain or tpm, not 'secret'" DATA=secret
! grep -vE '^(#|((amd64|arm64) )?(early )?[a-zA-Z0-9_]+( [a-zA-Z0-9_]+)*$)' image/modules || fail "image/modules: a line in another form"

# ---- a date of snapshot.debian.org
. image/apt.sh
pinned=$(apt_from http://snapshot.debian.org/archive/%/20261101T000000Z | cut -d' ' -f4-)
[ "$pinned" = "http://snapshot.debian.org/archive/debian/20261101T000000Z bookworm main
http://snapshot.debian.org/archive/debian/20261101T000000Z bookworm-updates main
http://snapshot.debian.org/archive/debian-security/20261101T000000Z bookworm-security main" ] || fail "the lists of a date: $pinned"
[ "$(apt_from http://deb.debian.org | cut -d' ' -f3 | sort -u | paste -sd' ')" = "http://deb.debian.org/debian http://deb.debian.org/debian-security" ] ||
	fail "the lists of the mirror"
[ "$(apt_from http://deb.debian.org 'main non-free-firmware' | cut -d' ' -f5- | sort -u)" = "main non-free-firmware" ] || fail "the components of the lists"

# ---- what a Raspberry Pi starts: U-Boot is told by the device tree, and asks nobody
command -v dtc >/dev/null || { echo "not tested, dtc is not installed: the device trees of a Raspberry Pi"; exit 0; }
packages=$work/packages
for file in lib/raspi-firmware/{start4.elf,fixup4.dat} lib/u-boot/rpi_arm64/u-boot.bin share/doc/raspi-firmware/copyright; do
	install -D /dev/null "$packages/usr/$file"
done
trees=$packages/usr/lib/linux-image-6.1/broadcom
mkdir -p "$trees"
echo '/dts-v1/; / { model = "A board"; };' | dtc -q -O dtb -o "$trees/bcm2711-rpi-4-b.dtb" -
image/raspberry-pi.sh "$packages" "$work/pi"
tree=$work/pi/bcm2711-rpi-4-b.dtb
[ "$(fdtget -t i "$tree" /config bootdelay)" = -2 ] || fail "U-Boot waits for a key"
case $(fdtget "$tree" /config bootcmd) in
'for card in 0 1 2; do if load mmc ${card}:1 ${kernel_addr_r} EFI/BOOT/BOOTAA64.EFI;'*';reset') ;;
*) fail "U-Boot is told: $(fdtget "$tree" /config bootcmd)" ;;
esac
[ "$(fdtget "$tree" / model)" = "A board" ] && [ -f "$work/pi/$(sed -n 's/^kernel=//p' "$work/pi/config.txt")" ] || fail "what the board's firmware starts is not there"
