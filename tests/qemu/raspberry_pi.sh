#!/bin/bash
# raspberry_pi.sh: starts the image for a Raspberry Pi in QEMU's raspi3b: U-Boot with the device tree that the card holds
# (a Pi 3's, made in the same way, since QEMU 7.2 has no Pi 4), GRUB, the signed kernel, the verified root on the card, and
# systemd. QEMU has neither the board's own firmware nor its panel, so U-Boot is what it starts, and the kiosk finds no
# graphics card. Nor has it a watchdog that waits (lib-image.sh).
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
export BOARD=raspberry-pi
. image/arch.sh
for list in image/tools.txt "${tools[@]}"; do
	./deps.sh "$list" || skip "what makes an image cannot be installed here"
done
export PATH=$PATH:/usr/sbin:/sbin
work=build/qemu-$(basename "$image_folder")
image=$work/image log=$work/serial.log qemu=
mkdir -p "$work"
tests/qemu/lib-image.sh "$image"

# What the firmware of a board finds on its partition, and the device tree of a Pi 3, which the card has not.
card=$work/card.img firmware=$work/firmware
rm -rf "$firmware" "$work/trees"
mkdir -p "$firmware"
cp --sparse=always "$image/gopura.img" "$card"
truncate -s 2G "$card" # a card has a power of two bytes here, and the data partition grows
mcopy -i "$card@@1M" ::/u-boot.bin ::/start4.elf ::/fixup4.dat ::/config.txt ::/bcm2711-rpi-4-b.dtb "$firmware/"
kernel=$(sed -n 's/^kernel=//p' "$firmware/config.txt")
TREES=$(echo "$image"/kernel/usr/lib/linux-image-*/broadcom/bcm2837-rpi-3-b.dtb) image/raspberry-pi.sh "$image/kernel" "$work/trees"

finish() { [ -z "$qemu" ] || kill $qemu 2>/dev/null || true; rm -f "$card"; }
trap finish EXIT
: >"$log"
qemu-system-aarch64 -M raspi3b -kernel "$firmware/$kernel" -dtb "$work/trees/bcm2837-rpi-3-b.dtb" \
	-accel tcg,thread=multi,tb-size=256 -display none -drive "if=sd,format=raw,file=$card" -no-reboot \
	-serial null -serial "file:$log" &
qemu=$!
# said WHAT SECONDS: waits for a line of the log
said() {
	local until=$((SECONDS + $2))
	until grep -qaE "$1" "$log"; do
		[ $SECONDS -lt $until ] && kill -0 $qemu 2>/dev/null || {
			tail -c 2000 "$log" | tr -d '\033'
			echo "no '$1' in $2 s"
			exit 1
		}
		sleep 1
	done
	echo "$SECONDS s: $(grep -aoE "$1" "$log" | head -n 1)"
}
said 'devicetree: board' 60 # U-Boot: it has the device tree of the board, not one of its own
said 'Welcome to GRUB' 120
said 'gopura: starting slot a of /dev/mmcblk[0-9]' 600
said 'partition gopura-data was enlarged' 300
said 'Finished gopura-setup.service' 600
said 'Started gopura-fetch.service' 600
said 'gopura-self-test\[[0-9]+\]: ok +trust.*' 600
said 'gopura-kiosk\[[0-9]+\]: .*no graphics card.*' 600
! grep -qa 'Hit any key' "$log" || { echo "a key stops U-Boot"; exit 1; }
