#!/bin/bash
# Which slot the loader starts: image/grub.cfg, whose language bash understands, with GRUB's commands simulated.
# (tests/qemu/loader.sh starts the real loader.)
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
export work=$PWD/build/e2e/slots
rm -rf "$work"
mkdir -p "$work"
{
	cat <<'END'
unreadable=$1
variables='ORDER A_OK B_OK A_TRY B_TRY' cmdpath='(hd0,gpt1)/EFI/BOOT'
set() { for assignment; do declare -g "$assignment"; done; }
regexp() {
	local pattern=$3
	[ "$pattern" = '^(.*),.*$' ] || pattern='^[(]([^)]*)[)]'
	[[ $4 =~ $pattern ]] && declare -g "${2#1:}=${BASH_REMATCH[1]}"
}
load_env() { . "$work/environment"; }
save_env() { for name in $variables; do echo "$name='${!name}'"; done >"$work/environment"; }
probe() { identity=guid-of-$3; }
linux() {
	case " $unreadable " in *" $slot "*) return 1 ;; esac
	loaded="$1 $2 $3"
}
initrd() { [ "$1" = "${loaded%%/*}/initrd" ]; }
boot() { echo "$loaded"; exit; }
sleep() { :; }
reboot() { echo reboot; exit; }
END
	sed 's/(\$\([a-z]*\))/$\1/g' image/grub.cfg # devices
} >"$work/loader"
grep -q '@KERNEL@' "$work/loader" || fail "it is not the loader"

environment() { printf '%s\n' "ORDER='$1'" "A_OK=$2 A_TRY=$3 B_OK=$4 B_TRY=$5" >"$work/environment"; }
# starts EXPECTED UNREADABLE: a start, with these slots' boot files unreadable; environment_is: what it leaves
starts() {
	local is
	is=$(bash "$work/loader" "$2")
	case $is in *" rauc.slot=$1 "* | "$1") ;; *) fail "'$is' is started, not $1" ;; esac
}
environment_is() {
	local is
	is=$(. "$work/environment"; echo "$ORDER $A_OK $A_TRY $B_OK $B_TRY")
	[ "$is" = "$1" ] || fail "the environment is $is, not $1"
}

# ---- in its order, three starts each
environment "A B" 1 0 0 0
starts A ""
environment_is "A B 1 1 0 0"
[ "$(bash "$work/loader" "")" = "hd0,gpt2/vmlinuz rauc.slot=A gopura.root=guid-of-hd0,gpt4" ] || fail "A is started from elsewhere"
environment "B A" 1 0 1 2
starts B ""
environment_is "B A 1 0 1 3"
[ "$(bash "$work/loader" B)" = "hd0,gpt2/vmlinuz rauc.slot=A gopura.root=guid-of-hd0,gpt4" ] || fail "A is started from elsewhere"
environment_is "B A 1 1 1 3"
environment "B A" 1 3 1 3
starts B ""
environment_is "B A 1 0 1 1"
environment "A B" 0 0 0 0
starts A ""
environment_is "A B 0 3 0 0"

# ---- boot files that cannot be read: the other slot shows pictures in the same start, if it works
environment "B A" 1 0 1 0
starts A B
environment_is "B A 1 1 1 1"
starts A B
starts A B
environment_is "B A 1 3 1 3"
environment "A B" 1 0 1 3
starts B A
environment_is "A B 1 1 1 3"
environment "A B" 1 0 0 0
starts reboot A
environment_is "A B 1 1 0 0"
environment "A B" 1 0 1 0
starts reboot "A B"
environment_is "A B 1 1 1 1"
echo "slots: in their order, three starts each, and the other one where boot files cannot be read"
