# arch.sh: to be sourced. What differs between the architectures that an image is built for: ARCH=amd64 (the default) or
# ARCH=arm64, both with UEFI firmware.
ARCH=${ARCH:-amd64}
cross='' image_folder=build/image programs=build/appliance tools=()
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
export ARCH
