#!/bin/bash
# make-sticks.sh IMAGE_FOLDER WORK NAME...: makes update bundles for the sticks of appliance.py: always next (the same
# system, newer), tampered (next with one byte changed) and older (the image's own system, below the floor that next
# sets); by name also blank (boots, but its kiosk shows nothing) and hangs (the kernel stops half a minute after the
# start).
set -eu
cd "$(dirname "$0")/../.."
image=$1 work=$2
shift 2
rm -rf "$work"
mkdir -p "$work"

# stick NAME BUNDLE
stick() {
	rm -f "$work/$1.img"
	truncate -s "$(($(stat -c %s "$2") / 1048576 + 24))M" "$work/$1.img"
	echo 'start=1MiB, type=c' | sfdisk -q --label dos "$work/$1.img"
	mformat -i "$work/$1.img@@1M" -F ::
	mcopy -i "$work/$1.img@@1M" "$2" "::/$1.raucb"
}

# Each variant has a sequence one higher than the last.
sequence=$(sed -n 's/^IMAGE_SEQUENCE=//p' "$image/tree/usr/lib/os-release")

# variant NAME COMMAND...: the image's root, changed by a command that gets its folder
variant() {
	local name=$1 tree=$work/tree
	sequence=$((sequence + 1))
	shift
	rm -rf "$tree"
	cp -al "$image/tree" "$tree"
	cp --remove-destination "$image/tree/usr/lib/os-release" "$tree/usr/lib/os-release"
	sed -i "s/^IMAGE_VERSION=.*/&-$name/; s/^IMAGE_SEQUENCE=.*/IMAGE_SEQUENCE=$sequence/" "$tree/usr/lib/os-release"
	"$@" "$tree"
	rm -rf "$work/early"
	cp -a "$image/early" "$work/early"
	ln -f "$image/vmlinuz" "$work/vmlinuz"
	LEVEL=1 SOURCE_DATE_EPOCH=$sequence fakeroot image/slot.sh "$work"
	SEQUENCE=$sequence VERSION=$(sed -n 's/^IMAGE_VERSION=//p' "$tree/usr/lib/os-release") image/bundle.sh "$work"
	rm -rf "$tree" "$work"/{early,boot,vmlinuz}
	stick "$name" "$work/gopura.raucb"
}
unchanged() { :; }
blank() { printf '#!/bin/sh\nexec sleep infinity\n' >"$work/kiosk"; install -m 755 "$work/kiosk" "$1/usr/bin/gopura-kiosk.new"; mv "$1/usr/bin/gopura-kiosk.new" "$1/usr/bin/gopura-kiosk"; }
hangs() {
	mkdir -p "$1/etc/systemd/system/gopura.target.wants"
	# The service manager itself stops (its own answer to a fault is to freeze), which only the hardware's watchdog sees.
	printf '[Service]\nExecStart=/bin/sh -c "sleep 30; kill -ABRT 1"\n' >"$1/etc/systemd/system/hang.service"
	ln -s ../hang.service "$1/etc/systemd/system/gopura.target.wants/hang.service"
}
variant next unchanged
cp "$work/gopura.raucb" "$work/tampered.raucb"
tests/tools/flip_byte.sh "$work/tampered.raucb" $(($(stat -c %s "$work/tampered.raucb") / 2))
stick tampered "$work/tampered.raucb"
VERSION=before SEQUENCE=$((sequence - 2)) image/bundle.sh "$work"
stick older "$work/gopura.raucb"
for name; do
	variant "$name" "$name"
done
rm -f "$work"/*.squashfs "$work"/*.raucb "$work/boot.img" "$work/kiosk"
