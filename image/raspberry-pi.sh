#!/bin/bash
# raspberry-pi.sh PACKAGES FOLDER: puts into FOLDER what the loader's partition of a Raspberry Pi 4 holds beside the
# loader: the board's first programs (raspi-firmware), U-Boot (u-boot-rpi) and the kernel's device trees, all of them
# from the unpacked packages in PACKAGES (kernel.sh).
#
# The device trees tell U-Boot what to start (raspberry-pi/bootcmd), and to wait for no key, because a visitor's keyboard
# must not stop it. A file of settings would not do: U-Boot reads that from card 0, and the number of a board's card differs.
# TREES names device trees of other boards, to be changed in the same way.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
packages=$1 folder=$2
firmware=$packages/usr/lib/raspi-firmware
mkdir -p "$folder"
cp "$firmware/start4.elf" "$firmware/fixup4.dat" "$packages/usr/lib/u-boot/rpi_arm64/u-boot.bin" "$here/raspberry-pi/config.txt" "$folder/"
cp "$packages/usr/share/doc/raspi-firmware/copyright" "$folder/start4.txt" # its licence asks for that
bootcmd=$(grep -v '^#' "$here/raspberry-pi/bootcmd" | paste -sd';')
for tree in "$packages"/usr/lib/linux-image-*/broadcom/bcm2711-rpi-*.dtb ${TREES:-}; do
	to=$folder/$(basename "$tree")
	cp "$tree" "$to"
	fdtput -p -t s "$to" /config bootcmd "$bootcmd"
	fdtput -t x "$to" /config bootdelay fffffffe # -2: at once
done
