#!/bin/bash
# A visitor who chooses another language and large type, taps a part and walks away: the terminal asks, counts down,
# resets both and shows the temple until the next visitor, whose first touch counts.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/visitor
rm -rf "$work"
mkdir -p "$work"
small_release
# At 960 x 540: the bar's second language and its letters, then the temple's middle; 20 s after the last touch
# (5 with nothing open) the question has been there for 5, and is answered; then for good.
cat >"$work/fingers.touch" <<'T'
4000 down 0 373 520
4080 up 0
4800 down 0 269 520
4880 up 0
6000 down 0 480 240
6080 up 0
26500 down 0 480 270
26580 up 0
64000 down 0 480 240
64300 move 0 520 240
64600 move 0 560 240
64900 up 0
67000 down 0 480 20
67050 up 0
T
printf '%s\n' '5500 language' '25500 asked' '28000 answered' '48000 asked-again' '62500 nobody' '66500 somebody' >"$work/shots.txt"
build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless \
	--size 960x540 --release "$small/release" --trust "$small/release/root/1.json" --state "$work/state" \
	--log debug --idle-s 5 --visits "$work/visits.csv" --touch-replay "$work/fingers.touch" --capture "$work/shots" \
	--shots "$work/shots.txt" >"$work/seen.json" 2>"$work/kiosk.log" ||
	{ tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
grep -E 'app: (card of|nobody|somebody|is somebody|drag|comfort|words in)' "$work/kiosk.log"
python3 - "$work/kiosk.log" <<'P'
import re
import sys

marks = r"app: (card of|is somebody there|somebody is there|nobody is there|drag begins|comfort: (?P<comfort>\w+)|words in (?P<language>\w+))"
said = [m["language"] or m["comfort"] or m[1].split()[0] for m in re.finditer(marks, open(sys.argv[1]).read())]
assert said == ["fr", "large", "card", "is", "somebody", "is", "nobody", "forgotten", "en", "somebody", "drag"], said
P

# ---- the counts of the visit, without personal data, as the health page serves them
cat "$work/visits.csv"
cmp "$work/visits.csv" "$work/state/visits.csv" || fail "the copy says something else"
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
build/gopura-health --listen "127.0.0.1:$port" --visits "$work/visits.csv" 2>"$work/health.log" &
health=$!
trap 'kill "$health" 2>/dev/null || true' EXIT
wait_for 20 "counts from the health page" curl -sf -o "$work/served.csv" "http://127.0.0.1:$port/visits.csv"
cmp "$work/served.csv" "$work/visits.csv" || fail "the health page hands out something else"
python3 - "$work/served.csv" <<'P'
import collections
import csv
import sys

sums = collections.Counter()
for row in csv.DictReader(open(sys.argv[1])):
    sums[row["kind"], row["what"], row["language"]] += int(row["count"])
assert sums == {("visit", "", "en"): 2, ("language", "", "fr"): 1, ("part", "corner-towers", "fr"): 1}, sums
P
