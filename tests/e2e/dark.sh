#!/bin/bash
# A kiosk that starts outside its hours draws no frame. Even so it loads an update and puts it in the place of the other.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/dark
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory build/tests/tools/set_clock.so >/dev/null
small_release
cp -a "$small/content" "$work/content"
cp -a "$small/release" "$work/release"
pid=
trap '[ -z "$pid" ] || kill -9 "$pid" 2>/dev/null || true; stop_server' EXIT
serve "$work/release" "$work/server"
start_kiosk() { # LOG OPTION...
	log=$1
	shift
	LD_PRELOAD=$PWD/build/tests/tools/set_clock.so build/gopura-kiosk --display headless --size 320x180 --release "$url" \
		--ca "$ca" --poll-s 1 --log debug --trust "$work/release/root/1.json" --state "$work/state" "$@" 2>"$log" &
	pid=$!
}
says() { grep -qE "$1" "$log" 2>/dev/null; }
end_kiosk() {
	kill "$pid"
	wait "$pid" || fail "the kiosk did not end well"
	pid=
}

start_kiosk "$work/lit.log"
wait_for 60 "first release" says 'release 1 is shown'
trial_is_over() { [ -n "$(find "$work/state/state.db.second" -newer "$work/lit.log.shown")" ]; }
touch "$work/lit.log.shown"
wait_for 30 "proof of the release" trial_is_over
end_kiosk

closed="$(LC_ALL=C date -d '2 days' +%a) 10:00-11:00"
start_kiosk "$work/dark.log" --hours "$closed"
wait_for 30 "panel that is off" says 'the panel is off'
wait_for 30 "release 1 in the dark" says 'app: showing'
sed -i "s/<h1>/<h1>Second: /" "$work"/content/pages/*.en.html
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >/dev/null
wait_for 90 "release 2 in the dark" says 'release 2 is shown'
! says 'first picture' || fail "a picture was drawn in the dark"
end_kiosk
