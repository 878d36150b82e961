#!/bin/bash
# assemble.sh: called by build.sh under fakeroot, with its variables. Puts base.tar, the kernel and the programs into
# tree/, makes the images of a slot from tree/, and a disk from those.
set -eu
tree=$out/tree kernel=$out/kernel
version=$(basename "$kernel"/lib/modules/*)
list() { grep -v '^#' "$1"; }
# modules: the lines of image/modules for this architecture
modules() { list "$here/modules" | awk -v arch="$ARCH" '$1 == "amd64" || $1 == "arm64" { if ($1 != arch) next; sub(/^[^ ]* /, "") } { print }'; }
rm -rf "$tree"
mkdir -p "$tree"
tar -x --exclude=./dev -C "$tree" -f "$out/base.tar"
: >"$out/left-out.txt"
left_out() { echo "$*" >>"$out/left-out.txt"; }

# ---- remove what only serves to build or administer a Debian system
cat "$tree/packages.txt" "$kernel/package.txt" >"$out/packages.txt"
rm "$tree/packages.txt"
for path in usr/bin/perl* usr/lib/"$triplet"/perl* usr/lib/"$triplet"/libperl* usr/share/perl* \
	usr/bin/apt* usr/bin/dpkg* usr/lib/apt usr/lib/dpkg var/lib/dpkg var/lib/apt var/cache var/log \
	usr/share/doc usr/share/info usr/share/bash-completion usr/share/zsh usr/share/lintian usr/share/debconf \
	usr/share/bug usr/lib/udev/hwdb.d usr/share/gcc usr/share/common-licenses \
	usr/sbin/agetty sbin/agetty usr/bin/login bin/login bin/su usr/bin/passwd usr/bin/chsh usr/bin/chfn usr/bin/newgrp usr/bin/gpasswd; do
	for file in "$tree"/$path; do
		[ -e "$file" ] || [ -L "$file" ] || continue
		left_out "/${file#"$tree"/}"
		rm -rf "$file"
	done
done

# ---- fonts, by list
find "$tree/usr/share/fonts" -type f -name '*.tt[fc]' | sort | while read -r font; do
	list "$here/fonts" | grep -qxF "$(basename "$font")" || { left_out "${font#"$tree"}"; rm "$font"; }
done

list "$here/fonts" | while read -r font; do
	[ -n "$(find "$tree/usr/share/fonts" -name "$font" -print -quit)" ] || { echo "image/fonts: no package contains $font" >&2; exit 1; }
done

# ---- kernel modules, by list
kept=$tree/usr/lib/modules/$version
mkdir -p "$kept"
cp "$kernel/lib/modules/$version"/modules.{order,builtin,builtin.modinfo} "$kept/"
depmod -b "$kernel" "$version"
# wanted TO NAME...: copies the modules and all their dependencies
wanted() {
	local to=$1 name
	shift
	for name in "$@"; do
		modprobe -d "$kernel" -S "$version" --show-depends "$name" 2>/dev/null || echo "missing $name"
	done | awk '$1 == "insmod" { print $2 } $1 == "missing" { print "no module " $2 > "/dev/stderr" }' | sort -u |
		while read -r file; do
			file=${file#"$kernel"/lib/modules/"$version"/}
			mkdir -p "$to/$(dirname "$file")"
			cp "$kernel/lib/modules/$version/$file" "$to/$file"
		done
}
# shellcheck disable=SC2046
wanted "$kept" $(modules | sed 's/^early //')
(cd "$kernel/lib/modules/$version" && find . -name '*.ko' | sort) | while read -r file; do
	[ -f "$kept/$file" ] || left_out "/usr/lib/modules/$version/${file#./}"
done
depmod -b "$tree/usr" -m /lib/modules "$version" 2>/dev/null || depmod -b "$tree" "$version"

# ---- our programs
for program in gopura-kiosk gopura-fetch gopura-setup gopura-health; do
	install -m 755 -s --strip-program="${cross}strip" "$programs/$program" "$tree/usr/bin/$program"
done
install -D "$kernel/usr/bin/grub-editenv" "$tree/usr/lib/gopura/grub-editenv" # behind image/root/usr/bin/grub-editenv
# libraries FILE...: prints every library of the tree that the files ask for, or one of those does; all must be there
asked() { "${cross}readelf" -d "$@" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u; }
libraries() {
	local seen=' ' ask files library file
	ask=$(asked "$@")
	while [ -n "$ask" ]; do
		files=()
		for library in $ask; do
			case $seen in *" $library "*) continue ;; esac
			seen+="$library "
			file=$(find "$tree/usr/lib" -name "$library" -print -quit)
			[ -n "$file" ] || { echo "image: no package of image/packages contains $library" >&2; exit 1; }
			echo "$file"
			files+=("$(realpath "$file")")
		done
		ask=
		[ ${#files[@]} = 0 ] || ask=$(asked "${files[@]}")
	done
}
libraries "$tree"/usr/bin/gopura-* "$tree/usr/lib/gopura/grub-editenv" >/dev/null
# The kiosk's texts. They need the locale C.UTF-8, which the C library brings (ui/translate.c).
mkdir -p "$tree/usr/share/locale"
cp -r "$programs/locale/." "$tree/usr/share/locale/"
[ -d "$tree/usr/lib/locale/C.utf8" ] || { echo "image: no package of image/packages contains the locale C.UTF-8" >&2; exit 1; }
cp -r "$here/root/." "$tree/"
sed -i "s/^compatible=.*/compatible=$compatible/" "$tree/etc/rauc/system.conf"
install -m 644 systemd/* "$tree/usr/lib/systemd/system/"
rm "$tree"/usr/lib/systemd/system/gopura-{curator,publisher}.service # for the machine with the scans
[ -z "${UNITS:-}" ] || cp -r "$UNITS/." "$tree/etc/systemd/system/"
# The font cache is made here, because fontconfig has nothing to find out at run time.
sed -i -e 's|<cachedir>/var/cache/fontconfig</cachedir>|<cachedir>/usr/share/fonts/cache</cachedir>|' \
	-e '/<cachedir prefix="xdg"/d' -e '/<cachedir>~/d' "$tree/etc/fonts/fonts.conf"
mkdir -p "$tree/usr/share/fonts/cache"
mkdir -p "$tree"/{dev,proc,sys,run,tmp,var,efi} "$tree/usr/share/gopura/board"
install -m 644 board/*.ini "$tree/usr/share/gopura/board/"
install -m 644 "$keys/cert.pem" "$tree/etc/rauc/keyring.pem"
printf 'IMAGE_ID=gopura\nIMAGE_VERSION=%s\nIMAGE_SEQUENCE=%s\n' "$version_text" "$sequence" >>"$tree/usr/lib/os-release"
: >"$tree/usr/lib/clock-epoch" # systemd sets a clock that is behind to the time of this file
if [ -n "${RELEASE:-}" ]; then
	cp -r "$RELEASE" "$tree/usr/share/gopura/release"
fi
systemd-sysusers --root="$tree"
rm -rf "$tree"/etc/systemd/system/*.wants
# No shell on any console, whatever unit asks for one.
for unit in getty.target getty@.service autovt@.service serial-getty@.service console-getty.service container-getty@.service \
	debug-shell.service emergency.service emergency.target rescue.service rescue.target systemd-logind.service ctrl-alt-del.target; do
	ln -sfn /dev/null "$tree/etc/systemd/system/$unit"
done
systemctl --root="$tree" preset-all 2>"$out/preset.log" || { cat "$out/preset.log" >&2; exit 1; }
systemctl --root="$tree" set-default gopura.target 2>/dev/null
rm -f "$tree/etc/machine-id" "$tree/var/lib/dbus/machine-id" "$tree"/etc/{hostname,resolv.conf}
: >"$tree/etc/machine-id"
ln -s /run/gopura/hostname "$tree/etc/hostname"
ln -s /run/systemd/resolve/stub-resolv.conf "$tree/etc/resolv.conf"
ln -sfn /run/gopura/localtime "$tree/etc/localtime"
rm -rf "$tree"/var/* "$tree"/run/* "$tree"/tmp/*
rm -rf "$tree"/{boot,media,mnt,opt} "$tree"/{home,srv}/*  # systemd-tmpfiles wants these two
find "$tree" -newermt "@$SOURCE_DATE_EPOCH" -exec touch -hcd "@$SOURCE_DATE_EPOCH" {} +
fc-cache -s -y "$tree"

# ---- the slot: kernel, initramfs and root (slot.sh)
early=$out/early
rm -rf "$early"
mkdir -p "$early"/{bin,dev,proc,sys,root,lib/modules/"$version"}
cp "$kernel/bin/busybox" "$early/bin/"
# dmsetup makes the verified root, which its libraries are on: it brings its own.
install -D "$tree/usr/sbin/dmsetup" "$early/bin/dmsetup"
mkdir -p "$early/usr/lib/$triplet"
libraries "$early/bin/dmsetup" | xargs cp -Lt "$early/usr/lib/$triplet"
interpreter=$("${cross}readelf" -l "$early/bin/dmsetup" | sed -n 's/.*program interpreter: \(.*\)\]/\1/p')
install -D "$(find "$tree/usr/lib" -name "${interpreter##*/}" -print -quit)" "$early$interpreter"
for name in sh mount umount cat grep sed find sort xargs modprobe sleep reboot chroot wc tr mv mkdir ln dd hexdump switch_root basename readlink; do
	ln -s busybox "$early/bin/$name"
