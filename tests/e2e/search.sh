#!/bin/bash
# A visitor searches: the search opens from the bar, letters are typed on the panel's keyboard, results have their
# pictures, and a tap on one opens its card and flies the camera there.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/search log=build/e2e/search/kiosk.log
rm -rf "$work"
mkdir -p "$work"
small_release
cat >"$work/at.shots" <<'S'
5500 1-before
9500 2-typed
12500 3-found
14800 4-french
S
build/gopura-kiosk --display headless --size 1280x720 --release "$small/release" \
	--trust "$small/release/root/1.json" --state "$work/state" --log debug \
	--touch-replay tests/e2e/search.touch --quit-after-replay --shots "$work/at.shots" \
	--capture "$work/shots" 2>"$log" || { tail -n 30 "$log"; fail "the kiosk ended with an error"; }
[ "$(grep -o 'search: [0-9]* bytes typed' "$log" | tr '\n' ' ')" = \
	"search: 1 bytes typed search: 2 bytes typed search: 3 bytes typed search: 4 bytes typed " ] ||
	{ grep 'app:' "$log"; fail "not four letters were typed"; }
[ "$(grep -o 'card of .*' "$log" | tr '\n' ' ')" = "card of naga card of corner-towers " ] ||
	{ grep 'app:' "$log"; fail "not the part that was looked for"; }
python3 - "$log" <<'P'
import math
import re
import sys

# The eye before the part was chosen and after the flight to it.
eyes, before = [], None
for line in open(sys.argv[1]):
    m = re.search(r"eye at (\S+) (\S+) (\S+), looks at", line)
    if m:
        eyes.append([float(x) for x in m.groups()])
    if "card of naga" in line:
        before = len(eyes)
assert before and len(eyes) > before, "the eye did not move"
assert math.dist(eyes[before - 1], eyes[-1]) > 2, "the eye did not fly to the part"
P
