#!/bin/bash
# A kiosk that starts outside its hours draws no frame. Even so it loads an update and puts it in the place of the other.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-kiosk.sh
work=build/e2e/dark
make --no-print-directory build/tests/tools/set_clock.so >/dev/null
begin_release
serve "$work/release" "$work/server"
start_kiosk() { # LOG OPTION...
	LD_PRELOAD=$PWD/build/tests/tools/set_clock.so run_kiosk "$1" --release "$url" --ca "$ca" \
		--trust "$work/release/root/1.json" "${@:2}"
}

start_kiosk "$work/lit.log"
wait_for 60 "first release" says 'release 1 is shown'
prove
end_kiosk

closed="$(LC_ALL=C date -d '2 days' +%a) 10:00-11:00"
start_kiosk "$work/dark.log" --hours "$closed"
wait_for 30 "panel that is off" says 'the panel is off'
wait_for 30 "release 1 in the dark" says 'app: showing'
publish Second
wait_for 90 "release 2 in the dark" says 'release 2 is shown'
! says 'first picture' || fail "a picture was drawn in the dark"
end_kiosk
