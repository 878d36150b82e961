#!/bin/bash
# The kiosk on a KMS card, inside QEMU without KVM: virtio-gpu, virtio-tablet, an initramfs with only the kiosk and a
# small release: a panel that is off until a tap, and another tap through QMP, which opens a card that the screendump shows;
# a panel that is unplugged and plugged in; the safe page.
# Pictures: build/qemu/*.ppm.
set -eu
cd "$(dirname "$0")/../.."
skip() { echo "$*"; exit 77; }
command -v qemu-system-x86_64 >/dev/null || skip "qemu-system-x86 is not installed"
[ -f /bin/busybox ] || skip "busybox-static is not installed"
here=tests/qemu work=build/qemu
mkdir -p "$work"

image/kernel.sh "$work/kernel"
kernel=$(ls "$work"/kernel/boot/vmlinuz-*)

tests/qemu/make-release.sh "$work"
"$here/make-initramfs.sh" "$work/kernel" "$work/release" "$work/initramfs.cpio"
exec python3 "$here/plug.py" "$kernel" "$work/initramfs.cpio" "$work"
