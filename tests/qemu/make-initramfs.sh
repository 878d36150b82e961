#!/bin/bash
# make-initramfs.sh KERNEL_DIR RELEASE OUT: makes the smallest system that runs the kiosk on a KMS card.
set -eu
kernel=$1 release=$2 out=$3
root=$(dirname "$out")/root
lib=/usr/lib/x86_64-linux-gnu
rm -rf "$root"
mkdir -p "$root"/{bin,dev,proc,sys,tmp,run,etc/fonts,modules,release,usr/share/fonts,usr/share/glvnd/egl_vendor.d}
cp /bin/busybox "$root/bin/"
for name in sh mount insmod mkdir sleep poweroff cat ls grep tee sed date; do ln -s busybox "$root/bin/$name"; done
cp -r "$release/." "$root/release/"

# Modules, in the order of their dependencies.
for name in virtio_ring virtio virtio_pci_legacy_dev virtio_pci_modern_dev virtio_pci virtio_dma_buf \
	drm drm_kms_helper drm_shmem_helper virtio-gpu evdev virtio_input; do
	module=$(find "$kernel/lib/modules" -name "$name.ko*" | head -1)
	[ -n "$module" ] || continue # built in
	cp "$module" "$root/modules/"
	echo "$(basename "$module")" >>"$root/modules/order"
done

# The programs, their libraries, and what Mesa and Pango load by name.
copy_with_libraries() {
	local file
	for file in "$@"; do
		mkdir -p "$root$(dirname "$file")"
		cp -Lu "$file" "$root$file"
		ldd "$file" 2>/dev/null | grep -oE '/[^ ]+' | sort -u | while read -r library; do
			[ -f "$root$library" ] || { mkdir -p "$root$(dirname "$library")"; cp -L "$library" "$root$library"; }
		done
	done
}
for program in gopura-kiosk gopura-fetch; do
	cp "build/$program" "$root/bin/"
	strip "$root/bin/$program"
	ldd "build/$program" | grep -oE '/[^ ]+' | sort -u | while read -r library; do
		[ -f "$root$library" ] || { mkdir -p "$root$(dirname "$library")"; cp -L "$library" "$root$library"; }
	done
done
cp build/tests/tools/lost_gl.so "$root/"
copy_with_libraries "$lib/libEGL_mesa.so.0" "$lib/libGLESv2.so.2"
mkdir -p "$root$lib/dri"
cp -L "$lib/dri/kms_swrast_dri.so" "$root$lib/dri/kms_swrast_dri.so"
for driver in swrast_dri.so virtio_gpu_dri.so; do ln "$root$lib/dri/kms_swrast_dri.so" "$root$lib/dri/$driver"; done
ldd "$lib/dri/kms_swrast_dri.so" | grep -oE '/[^ ]+' | sort -u | while read -r library; do
	[ -f "$root$library" ] || { mkdir -p "$root$(dirname "$library")"; cp -L "$library" "$root$library"; }
done
cp /usr/share/glvnd/egl_vendor.d/50_mesa.json "$root/usr/share/glvnd/egl_vendor.d/"
for font in NotoSans-Regular NotoSans-Bold NotoSansKhmer-Regular; do
	cp "/usr/share/fonts/truetype/noto/$font.ttf" "$root/usr/share/fonts/" 2>/dev/null || true
done
mkdir -p "$root/usr/lib/locale/C.utf8"
cp -r /usr/lib/locale/C.utf8/LC_MESSAGES "$root/usr/lib/locale/C.utf8/"
cp -r build/locale "$root/usr/share/"
cat >"$root/etc/fonts/fonts.conf" <<'C'
<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir>/usr/share/fonts</dir><cachedir>/tmp/fonts</cachedir></fontconfig>
C
cat >"$root/init" <<'C'
#!/bin/sh
mount -t devtmpfs dev /dev; mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t tmpfs tmp /tmp
while read -r module; do insmod /modules/$module || echo "insmod $module failed"; done </modules/order
for _ in 1 2 3 4 5 6 7 8 9 10; do [ -e /dev/dri/card0 ] && break; sleep 0.2; done
# Under TCG with -cpu max, wide vectors are emulated and slow.
export LP_NATIVE_VECTOR_WIDTH=128 HOME=/tmp MESA_SHADER_CACHE_DIR=/tmp
echo "init: starting the kiosk" >/dev/console
kiosk() {
	LD_PRELOAD=$preload LOST_GL=/tmp/lost LOST_GL_BY=swap /bin/gopura-kiosk --display drm --release /release --trust /release/root/1.json --state /tmp/state --log debug "$@" 2>&1
	echo "init: the kiosk ended with status $?"
}
self_test() {
	/bin/gopura-kiosk --self-test --display drm --trust /release/root/1.json --state /tmp/state 2>&1
}
said() { until grep -q "$1" /tmp/log; do sleep 0.2; done; }
: >/tmp/log
. /lib-init.sh # what the kernel's command line asks for
sleep 1
poweroff -f
C
cp "$(dirname "$0")/lib-init.sh" "$root/"
chmod +x "$root/init"
(cd "$root" && find . | cpio -o -H newc --quiet) >"$out"
echo "initramfs: $(($(stat -c %s "$out") / 1048576)) MiB"
