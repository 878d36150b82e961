#!/bin/bash
# Which sticks are accepted, and that each of two keeps its own mount: the appliance's own script, with udev and the
# service manager simulated. (tests/qemu/image.sh updates tests the whole in a virtual machine, with hostile file
# systems.)
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v flock >/dev/null || skip "flock is not installed"
work=$PWD/build/e2e/sticks
rm -rf "$work"
mkdir -p "$work/bin"
cp image/root/usr/lib/gopura/gopura-stick "$work/gopura-stick"

# udev knows sda, sdb: FAT; sdc: exFAT; sde: ext4; sdf: nothing.
cat >"$work/bin/udevadm" <<'END'
#!/bin/sh
for device; do :; done
case $device in */sd[ab]) echo vfat ;; */sdc) echo exfat ;; */sde) echo ext4 ;; esac
END
# One mount unit of the name at a time, as with the real one.
cat >"$work/bin/systemd-mount" <<END
#!/bin/sh
echo "\$@" >>"$work/mounts"
set -C
for device; do case \$device in /dev/*) echo "\$device" >"$work/mounted" || exit 1 ;; esac; done
END
cat >"$work/bin/systemctl" <<END
#!/bin/sh
echo "\$@" >>"$work/asked"
case \$1 in stop) rm "$work/mounted" ;; esac
END
chmod +x "$work"/bin/*
: >"$work/mounts"
: >"$work/asked"

# hold NAME: as gopura-stick@NAME.service does; sets its process id in $NAME
hold() {
	PATH=$work/bin:$PATH "$work/gopura-stick" "$1" >"$work/$1.log" 2>&1 &
	declare -g "$1=$!"
}
# let_go NAME: the device is gone; the script gets its signal first, then the processes it waits with are killed
# (KillMode=mixed)
let_go() {
	local waits
	waits=$(pgrep -P "${!1}" || true)
	kill "${!1}"
	wait "${!1}" 2>/dev/null || true
	# shellcheck disable=SC2086
	[ -z "$waits" ] || kill -9 $waits 2>/dev/null || true
}
trap 'for name in sda sdb sdc; do [ -z "${!name:-}" ] || let_go $name; done 2>/dev/null' EXIT
mounted() { [ "$(cat "$work/mounted" 2>/dev/null)" = "/dev/$1" ]; }
waits() { grep -q "$1 waits: another stick, or part of one, is in use; pull that one out" "$work/$1.log"; }
tells() { grep -qx -- "--no-block start gopura-conf.service gopura-bundle.service" "$work/asked"; }

# ---- other file systems: the mount command is never asked
for name in sde sdf; do
	! PATH=$work/bin:$PATH timeout 20 "$work/gopura-stick" $name >"$work/$name.log" 2>&1 || fail "$name was taken"
	grep -q "format the stick as FAT32 or exFAT" "$work/$name.log" || fail "no cure: $(cat "$work/$name.log")"
done
[ ! -s "$work/mounts" ] || fail "mounted: $(cat "$work/mounts")"
rule=$(grep gopura-stick@ image/root/etc/udev/rules.d/90-gopura.rules)
case $rule in *'ENV{ID_FS_TYPE}=="vfat|exfat"'*) ;; *) fail "udev's rule takes other file systems: $rule" ;; esac
case $rule in *'ENV{ID_PART_ENTRY_TYPE}!="c12a7328-f81f-11d2-ba4b-00a0c93ec93b|0xef"'*) ;; *) fail "a Mac's hidden partition is taken for the stick: $rule" ;; esac

# ---- one stick, by its kind and with every restriction
hold sda
wait_for 20 "mount of sda" mounted sda
wait_for 20 "start of who waits for sticks" tells
grep -q -- '--type=vfat' "$work/mounts" || fail "the kind is not given: $(cat "$work/mounts")"
for option in ro nosymfollow nodev noexec nosuid; do
	grep -qE -- "--options=([^ ]*,)?$option(,| )" "$work/mounts" || fail "no $option: $(cat "$work/mounts")"
done

# ---- a second one waits; gone again, it takes nothing along
hold sdb
wait_for 20 "word that sdb waits" waits sdb
let_go sdb
mounted sda && ! grep -q stop "$work/asked" || fail "the stick that waited ended the mount of the other"
# ---- and is taken when the first goes
hold sdc
wait_for 20 "word that sdc waits" waits sdc
let_go sda
wait_for 20 "mount of sdc" mounted sdc
grep -q -- '--type=exfat' "$work/mounts" || fail "exFAT has another kind: $(cat "$work/mounts")"
let_go sdc
[ ! -e "$work/mounted" ] || fail "sdc is still mounted"
# ---- plugged in again
hold sda
wait_for 20 "mount of sda, again" mounted sda
let_go sda
trap - EXIT
echo "sticks: FAT and exFAT only, one at a time, each its own mount"
