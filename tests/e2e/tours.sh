#!/bin/bash
# A visitor who chooses a guided tour, takes the eye in hand on its way, lets it go on and watches it to its
# end; then nobody, whom the content's own tour shows the temple. And a tour through a wall, which
# is not published.
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
if build/gopura-content publish "$work/bad" --out "$work/release" 2>"$work/bad.log"; then
	fail "a tour through a wall was published"
fi
cat "$work/bad.log"
grep -q 'tours.json:[0-9]*: tour "round", from stop 3 to stop 4: the way leads through the scan at 1[0-9.]* ' "$work/bad.log" ||
	fail "the wall has no name"
[ ! -e "$work/release/release.json" ] || fail "something was published"

# ---- at 960 x 540: the bar's tours, the menu's second row, the model, the panel
cat >"$work/fingers.touch" <<'T'
4000 down 0 128 520
4080 up 0
6500 down 0 480 465
6580 up 0
17000 down 0 480 150
17200 move 0 520 150
17400 move 0 560 160
17600 move 0 560 160
17800 up 0
21000 down 0 480 470
21080 up 0
98000 down 0 480 150
98080 up 0
100000 down 0 480 20
100050 up 0
T
printf '%s\n' '5800 menu' '15500 flown' '19500 halted' '31000 goes-on' '96000 nobody' '99500 somebody' >"$work/shots.txt"
build/gopura-kiosk --display headless --size 960x540 --release "$small/release" \
	--trust "$small/release/root/1.json" --state "$work/state" --log debug --idle-s 5 --visits "$work/visits.csv" \
	--touch-replay "$work/fingers.touch" --quit-after-replay --capture "$work/shots" --shots "$work/shots.txt" \
	2>"$work/kiosk.log" || { tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
grep -E 'app: (tour|nobody|somebody|is somebody|drag)' "$work/kiosk.log"
python3 - "$work/kiosk.log" "$work/visits.csv" <<'P'
import csv
import math
import re
import sys

log = open(sys.argv[1]).read()
marks = r"app: (tour [\w ]+|is somebody there|somebody is there|nobody is there|drag begins)"
said = [m[1] for m in re.finditer(marks, log)]
assert said == ["tour guardians", "tour halts", "drag begins", "tour goes on", "tour ends", "is somebody there",
                "nobody is there", "tour round for nobody", "somebody is there"], said

# The eye: it never jumps, it comes back to where it was taken from the tour, and it stays where the
# next visitor touches.
way = []
for line in log.splitlines():
    if m := re.search(r"app: (tour halts|tour goes on|tour ends|somebody is there)", line):
        way.append(m[1])
    elif m := re.search(r"app: eye at (\S+) (\S+) (\S+), looks", line):
        way.append(tuple(map(float, m.groups())))
eyes = [at for at in way if isinstance(at, tuple)]
longest = max(math.dist(a, b) for a, b in zip(eyes, eyes[1:]))
print(f"{len(eyes)} places of the eye, the longest step {longest:.2f} m")
assert longest < 4, longest
halted = [at for at in way[:way.index("tour halts")] if isinstance(at, tuple)][-1]
after = [at for at in way[way.index("tour goes on"):way.index("tour ends")] if isinstance(at, tuple)]
back = min(math.dist(halted, at) for at in after)
print(f"taken at {halted}, back within {back:.2f} m of it")
assert back < 0.6, back

counts = {(r["kind"], r["what"]): int(r["count"]) for r in csv.DictReader(open(sys.argv[2]))}
assert counts[("tour", "guardians")] == 1 and counts[("visit", "")] == 2, counts
assert ("tour", "round") not in counts, counts
P
