#!/bin/bash
# A museum that changes nothing for years, and machines whose clock is wrong: what is published is signed again before it
# runs out, a terminal that shows it takes the next number without loading anything, and one that is new takes it too. A
# machine whose clock disagrees with the last signature signs nothing, and one that was months ahead once keeps no
# terminal from what is signed afterwards.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-tuf.sh
command -v nginx >/dev/null || skip "nginx is not installed"
make --no-print-directory build/tests/tools/virtual_clock.so >/dev/null
tuf_work build/e2e/renewal
# set_day WHO N: that machine's clock says so many days from today; on WHO COMMAND...: by that clock, which counts as set.
set_day() { python3 -c 'import os, struct, sys
os.pwrite(os.open(sys.argv[1], os.O_RDWR | os.O_CREAT, 0o644), struct.pack("<qq", 0, int(sys.argv[2]) * 86400 * 10**9), 0)
os.truncate(sys.argv[1], 4096)' "$work/$1.clock" "$2"; }
on() { LD_PRELOAD=$PWD/build/tests/tools/virtual_clock.so GOPURA_CLOCK=$PWD/$work/$1.clock "${@:2}"; }
sign() { on museum "$content" publish "$work/content" --out "$release" --keys "$keys" "$@" >"$work/log" 2>&1; }
try() { sign "$@" || { cat "$work/log"; fail "publish $*"; }; }
refuses() {
	local before
	before=$(sha256sum "$release"/*.json)
	! sign "$@" || fail "publish $* by a wrong clock is not refused"
	[ "$before" = "$(sha256sum "$release"/*.json)" ] || fail "what was refused changed what is published"
	says 'clock of this machine'
}
says() { grep -q -- "$1" "$work/log" || { cat "$work/log"; fail "it does not say: $1"; }; }

set_day museum 0
set_day terminals 0
on museum publish first
start_server "$release" "$work/server"
url=$server_url ca=$server_ca
on terminals terminal east "$keys/root/1.json"
wait_for 60 "the first release" said east 'release 1 is shown'

# ---- five years and a half, in which nobody publishes
for day in 365 730 1094; do
	set_day museum $day
	try --renew
	says 'release 1 (nothing changed)'
	set_day terminals $day
done
set_day museum 1096
try --renew
says 'release 2 in'
wait_for 60 "the next number" said east 'release 2 is shown'
[ "$(grep -c 'app: showing' "$work/east.log")" = 1 ] || fail "it loads what it has"
for day in 1460 1825 2000; do
	set_day museum $day
	on museum "$content" build "$work/content" --out "$release" --keys "$keys" --comment first >"$work/log" 2>&1 || { cat "$work/log"; fail "build on day $day"; }
	set_day terminals $day
done
says 'nothing changed since'
on terminals terminal west "$keys/root/1.json"
wait_for 60 "the release on a new terminal" said west 'release 2 is shown'
! refused east && ! refused west || fail "something was refused"

# ---- a machine whose clock is wrong
for day in -2500 1998 2402; do
	set_day museum $day
	refuses --renew
	refuses --comment "by a wrong clock"
	refuses --undo
done
set_day museum 2300
try --comment ahead
wait_for 60 "the release of the clock that is ahead" said east 'release 3 is shown'
set_day museum 2000
refuses --comment right
try --comment right --trust-clock
wait_for 60 "the release of the clock that is right" said east 'release 4 is shown'
try --renew
! refused east || { cat "$work/east.log"; fail "the clock that was ahead blocks the terminal"; }
stop_terminal east
stop_terminal west
