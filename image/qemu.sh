#!/bin/bash
# qemu.sh: runs the appliance's image in QEMU for trying it out, in a window on a desktop, else on a screen for a VNC
# viewer; the mouse acts as a finger. The image contains the demo's release if that was made, else a small one.
#
#   KVM=yes     use the processor's virtualisation, many times faster, if available
#   SIZE=WxH    of the panel (1280x720)
#
# The disk keeps what the terminal writes: build/qemu-image/person.img; remove it to start anew.
set -eu
cd "$(dirname "$0")/.."
work=build/qemu-image release=build/demo/release size=${SIZE:-1280x720}
firmware=/usr/share/OVMF
mkdir -p "$work"
[ -f "$release/release.json" ] || { tests/qemu/make-release.sh build/qemu; release=build/qemu/release; }
RELEASE=$release OUT=$work/demo image/build.sh
if [ ! -f "$work/person.img" ] || [ "$work/demo/gopura.img" -nt "$work/person.img" ]; then
	cp --sparse=always "$work/demo/gopura.img" "$work/person.img"
	cp "$firmware/OVMF_VARS_4M.fd" "$work/person-variables.fd"
fi
machine=(-accel "tcg,thread=multi" -cpu Nehalem)
[ "${KVM:-}" != yes ] || machine=(-accel kvm -cpu host)
if [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] && qemu-system-x86_64 -display help | grep -qx gtk; then
	screen=gtk
else
	screen=vnc=127.0.0.1:7
	echo "qemu: look at the panel with a VNC viewer at 127.0.0.1:5907; Ctrl-C ends the terminal"
fi
echo "qemu: without KVM=yes the first picture takes about half a minute"
exec qemu-system-x86_64 "${machine[@]}" -smp 2 -m 2048 -nodefaults -vga none -display "$screen" \
	-device "virtio-gpu-pci,xres=${size%x*},yres=${size#*x}" -device virtio-tablet-pci -device qemu-xhci \
	-drive "if=pflash,format=raw,readonly=on,file=$firmware/OVMF_CODE_4M.fd" \
	-drive "if=pflash,format=raw,file=$work/person-variables.fd" \
	-drive "file=$work/person.img,if=none,id=disk,format=raw" -device virtio-blk-pci,drive=disk,bootindex=0 \
	-netdev user,id=net -device virtio-net-pci,netdev=net,romfile= -device i6300esb -action watchdog=reset
