#!/bin/bash
# What image/init does when a disk, a TPM or a partition fails, once or for good: the script as it is, in a folder that
# stands for the initramfs, with the programs that it calls simulated. (tests/qemu/worn.sh boots the image on a disk that
# cannot be written.)
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
busybox=$(PATH=$PATH:/bin command -v busybox) || skip "busybox-static is not installed"
in_folder=(unshare --user --map-root-user --mount)
"${in_folder[@]}" true 2>/dev/null || skip "no user namespaces"
work=$PWD/build/e2e/init
rm -rf "$work"
mkdir -p "$work"
root=$work/initramfs data=$root/dev/vda6
applets=$(sed -n 's/^for name in \(sh mount .*\); do$/\1/p' image/assemble.sh) # no others are in the initramfs
wrong=0

# What stands for the programs. /faults/NAME says how many of the next calls of NAME fail ("ever": all of them).
cat >"$work/programs" <<'P'
fails() {
	local left
	left=$(cat "/faults/$1" 2>/dev/null) || return
	[ "$left" != ever ] || return 0
	echo $((left - 1)) >"/faults/$1"
	[ "$left" -gt 0 ]
}
modprobe() { :; }
dmsetup() { :; }
umount() { [ "$*" != "/proc /sys" ] || : >/started; }
sleep() {
	echo "$1" >>/slept
	fails tpm || ln -sf tpm /dev/tpmrm0
}
reboot() {
	: >/restarted
	exit
}
mount() {
	local to
	for to; do :; done
	case "$*" in
	*ext4*) ! fails mount && grep -q "^ext4" "$5" || return ;;
	*vfat*) ! fails esp || return ;;
	esac
	[ "$to" != /root/var ] || echo "$2" >/var
	[ "$to" != /root/efi ] || : >/efi
}
dd() {
	case "$*" in
	"if=/dev/"*direct*) ! fails read && command dd "$1" "$2" bs=4k count=1 ;; # no file system here need know O_DIRECT
	*"of=/dev/"*) ! fails write && echo "$2" >>/written && command dd "$1" "$2" bs=4k conv=notrunc ;;
	*) command dd "$@" ;;
	esac
}
# In the root of the slot.
chroot() {
	shift 4
	case "$*" in
	e2fsck*) ! fails e2fsck || return 8; grep -q "^ext4" "$3" || return 4 ;;
	mke2fs*) ! fails mke2fs && for to; do :; done && echo "ext4, created anew" >"$to" ;;
	"cryptsetup isLuks"*) ! fails header && grep -q ^LUKS "$4" ;;
	"cryptsetup luksDump"*) ! fails header && grep -q ^LUKS "$3" && echo "cipher: aes-xts-plain64" ;;
	*--test-passphrase*) ! fails seal ;;
	"cryptsetup open"*) ! fails unlock && ! grep -q "another's" /dev/vda6 && sed 's/^LUKS, //' /dev/vda6 >/dev/mapper/gopura-data ;;
	systemd-cryptenroll*) ! fails seal ;;
	blkdiscard*) : >/dev/vda6 ;;
	dd*) echo "LUKS, created anew" >/dev/vda6 ;;
	esac
}
P

# starts CONTENT [NAME=FAULTS]...: a start of a terminal whose data partition holds CONTENT, with these faults
starts() {
	local content=$1 fault number=0 name
	shift
	rm -rf "$root"
	mkdir -p "$root"/{bin,dev/mapper,dev/gopura,proc/sys/kernel/random,sys/class/block,faults} \
		"$root"/root/{etc,run,var,efi,dev,proc,sys,lib/systemd}
	cp "$busybox" "$root/bin/busybox"
	for name in $applets; do ln -s busybox "$root/bin/$name"; done
	for name in esp boot-a boot-b root-a root-b data; do
		number=$((number + 1))
		mkdir -p "$root/sys/devices/vda/vda$number"
		printf 'DEVNAME=vda%s\nPARTNAME=gopura-%s\n' $number $name >"$root/sys/devices/vda/vda$number/uevent"
		ln -s "../../devices/vda/vda$number" "$root/sys/class/block/"
	done
	ln -s ../../devices/vda "$root/sys/class/block/vda"
	echo "rauc.slot=A" >"$root/proc/cmdline"
	echo "1.0 1.0" >"$root/proc/uptime"
	echo "11111111-0000-4000-8000-000000000001" >"$root/proc/sys/kernel/random/uuid"
	: >"$root/verity"
	: >"$root/root/etc/group"
	install -m 755 /dev/null "$root/root/lib/systemd/systemd"
	: >"$root/dev/null"
	: >"$root/dev/random"
	: >"$root/dev/tpm"
	{ echo "$content"; head -c 8192 /dev/zero; } | tee "$root/before" >"$data"
	for fault; do
		case $fault in
		tpm=there) ln -s tpm "$root/dev/tpmrm0" ;;
		encrypt) : >"$root/encrypt-data" ;;
		no-systemd) rm "$root/root/lib/systemd/systemd" ;;
		*) echo "${fault#*=}" >"$root/faults/${fault%%=*}" ;;
		esac
	done
	{ cat "$work/programs"; sed 's|>/dev/kmsg|>>/said|' image/init; } >"$root/init"
	# shellcheck disable=SC2016
	timeout 60 "${in_folder[@]}" sh -c 'mount --bind /dev/null "$1/dev/null" && mount --bind /dev/null "$1/dev/tpm" &&
		exec chroot "$1" /bin/busybox sh /init' sh "$root" >"$work/log" 2>&1 || true # nobody can switch to the root
}
# ends CLAIM WORD...: how the start ended: "started", else "restarted"; the partition is "kept", or created "anew" or "encrypted"; /var is
# of "disk" or "memory"
ends() {
	local claim=$1 content is
	shift
	content=$(head -c 64 "$data" | head -n 1 | tr -d '\0')
	is=$([ ! -e "$root/started" ] || echo started)$([ ! -e "$root/restarted" ] || echo restarted)
	case $content in
	LUKS*anew*) is+=" encrypted" ;;
	*anew*) is+=" anew" ;;
	*) cmp -s "$root/before" "$data" && is+=" kept" || is+=" changed" ;;
	esac
	! grep -aqs anew "$root/dev/mapper/gopura-data" || [ "${is##* }" = encrypted ] || is+=" lost"
	case $(cat "$root/var" 2>/dev/null) in tmpfs) is+=" memory" ;; ext4) is+=" disk" ;; esac
	[ "$is" != "$*" ] || return 0
	echo "$claim: $is, not $*:"
	cat "$root/said" "$work/log" 2>/dev/null | tail -n 20 | sed 's/^/	/'
	wrong=1
}
# says TEXT, reports NAME TEXT: what is in the kernel's log, what the health page is told
says() { grep -qF "$1" "$root/said" || { echo "nobody is told: $1"; wrong=1; }; }
reports() { grep -qF "$2" "$root/root/run/gopura-data-$1" || { echo "the health page does not know that $2"; wrong=1; }; }
quick() { [ ! -e "$root/slept" ] || { echo "a terminal without faults waits"; wrong=1; }; }

