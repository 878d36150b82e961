#!/bin/bash
# A visitor who chooses a guided tour, touches the model during it, continues it and watches it to its end; then nobody
# is there, and the content's own tour runs. Also a tour through a wall, which is not published.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/tours
rm -rf "$work"
mkdir -p "$work"
small_release

# ---- through the gate's wall
mkdir "$work/bad"
cp -r "$small/content/." "$work/bad/"
sed -i 's/"eye": \[22.4, -0.7, 4.5\]/"eye": [14, -0.7, 4.5]/' "$work/bad/tours.json"
if build/gopura-content publish "$work/bad" --out "$work/release" --keys "$small_keys" 2>"$work/bad.log"; then
	fail "a tour through a wall was published"
fi
cat "$work/bad.log"
grep -q 'tours.json:[0-9]*: tour "round", from stop 3 to stop 4: the way leads through the scan at 1[0-9.]* ' "$work/bad.log" ||
	fail "the wall has no name"
[ ! -e "$work/release/release.json" ] || fail "something was published"

# ---- at 960 x 540: the bar's tours, the menu's second row, the model, the panel
cat >"$work/fingers.touch" <<'T'
4000 down 0 163 520
4080 up 0
6500 down 0 480 420
6580 up 0
30000 down 0 480 150
30200 move 0 520 150
30400 move 0 560 160
30600 move 0 560 160
30800 up 0
34000 down 0 480 470
34080 up 0
102000 down 0 480 150
102080 up 0
104000 down 0 480 20
104050 up 0
T
printf '%s\n' '5800 menu' '28000 flown' '33000 halted' '44000 goes-on' '100000 nobody' '103500 somebody' >"$work/shots.txt"
build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless --size 960x540 \
	--release "$small/release" --trust "$small/release/root/1.json" --state "$work/state" --log debug --idle-s 5 \
	--visits "$work/visits.csv" --touch-replay "$work/fingers.touch" --capture "$work/shots" --shots "$work/shots.txt" \
	>"$work/seen.json" 2>"$work/kiosk.log" || { tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
grep -E 'app: (tour|nobody|somebody|is somebody|drag)' "$work/kiosk.log"
python3 - "$work/kiosk.log" "$work/visits.csv" <<'P'
import collections
import csv
import math
import re
import sys

log = open(sys.argv[1]).read()
marks = r"app: (tour [\w ]+|is somebody there|somebody is there|nobody is there|drag begins)"
said = [m[1] for m in re.finditer(marks, log)]
assert [what for what in said if what != "tour flies"] == [
    "tour guardians", "tour halts", "drag begins", "tour goes on", "tour ends", "is somebody there", "nobody is there",
    "tour round for nobody", "somebody is there"], said

# The eye returns to where it left the tour, and jumps only while the visitor moves it.
place = r": eye at (\S+) (\S+) (\S+)"
taken, back = (tuple(map(float, re.findall("app: tour " + what + place, log)[at]))
               for what, at in (("halts", 0), ("flies", said[:said.index("tour halts")].count("tour flies"))))
print(f"taken at {taken}, back at {back}")
# On a slow machine, where the eye was still flying to the first stop, it returns to that flight.
assert math.dist(taken, back) < 0.002 or said[1] == "tour halts", said
own = log[:log.index("tour halts")], log[log.index("tour goes on"):]
longest = 0
for part in own:
    eyes = [tuple(map(float, m)) for m in re.findall(r"app: eye at (\S+) (\S+) (\S+),", part)]
    longest = max([longest] + [math.dist(a, b) for a, b in zip(eyes, eyes[1:])])
print(f"the longest step of the eye by itself: {longest:.2f} m")
assert 0.1 < longest < 4, longest  # it is said now and then, not each frame: 1 to 2 m; a jump is some 20

counts = collections.Counter()
for row in csv.DictReader(open(sys.argv[2])):
    counts[row["kind"], row["what"]] += int(row["count"])
assert counts[("tour", "guardians")] == 1 and counts[("visit", "")] == 2, counts
assert ("tour", "round") not in counts, counts
P