done
install -m 755 "$here/init" "$early/init"
[ "${DATA:-plain}" != tpm ] || : >"$early/encrypt-data"
cp "$kernel/lib/modules/$version"/modules.{order,builtin} "$early/lib/modules/$version/"
# shellcheck disable=SC2046
wanted "$early/lib/modules/$version" $(modules | sed -n 's/^early //p') 2>/dev/null
depmod -b "$early" "$version" 2>/dev/null
cp "$kernel"/boot/vmlinuz-* "$out/vmlinuz"
image/slot.sh "$out"

# ---- the loader's partition
esp=$out/esp.vfat
rm -f "$esp"
truncate -s "${esp_mib}M" "$esp"
mformat -i "$esp" -F -v GOPURA -N 676f7075 ::
# The loader holds its own settings, and the public key that all it reads must be signed with, but for grubenv.
rm -rf "$out/loader"
mkdir -p "$out/loader/boot/grub"
parameters=${KERNEL:-}
# A panel of a Raspberry Pi shows only memory from there: three pictures of 3840 x 2160.
[ "$BOARD" != raspberry-pi ] || parameters="cma=128M $parameters"
sed "s|@KERNEL@|$parameters|" "$here/grub.cfg" >"$out/loader/boot/grub/grub.cfg"
tar -c --format=ustar --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 -C "$out/loader" -f "$out/loader.tar" boot
grub-mkimage -d "$kernel/usr/lib/grub/$grub" -O "$grub" -m "$out/loader.tar" -k "$keys/loader.pub" --disable-shim-lock \
	-o "$out/$loader" part_gpt fat ext2 normal configfile linux boot regexp loadenv probe test echo sleep reboot minicmd \
	all_video memdisk tar pgp gcry_rsa gcry_sha256
