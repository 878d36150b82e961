#!/bin/bash
# What a service manager receives: a ready message once there is a picture, keep-alives as long as pictures reach the
# panel, at rest too, and none from a program that hangs; the same for the fetcher.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/watchdog
rm -rf "$work"
mkdir -p "$work"
small_release
release=$small/release pid=
trap '{ kill -USR2 $pid && kill $pid; } 2>/dev/null || true' EXIT

# managed NAME COMMAND...: starts it as systemd would with WatchdogSec=3; its messages go to $work/NAME, one per line with its time in seconds
managed() {
	local name=$1
	shift
	python3 - "$work/$name" "$@" 2>"$work/$name.log" <<'P' &
import os, signal, socket, subprocess, sys, time
manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
manager.bind("\0gopura-%d" % os.getpid())
name = "@gopura-%d" % os.getpid()
program = subprocess.Popen(["sh", "-c", 'WATCHDOG_PID=$$ exec "$@"', "sh"] + sys.argv[2:],
                           env=dict(os.environ, NOTIFY_SOCKET=name, WATCHDOG_USEC="3000000"))
signal.signal(signal.SIGTERM, lambda *_: program.terminate())
signal.signal(signal.SIGUSR1, lambda *_: program.send_signal(signal.SIGSTOP))
signal.signal(signal.SIGUSR2, lambda *_: program.send_signal(signal.SIGCONT))
manager.settimeout(0.2)
with open(sys.argv[1], "w", buffering=1) as out:
    while program.poll() is None:
        try:
            out.write("%.2f %s\n" % (time.monotonic(), manager.recv(4096).decode()))
        except TimeoutError:
            pass
    manager.setblocking(False)
    try:
        while True:
            out.write("%.2f %s\n" % (time.monotonic(), manager.recv(4096).decode()))
    except BlockingIOError:
        pass
sys.exit(program.returncode)
P
	pid=$!
}
heard() { [ "$(grep -c "$2" "$work/$1")" -ge "$3" ]; }

# is_well NAME: checks that it was ready, then sent pings less than WatchdogSec apart; none while it was stopped, some
# after.
is_well() {
	local before
	wait_for 60 "$1 to be ready" heard "$1" READY=1 1
	wait_for 30 "$1 to say that it is well" heard "$1" WATCHDOG=1 4
	awk '{ if (NR > 1 && $1 - last >= 3) { print "silent for " $1 - last " s"; bad = 1 } last = $1 } END { exit bad }' \
		"$work/$1" || fail "$1 would have been killed"
	kill -USR1 "$pid"
	sleep 0.3 # what was on its way
	before=$(grep -c WATCHDOG=1 "$work/$1")
	sleep 3
	[ "$(grep -c WATCHDOG=1 "$work/$1")" = "$before" ] || fail "$1 says that it is well and hangs"
	kill -USR2 "$pid"
	wait_for 10 "$1 to go on" heard "$1" WATCHDOG=1 $((before + 1))
	kill "$pid"
	wait "$pid" || fail "$1 did not end well"
	heard "$1" STOPPING=1 1 || fail "$1 does not say that it ends"
	[ "$(grep -c READY=1 "$work/$1")" = 1 ] || fail "$1 was ready more than once"
}

managed kiosk build/gopura-kiosk --display headless --size 640x360 --release "$release" \
	--trust "$release/root/1.json" --state "$work/state"
is_well kiosk
managed safe build/gopura-kiosk --safe-page --display headless --size 640x360
is_well safe
managed fetch build/gopura-fetch --release "$release" --cache "$work/cache.db" --socket "$work/socket"
is_well fetch

# What the manager sends to a program that hangs leaves the place where it hung.
build/gopura-fetch --release "$release" --cache "$work/ended.db" --socket "$work/ended" 2>"$work/ended.log" &
pid=$!
wait_for 20 "the fetcher's socket" test -S "$work/ended"
kill -ABRT "$pid"
status=0
wait "$pid" || status=$?
[ "$status" = 134 ] || fail "SIGABRT ended it with status $status"
grep -q 'net: crashed by SIGABRT' "$work/ended.log" && grep -q 'gopura-fetch(+0x' "$work/ended.log" ||
	{ cat "$work/ended.log"; fail "it does not tell where it was"; }
