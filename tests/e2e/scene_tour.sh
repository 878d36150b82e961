#!/bin/bash
# A visitor watches a tour that a scene's moving Viewpoint makes, touches the door before which it rests, which halts the
# tour and opens the door, and goes on. Also a scene's way through a wall, which is not published.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/scene_tour
rm -rf "$work"
mkdir -p "$work"
small_release

# ---- through the door of the gate instead of up over it
mkdir "$work/bad"
cp -r "$small/content/." "$work/bad/"
sed -i 's/^    24 8 2.5,$/    14 4 2.5,/' "$work/bad/scenes/walk.wrl"
if build/gopura-content publish "$work/bad" --out "$work/release" --keys "$small_keys" 2>"$work/bad.log"; then
	fail "a way through a wall was published"
fi
cat "$work/bad.log"
grep -q 'tours.json:[0-9]*: tour "walk", from stop 3 to stop 4: the way leads through the scan at ' "$work/bad.log" ||
	fail "the wall has no name"

# ---- at 960 x 540: the bar's tours, the menu's third row, the door, the panel
cat >"$work/fingers.touch" <<'T'
4000 down 0 163 520
4080 up 0
6500 down 0 480 465
6580 up 0
32000 down 0 462 350
32080 up 0
37000 down 0 480 430
37080 up 0
T
printf '%s\n' '31500 before-the-door' '36500 opened' '46000 goes-on' >"$work/shots.txt"
build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless --size 960x540 \
	--release "$small/release" --trust "$small/release/root/1.json" --state "$work/state" --log debug --idle-s 60 \
	--touch-replay "$work/fingers.touch" --capture "$work/shots" --shots "$work/shots.txt" \
	>"$work/seen.json" 2>"$work/kiosk.log" || { tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
grep -oE 'app: (tour [a-z ]+|the scenery was touched|card of.*)' "$work/kiosk.log" | tee "$work/said"
[ "$(paste -sd, "$work/said")" = "app: tour walk,app: tour flies,app: tour halts,app: the scenery was touched,app: tour goes on,app: tour flies" ] ||
	fail "the touches did something else"
# The Viewpoint's place before the door, which walk.wrl has as 22.6 4 0 with y up.
grep -q 'tour halts: eye at 22.600 0.000 4.000' "$work/kiosk.log" || fail "the tour did not rest before the door"
! cmp -s "$work/shots/before-the-door.png" "$work/shots/opened.png" || fail "the door did not open"
