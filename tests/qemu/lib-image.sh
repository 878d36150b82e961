#!/bin/bash
# lib-image.sh FOLDER: makes the appliance's image for the tests, FOLDER/gopura.img, with a small release inside and the
# journal on the serial line. An existing one is kept unless something that it is made of is newer.
set -eu
cd "$(dirname "$0")/../.."
. image/arch.sh
out=$1 console=ttyS0
[ "$ARCH" = amd64 ] || console=ttyAMA0
# QEMU's Raspberry Pi restarts as soon as its watchdog is started.
[ "$BOARD" != raspberry-pi ] || console='ttyS1 module_blacklist=bcm2835_wdt'
tests/qemu/make-release.sh build/qemu
made_of=(image systemd board/*.ini system/gopura.conf.example build/gopura-{kiosk,fetch,setup,health} build/qemu/release/release.json tests/qemu/lib-image.sh)
if [ -f "$out/gopura.raucb" ] && [ -z "$(find "${made_of[@]}" -newer "$out/gopura.img" -print -quit)" ]; then
	echo "image: $out/gopura.img is there"
	exit 0
fi
mkdir -p "$out"
conf=$(dirname "$out")
cp build/qemu/release/root/1.json "$conf/root.json"
printf '%s\n' '[release]' 'url = /usr/share/gopura/release' 'trust = root.json' '[health]' 'listen = 0.0.0.0:9100' >"$conf/gopura.conf"
# An emulated processor needs seconds for what a box does in a tenth of one. Another architecture is slower again: there
# a box's 90 s for a start are too few as well.
units=$conf/units
drop_in() { # drop_in UNIT LINE...
	mkdir -p "$units/gopura-$1.service.d"
	printf '%s\n' '[Service]' "${@:2}" >"$units/gopura-$1.service.d/emulated.conf"
}
rm -rf "$units"
drop_in kiosk WatchdogSec=120
[ "${DATA:-}" != tpm ] || drop_in setup 'ExecStartPre=/bin/cat /etc/machine-id' # for tpm.py
if [ "$ARCH" != amd64 ]; then
	drop_in kiosk WatchdogSec=300 TimeoutStartSec=900
	for unit in setup system usb; do
		drop_in "$unit" TimeoutStartSec=900
	done
fi
UNITS=$units CONF=$conf/gopura.conf RELEASE=build/qemu/release OUT=$out KERNEL="console=$console loglevel=5 systemd.journald.forward_to_console=1" LEVEL=${LEVEL:-3} TRACKER=no image/build.sh
