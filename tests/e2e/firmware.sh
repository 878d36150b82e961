#!/bin/bash
# Updates from a stick: the appliance's own scripts, with RAUC, loader and service manager simulated. A version below
# the floor is refused, whatever a hostile stick shows first; a version that was found good raises the floor, and
# nothing lowers it. (tests/qemu/image.sh updates tests the whole in a virtual machine.)
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v grub-editenv >/dev/null || skip "grub-editenv is not installed"
work=$PWD/build/e2e/firmware
rm -rf "$work"
root=$work/root stick=$work/root/run/gopura-stick state=$work/root/var/lib/gopura-firmware
mkdir -p "$work/bin" "$stick" "$state" "$root"/{run/gopura-bundle,run/gopura-kiosk,var/lib/rauc,efi/gopura,etc/rauc,proc,usr/lib/gopura}
environment=$root/efi/gopura/grubenv
: >"$root/etc/rauc/system.conf"
echo "1000.0 1000.0" >"$root/proc/uptime"
# The scripts as they are, but for the root of their paths.
for script in floor.sh gopura-bundle gopura-firmware gopura-good gopura-self-test; do
	sed -E "s#/(run|var|efi|etc|proc|usr/lib/gopura)/#$root/\1/#g" "image/root/usr/lib/gopura/$script" >"$root/usr/lib/gopura/$script"
done
# GRUB's own tool, behind ours.
ln -s "$(command -v grub-editenv)" "$root/usr/lib/gopura/grub-editenv"
sed "s#/usr/lib/gopura/#$root&#" image/root/usr/bin/grub-editenv >"$root/grub-editenv"
loader() { sh "$root/grub-editenv" "$environment" "$@"; }
loader create
loader set "ORDER=A B" A_OK=1 A_TRY=1 B_OK=0 B_TRY=0
# loader_has VARIABLE=VALUE...: all of them
loader_has() {
	local variable
	for variable; do loader list | grep -qx -- "$variable" || return; done
}

# A bundle is one line here: what the first read returns (version, sequence), and what the second returns.
cat >"$work/bin/rauc" <<END
#!/bin/sh
case \$1 in
info)
	read -r version build then then_build <"\$3"
	[ "\$version" != forged ] || { echo "signature verification failed"; exit 1; }
	printf "RAUC_MF_COMPATIBLE='gopura-x86-64'\nRAUC_MF_VERSION='%s'\nRAUC_MF_BUILD='%s'\n" "\$version" "\$build"
	;;
install)
	read -r version build then then_build <"\$2"
	echo "install \$2" >>"$work/asked"
	[ "\$version" != torn ] || exit 1
	slot=\$(sed -n 's/.*=//p' "$root/proc/cmdline" | tr AB 10)
	printf '[slot.rootfs.%s]\nbundle.version=%s\nbundle.build=%s\n[slot.boot.%s]\nbundle.build=999\n' \
		"\$slot" "\${then:-\$version}" "\${then_build:-\$build}" "\$slot" >"$root/var/lib/rauc/status"
	;;
status)
	echo "\$2 \$3" >>"$work/asked"
	other=\$(sed -n 's/.*=//p' "$root/proc/cmdline" | tr AB BA)
	sh "$root/grub-editenv" "$environment" set "ORDER=\$other \$(echo "\$other" | tr AB BA)" "\${other}_OK=1" "\${other}_TRY=0"
	;;