sbsign --key "$keys/secure-boot.key" --cert "$keys/secure-boot.crt" --output "$out/$loader" "$out/$loader" 2>"$out/sbsign.log" ||
	{ cat "$out/sbsign.log" >&2; exit 1; }
openssl x509 -in "$keys/secure-boot.crt" -outform DER -out "$out/secure-boot.cer"
grub-editenv "$out/grubenv" create
grub-editenv "$out/grubenv" set ORDER="A B" A_OK=1 A_TRY=0 B_OK=0 B_TRY=0
rm -rf "$out/board"
if [ "$BOARD" = raspberry-pi ]; then
	"$here/raspberry-pi.sh" "$kernel" "$out/board"
	mcopy -i "$esp" "$out"/board/* ::/
fi
mmd -i "$esp" ::/EFI ::/EFI/BOOT ::/gopura
mcopy -i "$esp" "$out/$loader" "::/EFI/BOOT/$loader"
mcopy -i "$esp" "$out/grubenv" "$out/secure-boot.cer" ::/gopura/
conf=${CONF:-}
if [ -z "$conf" ] && [ -n "${RELEASE:-}" ]; then
	conf=$out/gopura.conf
	printf '%s\n' '[release]' 'url = /usr/share/gopura/release' 'trust = root.json' >"$conf"
	cp "$RELEASE/root/1.json" "$out/root.json"
fi
if [ -n "$conf" ]; then
	mcopy -i "$esp" "$conf" ::/gopura.conf
	sed -nE 's/^ *(trust|ca) *= *([^ ]+).*/\2/p' "$conf" | while read -r file; do
		mcopy -i "$esp" "$(dirname "$conf")/$file" "::/$file"
	done
fi
mcopy -i "$esp" system/gopura.conf.example ::/gopura.conf.example

# ---- the disk
disk=$out/gopura.img
rm -f "$disk" "$out/data.ext4"
# Blocks and inodes are sized as on a large disk, because the small file system grows later (image/init).
mke2fs -q -t ext4 -b 4096 -I 256 -i 16384 -L gopura-data "$out/data.ext4" "${data_mib}M" 2>/dev/null
table=$out/disk.sfdisk
printf '%s\n' 'label: gpt' 'label-id: 6F707572-6100-4000-8000-0000000000FF' >"$table"
start=1 number=0
put=()
partition() { # NAME MIB TYPE [FILE]
	number=$((number + 1))
	echo "start=${start}MiB, size=$2MiB, type=$3, name=gopura-$1, uuid=6F707572-6100-4000-8000-00000000010$number" >>"$table"
	[ -z "${4:-}" ] || put+=("$4:$start")
	start=$((start + $2))
}
partition esp "$esp_mib" U "$esp"
partition boot-a "$boot_mib" L "$out/boot.img"
partition boot-b "$boot_mib" L
partition root-a "$slot_mib" L "$out/root.squashfs"
partition root-b "$slot_mib" L
partition data "$data_mib" L "$out/data.ext4"
truncate -s "$((start + 1))M" "$disk"
sfdisk -q "$disk" <"$table"
for entry in "${put[@]}"; do
	dd if="${entry%:*}" of="$disk" bs=1M seek="${entry##*:}" conv=notrunc,sparse status=none
done
