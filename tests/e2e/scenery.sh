#!/bin/bash
# A visitor chooses a layer of what stands beside the scan, opens a door of VRML97 and turns a board of glTF by touching
# them.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/scenery
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content"
cp tests/e2e/board.gltf "$work/content/scenes/"
sed -i 's|^  "scenes": \[|  "scenes": [\n    {"file": "scenes/board.gltf", "plays": "touch"},|' "$work/content/scenes.json"
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >"$work/build.log" 2>&1 ||
	{ cat "$work/build.log"; fail "no release with a glTF scene"; }
# At 960 x 540: somebody comes; "As built" at the right end of the bar's line; the door in the eastern gallery; the board
# beside it.
cat >"$work/fingers.touch" <<'T'
20000 down 0 480 20
20080 up 0
24000 down 0 922 516
24080 up 0
28000 down 0 698 378
28080 up 0
32500 down 0 750 285
32580 up 0
T
printf '%s\n' '23000 found' '26500 built' '31500 opened' '35500 turned' >"$work/shots.txt"
build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless \
	--size 960x540 --release "$work/release" --trust "$work/release/root/1.json" --state "$work/state" \
	--log debug --idle-s 8 --touch-replay "$work/fingers.touch" --capture "$work/shots" --shots "$work/shots.txt" \
	>"$work/seen.json" 2>"$work/kiosk.log" || { tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
[ "$(grep -oE 'app: (layer 1|the scenery was touched|card of.*)' "$work/kiosk.log" | paste -sd,)" = \
	"app: layer 1,app: the scenery was touched,app: the scenery was touched" ] || { grep app: "$work/kiosk.log"; fail "the touches did something else"; }
! cmp -s "$work/shots/found.png" "$work/shots/built.png" || fail "the layers look alike"
! cmp -s "$work/shots/built.png" "$work/shots/opened.png" || fail "the door did not move"
! cmp -s "$work/shots/opened.png" "$work/shots/turned.png" || fail "the board did not turn"
