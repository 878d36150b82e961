#!/bin/bash
# The GPU context is lost in the middle of a visit (simulated by tests/tools/lost_gl.c): the kiosk logs one line and
# exits with the status that requests a restart, and the next one shows the temple again from its cache.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/lost
rm -rf "$work"
mkdir -p "$work"
small_release
release=$small/release pid=
trap 'kill $pid 2>/dev/null || true' EXIT
kiosk=(build/gopura-kiosk --display headless --size 320x180 --release "$release"
	--trust "$release/root/1.json" --state "$work/state")

# loses WAY SECONDS STATUS: told as LOST_GL_BY says, so long after the first picture.
loses() {
	local log=$work/$1-$2.log status=0
	rm -f "$work/reset"
	# A watchdog has the kiosk draw at rest too, as in the field.
	WATCHDOG_USEC=1000000 LOST_GL=$work/reset LOST_GL_BY=$1 LD_PRELOAD=$PWD/build/tests/tools/lost_gl.so \
		NOTIFY_SOCKET=@gopura-nobody "${kiosk[@]}" 2>"$log" &
	pid=$!
	wait_for 60 "first picture ($1)" grep -q 'app: first picture' "$log"
	sleep "$2"
	touch "$work/reset"
	wait "$pid" || status=$?
	[ "$status" = "$3" ] || { tail -20 "$log"; fail "$1: ended with status $status, not $3"; }
	[ "$(grep -c 'the GPU los.* its context' "$log")" = 1 ] || fail "$1: not one line about it"
	! grep -E 'GL says|kiosk bug|content bug|stopping' "$log" || fail "$1: more is said than that"
}
loses status 6 76
loses error 6 76
# One that is lost at once would be lost again: that is a crash, and three of them bring the safe page.
loses status 0 1
"${kiosk[@]}" 2>"$work/again.log" &
pid=$!
wait_for 60 "first picture once more" grep -q 'app: first picture' "$work/again.log"
kill "$pid"
wait "$pid" || fail "the kiosk did not end well"