# ---- a plain partition
starts "ext4, ours"; ends "without faults" started kept disk; quick
starts "ext4, ours" read=1; ends "one read that fails" started kept disk
starts "ext4, ours" mount=1; ends "one mount that fails" started kept disk
starts "ext4, ours" e2fsck=6 mount=3; ends "three failures of everything" started kept disk
starts "ext4, ours" write=4; ends "four writes that fail" started kept disk
starts "ext4, ours" write=ever; ends "a card that can only be read" started kept memory
says "nothing is stored: /dev/vda6 cannot be read or written."
reports lost "/dev/vda6 cannot be read or written."
starts "ext4, ours" write=ever e2fsck=ever mount=ever; ends "such a card whose journal is to be replayed" started kept memory
starts "ext4, ours" read=ever e2fsck=ever mount=ever; ends "a partition that cannot be read" started kept memory
starts "damaged"; ends "a file system beyond repair" started anew disk
says "is beyond repair and is created anew"
starts "damaged" mke2fs=ever; ends "one that cannot be made either" started kept memory
starts "LUKS, another's"; ends "an encrypted one of a system before" started anew disk; quick

# ---- an encrypted one
starts "LUKS, ext4, ours" encrypt tpm=there; ends "with its TPM" started kept disk; quick
starts "LUKS, ext4, ours" encrypt tpm=there unlock=3; ends "a TPM that refuses three times" started kept disk
starts "LUKS, ext4, ours" encrypt tpm=there header=1; ends "a header that cannot be read once" started kept disk
starts "LUKS, ext4, ours" encrypt tpm=2; ends "a TPM that comes late" started kept disk
starts "LUKS, ext4, ours" encrypt tpm=there mount=2; ends "a mount that fails in it" started kept disk
starts "LUKS, ext4, ours" encrypt tpm=there unlock=ever seal=ever; ends "a TPM that fails the whole start" started kept memory
reports lost "/dev/vda6 cannot be unlocked. The computer's TPM does not"
starts "LUKS, ext4, ours" encrypt tpm=ever; ends "no TPM" started kept memory
reports lost "/dev/vda6 cannot be unlocked. The computer has no TPM"
starts "LUKS, ext4, ours" encrypt tpm=there unlock=ever write=ever; ends "a disk that cannot be written, and no key" started kept memory
reports lost "cannot be read or written"
starts "LUKS, another's" encrypt tpm=there; ends "the key of another TPM" started encrypted disk
starts "ext4, ours" encrypt tpm=there; ends "a plain one that is to be encrypted" started encrypted disk
starts "ext4, ours" encrypt tpm=ever; ends "a plain one without a TPM" started kept disk
reports plain "The computer has no TPM"

# ---- the loader's partition, and why a terminal restarts
starts "ext4, ours" esp=3; ends "the loader's partition cannot be mounted three times" started kept disk
[ -e "$root/efi" ] || { echo "the terminal starts without its settings"; wrong=1; }
starts "ext4, ours" esp=ever; ends "the loader's partition cannot be mounted" restarted kept disk
says "<0>gopura: /dev/vda1 cannot be mounted; restarting in 10 s" # of this priority, or the panel stays dark
starts "ext4, ours" no-systemd; ends "a root without a system" restarted kept disk
says "<0>gopura: the root has no systemd; restarting in 10 s"
[ "$wrong" = 0 ] || fail "image/init"
echo "one failure costs no data, and a disk that cannot be written no picture"
