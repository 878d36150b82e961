#!/bin/bash
# A visitor's two fingers on a real device: a multitouch panel that umockdev creates under /dev/input, read by libevdev.
# Spreading fingers zoom in, one finger turns, a tap opens a card; the server is killed between two gestures.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v umockdev-run >/dev/null || skip "umockdev-run is not installed"
work=build/e2e/touch data=tests/input/data
rm -rf "$work"
mkdir -p "$work"
small_release
serve "$small/release" "$work/server"
kiosk=(build/gopura-kiosk --display headless --size 960x540 --release "$url" --ca "$ca"
	--trust "$small/release/root/1.json" --state "$work/state" --log debug)

# A first visit fills the cache with the objects that the second one needs first.
head -n 3 <(grep -v '^#' tests/bench/views.txt) >"$work/views.txt"
"${kiosk[@]}" --views "$work/views.txt" --capture "$work/views" 2>"$work/first.log" ||
	{ tail -n 20 "$work/first.log"; fail "the kiosk ended with an error"; }

umockdev-run -d $data/panel.umockdev -i /dev/input/event5=$data/panel.ioctl \
	-e /dev/input/event5=$data/panel-visit.events -- "${kiosk[@]}" 2>"$work/kiosk.log" &
pid=$!
trap 'kill $pid 2>/dev/null || true; stop_server' EXIT
log=$work/kiosk.log
wait_for 60 "first picture" grep -q 'app: showing' "$log"
wait_for 90 "pinch" grep -q 'app: pinch ends' "$log"
stop_server
echo "server killed"
wait_for 60 "drag" grep -q 'app: drag ends' "$log"
wait_for 60 "card" grep -q 'app: card of' "$log"
serve "$small/release" "$work/server" "$port"
trap 'kill $pid 2>/dev/null || true; stop_server' EXIT
wait_for 90 "word of the server's return" sh -c "grep 'museum server' '$log' | tail -n 1 | grep -q answers"
kill -0 "$pid" || fail "the kiosk ended"
pkill -TERM -P "$pid" || kill "$pid"
wait "$pid" || { tail -n 30 "$log"; fail "the kiosk did not end well"; }

# ---- where the eye was: nearer after the pinch, elsewhere after the drag
python3 - "$log" <<'P'
import math
import re
import sys

line = re.compile(r"app: (pinch|drag) (begins|ends): eye at (\S+) (\S+) (\S+)")
at = {}
for m in map(line.search, open(sys.argv[1])):
    if m:
        at.setdefault(f"{m[1]} {m[2]}", [float(x) for x in m.groups()[2:]])
print(at)
moved = lambda what: math.dist(at[f"{what} begins"], at[f"{what} ends"])
far = math.dist(at["pinch begins"], [0, 0, 9])
assert 0.2 * far < moved("pinch") < 0.8 * far, "fingers twice as far apart are half the way"
assert math.dist(at["pinch ends"], [0, 0, 9]) < 0.8 * far, "the eye is no nearer"
assert moved("drag") > 2, "the eye did not turn about the temple"
P
