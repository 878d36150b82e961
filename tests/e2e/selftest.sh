#!/bin/bash
# The self-test: it passes if everything is in order; each fault is found, with a remedy, and no other fault is
# reported.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/selftest shim=$PWD/build/tests/tools
rm -rf "$work"
mkdir -p "$work"
small_release
trust=$small/release/root/1.json

# tests NAME FAILS COMMAND...: exit status and the names of the checks that fail ("" none).
tests() {
	local name=$1 fails=$2 status=0
	shift 2
	"$@" >"$work/$name.txt" 2>"$work/$name.log" || status=$?
	[ "$(sed -n 's/^fail  *\([a-z]*\) .*/\1/p' "$work/$name.txt" | sort -u | xargs)" = "$fails" ] ||
		{ cat "$work/$name.txt" "$work/$name.log"; fail "$name: not what fails: '$fails'"; }
	case $fails in '') expected=0 ;; settings | trust | 'settings trust') expected=3 ;; *) expected=1 ;; esac
	[ "$status" = $expected ] || fail "$name: ended with status $status, not $expected"
	[ "$(wc -l <"$work/$name.txt")" = 6 ] || { cat "$work/$name.txt"; fail "$name: not six lines"; }
}
says() { grep -q "$2" "$work/$1.txt" || { cat "$work/$1.txt"; fail "$1 does not say '$2'"; }; }
kiosk=(build/gopura-kiosk --self-test --display headless --size 640x360)
test=("${kiosk[@]}" --state "$work/state" --trust "$trust")

tests well '' "${test[@]}"
says well 'none was ever connected'

# ---- settings
printf '[panel]\nrotation = 45\n' >"$work/bad.ini"
tests profile settings "${test[@]}" --board "$work/bad.ini"
printf '[release]\nurl = carrier pigeon\n' >"$work/gopura.conf"
tests conf settings "${test[@]}" --conf "$work/gopura.conf"
tests noconf settings "${test[@]}" --conf "$work/nowhere.conf"
tests both 'settings trust' "${kiosk[@]}" --state "$work/state" --conf "$work/nowhere.conf"

# ---- storage
: >"$work/file"
tests folder storage "${kiosk[@]}" --trust "$trust" --state "$work/file/state"
tests room storage env SICK=room LD_PRELOAD="$shim/sick.so" "${test[@]}"
says room '1 MiB free'
tests sync storage env SICK=sync LD_PRELOAD="$shim/sick.so" "${test[@]}"
says sync 'Input/output error'
tests confroom 'settings storage' env SICK=room LD_PRELOAD="$shim/sick.so" "${test[@]}" --conf "$work/gopura.conf"

# ---- trust
tests untrusted trust "${kiosk[@]}" --state "$work/state"
says untrusted 'with --trust once'
sed 's/"payload": *"..../&AAAA/' "$trust" >"$work/forged.json"
! cmp -s "$trust" "$work/forged.json" || fail "nothing is forged"
tests forged trust "${kiosk[@]}" --state "$work/state" --trust "$work/forged.json"
tests notrust trust "${kiosk[@]}" --state "$work/state" --trust "$work/nowhere.json"
printf '1 0 0 2 2 2 45\n' >"$work/views.txt"
build/gopura-kiosk --display headless --size 64x64 --release "$small/release" --trust "$trust" --state "$work/state" \
	--views "$work/views.txt" --capture "$work/views" 2>"$work/kiosk.log" || fail "the kiosk does not run"
tests remembered '' "${kiosk[@]}" --state "$work/state"
says remembered 'the stored trust root, version 1'

# ---- panel and GPU
tests nopanel 'gpu panel' "${kiosk[@]}" --state "$work/state" --display drm --device /dev/dri/nothing
tests units gpu env SICK=units LD_PRELOAD="$shim/sick.so" "${test[@]}"
says units '4 texture units, the kiosk needs 8'
: >"$work/lost"
tests lost 'gpu panel' env LOST_GL="$work/lost" LOST_GL_BY=error LD_PRELOAD="$shim/lost_gl.so" "${test[@]}"

# ---- touch: a screen that was there once
command -v umockdev-run >/dev/null || skip "umockdev-run is not installed: the touchscreen is not tested"
data=tests/input/data
plugged() { umockdev-run -d $data/panel.umockdev -i "/dev/input/event5=$1" -- "${@:2}"; }
tests touch '' plugged $data/panel.ioctl "${test[@]}"
says touch 'Gopura test panel: 0..4095 x 0..4095, 5 fingers'
tests unplugged touch "${test[@]}"
says unplugged "'Gopura test panel.* was connected before"
sed 's/^\(EVIOCGABS(5[34]) 0 \).*/\1000000000000000000000000000000000000000000000000/; s/^\(EVIOCGABS(1) 0 \).*/\1000000000000000000000000000000000000000000000000/' \
	$data/panel.ioctl >"$work/flat.ioctl"
tests range touch plugged "$work/flat.ioctl" "${test[@]}"
grep -q 'which is not a range' "$work/range.log" || { cat "$work/range.log"; fail "the range is not told of"; }