esac
END
cat >"$work/bin/systemctl" <<END
#!/bin/sh
case \$1 in
show) echo 0 ;;
is-active) [ "\$3" != gopura-good.service ] || [ ! -e "$work/on-trial" ] ;;
is-failed) exit 1 ;;
*) echo "\$@" >>"$work/asked" ;;
esac
END
# A disk that cannot be read for so many tries, or not be written.
cat >"$work/bin/grub-editenv" <<END
#!/bin/sh
case \$2 in
list) tries=\$(cat "$work/unreadable" 2>/dev/null) && [ "\$tries" -gt 0 ] && echo \$((tries - 1)) >"$work/unreadable" && exit 1 ;;
set) [ ! -e "$work/unwritable" ] || exit 1 ;;
esac
exec sh "$root/grub-editenv" "\$@"
END
printf '#!/bin/sh\n' >"$work/bin/mount"
# Meanwhile a system on trial is found good.
printf '#!/bin/sh\n[ ! -e "%s" ] || { rm "%s"; echo waited >>"%s"; }\n' "$work/on-trial" "$work/on-trial" "$work/asked" >"$work/bin/sleep"
printf '#!/bin/sh\n' >"$work/bin/gopura-kiosk"
chmod +x "$work"/bin/*

# runs SLOT VERSION SEQUENCE: what the terminal runs
runs() {
	echo "quiet rauc.slot=$1" >"$root/proc/cmdline"
	printf 'IMAGE_VERSION=%s\nIMAGE_SEQUENCE=%s\n' "$2" "$3" >"$root/etc/os-release"
}
script() { PATH=$work/bin:$PATH timeout 20 sh "$root/usr/lib/gopura/$1"; }
found_good() { script gopura-good >"$work/said" || fail "gopura-good: $(cat "$work/said")"; }
# plugged [NAME=]LINE...: a stick with these bundles, as gopura-bundle.service and gopura-firmware.service treat it
plugged() {
	rm -f "$stick"/* "$work/asked"
	: >"$work/asked"
	local n=0 bundle
	for bundle; do
		n=$((n + 1))
		case $bundle in *=*) echo "${bundle#*=}" >"$stick/${bundle%%=*}.raucb" ;; *) echo "$bundle" >"$stick/bundle$n.raucb" ;; esac
	done
	script gopura-bundle >"$work/said" || fail "gopura-bundle: $(cat "$work/said")"
	[ ! -s "$work/asked" ] || fail "who reads the stick gives orders: $(cat "$work/asked")"
	[ ! -e "$root/run/gopura-bundle/chosen" ] || script gopura-firmware >>"$work/said" || fail "gopura-firmware: $(cat "$work/said")"
}
said() { grep -q -- "$1" "$work/said"; }
asked() { grep -qx -- "$1" "$work/asked"; }
nothing_asked() { [ ! -s "$work/asked" ] || fail "$1: $(cat "$work/asked")"; }

# ---- a terminal on which nothing was found good yet: what runs is the floor
runs A v100 100
# gopura-good, root without privileges, must be able to read the answer of the kiosk's user.
(umask 077 && CARD=/dev/null script gopura-self-test)
[ "$(stat -c %a "$root/run/gopura-kiosk/self-test")" = 644 ] || fail "gopura-good cannot read the self-test's answer"
plugged "v90 90"
nothing_asked "an older system was installed before the first was found good"
found_good
[ "$(cat "$state/floor")" = "100 v100" ] || fail "the floor is $(cat "$state/floor")"
# What is noted already is not written again: the power may be cut meanwhile.
[ "$(cat "$state/good-A")" = v100 ] || fail "good is not noted"
touch -d 2001-01-01 "$state/good-A"
found_good
[ "$(stat -c %Y "$state/good-A")" = "$(date -d 2001-01-01 +%s)" ] || fail "what was good is written at each start"

# ---- newer: installed, made active, two starts, restart
plugged "v120 120"
asked "install $stick/bundle1.raucb" && asked "mark-active other" && asked "--no-block reboot" && loader_has "ORDER=B A" B_OK=1 B_TRY=1 ||
	fail "a newer system is not installed: $(cat "$work/said" "$work/asked")"
[ "$(cat "$state/floor")" = "100 v100" ] || fail "the floor rose before anything was found good"
plugged "v120 120"
nothing_asked "what was tried and went back was tried again"
said 'v120 was tried before' || fail "nobody is told: $(cat "$work/said")"

# ---- found good: the floor rises, and an older signed bundle is refused, with both versions and a cure
runs B v120 120
found_good
[ "$(cat "$state/floor")" = "120 v120" ] || fail "the floor is $(cat "$state/floor")"
plugged "old=v110 110"
nothing_asked "an older system was installed"
said 'old.raucb is refused: v110 (sequence 110) is older than v120 (sequence 120).*SEQUENCE=' || fail "said: $(cat "$work/said")"
plugged "without="v7
nothing_asked "a bundle of before there were sequences was installed"
said 'v7 (sequence 0)' || fail "said: $(cat "$work/said")"
plugged "v120 120" "twin 120"
nothing_asked "what has the sequence of what runs was installed"
# Of several the newest, whatever they are called; while it is on trial, an older one that is not below the floor waits.
plugged "a-1.10=v120.122 122" "b-1.11=v120.124 124" "c-1.9=v120.121 121"
[ "$(grep install "$work/asked")" = "install $stick/b-1.11.raucb" ] || fail "not the newest: $(cat "$work/asked")"
runs A v120.124 124
rm -f "$state/good-A"
plugged "a-1.10=v120.122 122" "b-1.11=v120.124 124" "c-1.9=v120.121 121"
nothing_asked "an older system took the place of a system on trial"
said 'v120.122 (sequence 122) is not newer than the running system, v120.124 (124)' || fail "said: $(cat "$work/said")"
runs B v120 120
plugged "v120.125 125"
asked "install $stick/bundle1.raucb" && asked "mark-active other" || fail "a rebuild of what runs is not installed: $(cat "$work/said")"
plugged "v999 99999999999999999999999"
nothing_asked "a sequence that no shell can count was taken"
plugged "forged 130"
nothing_asked "a bundle with a wrong signature was installed"
said 'bundle1.raucb is refused: signature verification failed' || fail "said: $(cat "$work/said")"

# ---- while a system is on trial, the one that it could go back to is not overwritten
rm -f "$state/good-B"
: >"$work/on-trial"
plugged "v120.126 126"
[ "$(head -n 2 "$work/asked" | xargs)" = "waited install $stick/bundle1.raucb" ] || fail "the last good slot: $(cat "$work/asked")"
found_good

# ---- a stick that shows a newer manifest at the first reading, and an older system at the second
plugged "v130 130 v110 110"
asked "install $stick/bundle1.raucb" || fail "the test tests nothing: $(cat "$work/said")"
! asked "mark-active other" && ! asked "--no-block reboot" || fail "an older system is started: $(cat "$work/asked")"
said 'it holds v110 (sequence 110), which is older than v120' || fail "said: $(cat "$work/said")"
asked "stop rauc.service" || fail "the loader's partition stays open for writing"

# ---- one bundle that cannot be installed does not keep the next from it; strange names are left alone
plugged "a=torn 140" "b (1)=v140 140" "c;d=v150 150"
asked "install $stick/b (1).raucb" && asked "mark-active other" || fail "the second bundle is not installed: $(cat "$work/said")"
! grep -q ';' "$work/asked" && said 'a bundle is ignored: rename it' || fail "a strange name: $(cat "$work/said" "$work/asked")"

# ---- the loader went back to the older slot: it runs, is good, and lowers nothing
runs A v100 100
found_good
loader_has A_OK=1 A_TRY=0 || fail "an older slot that the loader went back to is not good any more"
[ "$(cat "$state/floor")" = "120 v120" ] || fail "the older slot lowered the floor to $(cat "$state/floor")"
plugged "v110 110"
nothing_asked "the older slot took an older system"
# To go back on purpose: the older code with a higher sequence.
plugged "v160 160"
asked "mark-active other" || fail "there is no way back: $(cat "$work/said")"

# ---- a system that failed does not come first again, also when power cuts use up the starts of the one that works
loader set "ORDER=B A" B_OK=1 B_TRY=3 A_TRY=2
found_good
loader_has "ORDER=A B" A_OK=1 A_TRY=0 B_TRY=3 || fail "what failed comes first: $(loader list)"
# A system that waits for its start keeps it.
loader set "ORDER=B A" B_TRY=1
found_good
loader_has "ORDER=B A" B_TRY=1 || fail "an update that waits is put back: $(loader list)"

# ---- the newest system was good for years, and power cuts used up its starts: it gets them back, once
plugged "v170 170"
grep -qx v170 "$state/tried" || fail "the test tests nothing: $(cat "$work/said")"
runs B v170 170
found_good
! grep -qx v170 "$state/tried" && grep -qx v160 "$state/tried" || fail "tried, and not found good: $(cat "$state/tried")"
loader set "ORDER=B A" B_OK=1 B_TRY=3
runs A v100 100
found_good
loader_has "ORDER=B A" B_OK=1 B_TRY=0 || fail "the newest system is left for good: $(loader list)"
loader set B_TRY=3
found_good
loader_has "ORDER=A B" B_TRY=3 || fail "a system that no longer works is tried again and again: $(loader list)"
runs B v170 170
found_good
loader set "ORDER=B A" B_TRY=3
runs A v100 100
found_good
loader_has "ORDER=B A" B_TRY=0 || fail "a system that was good again does not get its starts back: $(loader list)"
# Its bundle may repair the slot, and is then tried once.
plugged "v170 170"
asked "mark-active other" || fail "the bundle of the newest system is refused: $(cat "$work/said")"
plugged "v170 170"
nothing_asked "a system that failed is installed again and again"
# Another system has overwritten the newest one.
runs B v170 170
found_good
runs A v100 100
plugged "v180 180"
loader_has B_TRY=1 || fail "the test tests nothing: $(cat "$work/said")"
loader set B_TRY=3
found_good
loader_has "ORDER=A B" B_TRY=3 || fail "what overwrote a good system counts as good: $(loader list)"

# ---- an environment that cannot be read or written for a moment is not damaged, and nothing is said that is not so
loader set B_TRY=0
echo 2 >"$work/unreadable"
runs A v190 190
found_good
loader_has B_OK=1 A_TRY=0 || fail "an environment that could not be read at once is created anew: $(loader list)"
[ "$(cat "$state/floor")" = "190 v190" ] || fail "the floor is $(cat "$state/floor")"
runs A v200 200
for what in unreadable unwritable; do
	echo 9 >"$work/$what"
	! script gopura-good >"$work/said" || fail "$what: $(cat "$work/said")"
	said 'could not be marked as good' && ! said 'is good' || fail "$what: $(cat "$work/said")"
	[ "$(cat "$state/floor")" = "190 v190" ] || fail "$what: a slot that is not marked raised the floor to $(cat "$state/floor")"
	rm "$work/$what"
	loader_has B_OK=1 || fail "$what: the other slot is lost: $(loader list)"
done
# A new system that shows nothing goes back to the other slot, also where the environment cannot be read at once.
rm "$state/good-A"
echo 1 >"$root/run/gopura-kiosk/self-test"
for tries in 2 9; do
	echo $tries >"$work/unreadable"
	: >"$work/asked"
	! script gopura-good >"$work/said" && asked "--no-block reboot" || fail "it stays with a system that does not work: $(cat "$work/said")"
done
rm "$work/unreadable"
loader set B_OK=0
: >"$work/asked"
! script gopura-good >"$work/said" || fail "a self-test that failed: $(cat "$work/said")"
nothing_asked "it goes back to a slot that does not work"
# Faults of gopura.conf, which may be on a stick that comes later, and a root that has expired do not keep an update out.
echo 3 >"$root/run/gopura-kiosk/self-test"
found_good
said 'is good' || fail "a fault of gopura.conf: $(cat "$work/said")"
echo 0 >"$root/run/gopura-kiosk/self-test"
# A damaged one is replaced by one that is whole.
runs B v200 200
for damage in "head -c 1024 /dev/zero" "echo" "true"; do
	loader set B_OK=0
	$damage >"$environment"
	found_good
	loader_has "ORDER=B A" B_OK=1 B_TRY=0 A_OK=0 A_TRY=0 && [ "$(stat -c %s "$environment")" = 1024 ] || fail "after $damage: $(loader list)"
done
rm "$environment"
found_good
loader_has "ORDER=B A" B_OK=1 || fail "a missing environment stays away: $(loader list)"

# ---- a floor that cannot be read or written
[ "$(cat "$state/floor")" = "200 v200" ] || fail "the floor is $(cat "$state/floor")"
ln -s /dev/full "$state/floor.new"
runs B v210 210
found_good
[ "$(head -c 64 "$state/floor" | tr -d '\0')" = "200 v200" ] && said 'the version floor could not be raised' || fail "a full disk lost the floor: $(cat "$work/said")"
rm "$state/floor.new"
mv "$state/floor" "$work/floor"
mkdir "$state/floor" # cannot be read as a file
runs B v100 100
found_good
[ ! -e "$state/floor/floor.new" ] || fail "a floor that cannot be read was taken for none"
printf '%s\n' "v150 150" >"$stick/bundle1.raucb"
! script gopura-bundle >"$work/said" && [ ! -e "$root/run/gopura-bundle/chosen" ] || fail "a bundle is chosen without a floor: $(cat "$work/said")"
echo bundle1.raucb >"$root/run/gopura-bundle/chosen"
: >"$work/asked"
! script gopura-firmware >"$work/said" || fail "a bundle is installed without a floor: $(cat "$work/said")"
nothing_asked "a bundle is installed without a floor"
rmdir "$state/floor"
mv "$work/floor" "$state/floor"

# ---- memory in the place of the data partition: no restart, which could go on for ever, because of what is missing there
rm "$state"/good-?
echo 1 >"$root/run/gopura-kiosk/self-test"
: >"$root/run/gopura-data-lost"
found_good
rm "$root/run/gopura-data-lost" "$root/run/gopura-kiosk/self-test"

# ---- damaged notes
echo "12x" >"$state/floor"
plugged "v90 90"
nothing_asked "a damaged floor let an older system in"
found_good
[ "$(cat "$state/floor")" = "100 v100" ] || fail "a damaged floor stays: $(cat "$state/floor")"
echo "updates: newer ones only, by what was installed and not by what was shown"
