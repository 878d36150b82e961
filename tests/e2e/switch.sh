#!/bin/bash
# The switch from one release to the next under difficult conditions: invalid patches, visitors in the middle of it, a
# release on trial that crashes, a kill at any moment of the switch, and a time of day in which nothing is loaded.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-kiosk.sh
work=build/e2e/switch
begin_release
serve "$work/release" "$work/server"
start_kiosk() { # LOG OPTION...
	run_kiosk "$1" --release "$url" --ca "$ca" --idle-s 5 --trust "$work/release/root/1.json" "${@:2}"
}
crash_kiosk() {
	kill -9 "$pid"
	wait "$pid" 2>/dev/null || true
	pid=
}

# ---- a release that is signed and whole, and holds no patches
make --no-print-directory build/tests/tools/spoiled_release >/dev/null
start_kiosk "$work/spoiled.log"
wait_for 60 "first release" says 'release 1 is shown'
prove
build/tests/tools/spoiled_release "$small_keys" "$work/release"
wait_for 60 "refusal of what cannot be decoded" says 'refused release 2: objects of it cannot be decoded'
! says 'release 2 is shown' || fail "what cannot be decoded was shown"
publish Mended
wait_for 90 "the next release" says 'release 3 is shown'
prove
end_kiosk
cp -a "$small/content/." "$work/content/"
rm -rf "$work/release"/* "$work/state"
cp -a "$small/release/." "$work/release/"

# ---- a visitor drags for half a minute, and a release arrives meanwhile
start_kiosk "$work/first.log"
wait_for 60 "first release" says 'release 1 is shown'
prove
end_kiosk
for ((ms = 1000; ms < 26000; ms += 2000)); do
	printf '%d down 0 160 90\n%d move 0 180 90\n%d up 0\n' "$ms" $((ms + 300)) $((ms + 600))
done >"$work/drags.touch"
start_kiosk "$work/visit.log" --touch-replay "$work/drags.touch"
wait_for 60 "a finger" says 'drag begins'
publish Second
wait_for 90 "release 2 after the visit" says 'release 2 is shown'
[ "$(grep -nE 'drag ends|is shown' "$log" | tail -n 1 | grep -c 'is shown')" = 1 ] ||
	fail "the release changed under a finger"
# On a busy machine a drag that began and ended between two frames is none: most of the 13 are enough.
[ "$(grep -c 'drag ends' "$log")" -ge 9 ] || fail "the visit was cut short"
wait_for 20 "release 2 on the panel" grep -cq 'app: showing' "$log"

# ---- a release crashes on trial: after three starts without a picture the previous one is back
crash_kiosk
stop_server
printf '#!/bin/sh\nexec sleep 20\n' >"$work/silent"
chmod +x "$work/silent"
for try in 2 3; do
	start_kiosk "$work/try$try.log" --fetch "$work/silent"
	wait_for 30 "start $try" says "release 2 is on trial, start $try of 3"
	sleep 1
	crash_kiosk
done
start_kiosk "$work/back.log"
wait_for 30 "refusal of what never worked" says 'refused release 2: it was started three times'
wait_for 60 "the release before, without a network" says 'first picture'
end_kiosk
serve "$work/release" "$work/server"
start_kiosk "$work/again.log"
wait_for 30 "first picture" says 'first picture'
wait_for 30 "the server" says 'net: online'
sleep 4 # several looks at the server
! says 'release 2 is' || fail "what was refused was taken up again"
publish Third
wait_for 90 "release 3" says 'release 3 is shown'
prove
end_kiosk

# ---- killed during the switch, at different moments: the old or the new release is shown
news=0
for delay in 0 0.1 0.2 0.4 0.8; do
	start_kiosk "$work/kill.log"
	wait_for 60 "first picture" says 'first picture'
	publish "At $delay"
	wait_for 60 "the next release" says 'is published'
	sleep "$delay"
	crash_kiosk
	stop_server
	start_kiosk "$work/killed.log"
	wait_for 60 "a picture without a network after a kill at $delay s" says 'first picture'
	! says 'damaged|broken|content bug' || { cat "$log"; fail "damage after a kill"; }
	if says 'on trial'; then
		news=$((news + 1))
		prove
	fi
	end_kiosk
	serve "$work/release" "$work/server"
done
echo "killed 5 times: $news times the new release was remembered already"

# ---- a time of day in which nothing is brought
now=$(date +%H:%M)
later=$(date -d '2 hours' +%H:%M)
latest=$(date -d '3 hours' +%H:%M)
start_kiosk "$work/closed.log" --download "$later-$latest"
wait_for 60 "first picture" says 'first picture'
publish Nightly
wait_for 30 "the next release" says 'is published'
sleep 5
clock_is_set() { [ "$(adjtimex_status)" = set ]; }
adjtimex_status() { python3 -c '
import ctypes
class Timex(ctypes.Structure):
    _fields_ = [("bytes", ctypes.c_byte * 208)]
print("unset" if ctypes.CDLL(None).adjtimex(ctypes.byref(Timex())) == 5 else "set")'; }
if clock_is_set; then
	! says 'is shown' || fail "a release was brought at a time when none is to be"
	end_kiosk
	start_kiosk "$work/open.log" --download "$now-$later"
fi
wait_for 90 "the release at its time" says 'is shown'
end_kiosk
