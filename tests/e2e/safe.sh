#!/bin/bash
# The safe page: it is drawn although EGL finds no driver and nothing else of the kiosk is there, upright on a rotated
# panel, moving, and with a broken profile too.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/safe
rm -rf "$work"
mkdir -p "$work"
# No driver, no home, no state: everything that may fail is missing.
bare=(env -i PATH=/nowhere __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null LIBGL_DRIVERS_PATH=/nowhere)
! "${bare[@]}" "$PWD/build/gopura-kiosk" --display headless --release build/e2e/nothing --state "$work/state" \
	2>"$work/kiosk.log" || fail "the kiosk needs no GPU: nothing is tested here"

# shoots NAME BOARD SIZE
shoots() {
	printf '%s' "$2" >"$work/$1.ini"
	"${bare[@]}" "$PWD/build/gopura-kiosk" --safe-page --display headless --size "$3" --board "$work/$1.ini" \
		--capture "$work/$1" 2>"$work/$1.log" || { cat "$work/$1.log"; fail "$1: no safe page"; }
}
shoots flat '' 640x360
shoots broken $'[panel]\nrotation = 45\n' 640x360
grep -q 'broken.ini' "$work/broken.log" || fail "the broken profile is not told of"
! cmp -s "$work/flat/safe-0.png" "$work/flat/safe-1.png" || fail "the safe page stands still"
cmp -s "$work/flat/safe-1.png" "$work/broken/safe-1.png" || fail "a broken profile spoils the page"

# For a panel that is mounted rotated the picture is rotated too: the visitor sees the same page.
mkdir -p "$work/truth"
cp "$work/flat/safe-1.png" "$work/truth/view-0000.png"
for turn in 90 180 270; do
	size=640x360
	[ "$turn" = 180 ] || size=360x640
	shoots "$turn" "$(printf '[panel]\nrotation = %s' "$turn")" "$size"
	build/tests/tools/turn_picture $((turn / 90)) "$work/$turn/safe-1.png" "$work/$turn/view-0000.png"
	build/tests/tools/compare_pictures "$work/truth" "$work/$turn" | tail -n 1 >"$work/$turn.json"
	python3 -c "import json, sys; sys.exit(json.load(open('$work/$turn.json'))['psnr_db'] < 25)" ||
		{ cat "$work/$turn.json"; fail "turned by $turn degrees it is another page"; }
done
# gopura.conf can set the rotation too, whatever else is in it.
printf '[panel]\nrotation = 90\nhours = never\n' >"$work/gopura.conf"
"${bare[@]}" "$PWD/build/gopura-kiosk" --safe-page --display headless --size 360x640 --conf "$work/gopura.conf" \
	--capture "$work/conf" 2>"$work/conf.log" || fail "no safe page by gopura.conf"
cmp "$work/90/safe-1.png" "$work/conf/safe-1.png" || fail "gopura.conf does not turn the safe page"
cat "$work"/*.json
