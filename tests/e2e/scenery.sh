#!/bin/bash
# A visitor chooses a layer of what stands beside the scan, opens a door of VRML97 and turns a board of glTF by touching
# them, slides a bolt with a finger, and makes a banner flap and redden.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/scenery
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content"
cp tests/e2e/board.gltf tests/e2e/bolt.wrl "$work/content/scenes/"
sed -i 's|^  "scenes": \[|  "scenes": [\n    {"file": "scenes/board.gltf", "plays": "touch"},\n    {"file": "scenes/bolt.wrl", "up": "z"},|' "$work/content/scenes.json"
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >"$work/build.log" 2>&1 ||
	{ cat "$work/build.log"; fail "no release with a glTF scene"; }
# At 960 x 540: somebody comes; "As built" at the right end of the bar's line; the door in the eastern gallery; the board
# beside it; the bolt at the left, which is drawn to the right; the banner; the bolt
# again, a little back.
cat >"$work/fingers.touch" <<'T'
20000 down 0 480 20
20080 up 0
24000 down 0 922 516
24080 up 0
28000 down 0 698 378
28080 up 0
32500 down 0 750 285
32580 up 0
36500 down 0 195 183
36600 move 0 215 184
36700 move 0 235 185
37200 move 0 236 185
37300 up 0
39500 down 0 335 127
39580 up 0
43500 down 0 225 183
43600 move 0 210 183
43800 move 0 195 182
44000 up 0
T
printf '%s\n' '23000 found' '26500 built' '31500 opened' '35500 turned' '38900 slid' '42500 flapped' '46500 back' >"$work/shots.txt"
build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless \
	--size 960x540 --release "$work/release" --trust "$work/release/root/1.json" --state "$work/state" \
	--log debug --idle-s 8 --touch-replay "$work/fingers.touch" --capture "$work/shots" --shots "$work/shots.txt" \
	>"$work/seen.json" 2>"$work/kiosk.log" || { tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
[ "$(grep -oE 'app: (layer 1|the scenery (was touched|is held|is let go)|card of.*)' "$work/kiosk.log" | paste -sd,)" = \
	"app: layer 1,app: the scenery was touched,app: the scenery was touched,app: the scenery is held,app: the scenery is let go,app: the scenery was touched,app: the scenery is held,app: the scenery is let go" ] || { grep app: "$work/kiosk.log"; fail "the touches did something else"; }
! cmp -s "$work/shots/found.png" "$work/shots/built.png" || fail "the layers look alike"
! cmp -s "$work/shots/built.png" "$work/shots/opened.png" || fail "the door did not move"
! cmp -s "$work/shots/opened.png" "$work/shots/turned.png" || fail "the board did not turn"
# The eye stood still while the finger drew, and no help was shown any more.
[ "$(grep -oE 'drag (begins|ends): eye at [-0-9. ]+' "$work/kiosk.log" | sed 's/.*: eye/eye/' | sort -u | wc -l)" = 1 ] ||
	fail "the eye went with the bolt"
! cmp -s "$work/shots/slid.png" "$work/shots/flapped.png" || fail "the banner did not flap"
! cmp -s "$work/shots/flapped.png" "$work/shots/back.png" || fail "the bolt did not slide"
