# arch.sh: to be sourced. What differs between the machines that an image is built for: ARCH=amd64 (the default) or
# ARCH=arm64, both with UEFI firmware, or BOARD=raspberry-pi, which is arm64 with the board's own firmware.
BOARD=${BOARD:-}
case $BOARD in
'') ARCH=${ARCH:-amd64} ;;
raspberry-pi) ARCH=${ARCH:-arm64} ;;
*)
	echo "image: BOARD must be raspberry-pi or nothing, not '$BOARD'" >&2
	exit 1
	;;
esac
cross='' image_folder=build/image programs=build/appliance tools=() board_packages=() components=main
case $ARCH in
amd64)
	triplet=x86_64-linux-gnu grub=x86_64-efi loader=BOOTX64.EFI compatible=gopura-x86-64
	;;
arm64)
	triplet=aarch64-linux-gnu grub=arm64-efi loader=BOOTAA64.EFI compatible=gopura-arm64
	image_folder=build/image-arm64 programs=build/arm64/appliance tools=(image/tools-arm64.txt)
	[ "$(uname -m)" = aarch64 ] || cross=$triplet-
	;;
*)
	echo "image: ARCH must be amd64 or arm64, not '$ARCH'" >&2
	exit 1
	;;
esac
if [ -n "$BOARD" ]; then
	[ "$ARCH" = arm64 ] || { echo "image: BOARD=$BOARD has ARCH=arm64, not '$ARCH'" >&2; exit 1; }
	image_folder=build/image-$BOARD
	board_packages=(u-boot-rpi raspi-firmware) components='main non-free-firmware' # only the firmware is not free
fi
export ARCH BOARD
