#!/bin/bash
# A visitor opens the picture of a page: it covers the whole panel, two fingers zoom it, a double tap shows it whole
# again, and its control closes it.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/gallery log=build/e2e/gallery/kiosk.log
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory build/tests/tools/compare_pictures >/dev/null
small_release
cat >"$work/at.shots" <<'S'
11500 1-page
13500 2-picture
15500 3-zoomed
17500 4-whole
19500 5-closed
S
build/gopura-kiosk --display headless --size 1280x720 --release "$small/release" \
	--trust "$small/release/root/1.json" --state "$work/state" --log debug \
	--touch-replay tests/e2e/gallery.touch --quit-after-replay --shots "$work/at.shots" \
	--capture "$work/shots" 2>"$log" || { tail -n 30 "$log"; fail "the kiosk ended with an error"; }
[ "$(grep -oE 'page of .*|picture -?[0-9]+$' "$log" | tr '\n' ' ')" = \
	"page of central-tower picture 0 picture -1 " ] ||
	{ grep 'app:' "$log"; fail "not that page and its picture"; }

# near A B: the PSNR of the second picture to the first, in whole dB.
near() {
	local name
	for name in "$1" "$2"; do
		mkdir -p "$work/$name"
		cp "$work/shots/$name.png" "$work/$name/view-0000.png"
	done
	build/tests/tools/compare_pictures "$work/$1" "$work/$2" | tail -n 1 |
		python3 -c 'import json, sys; print(int(min(99, json.load(sys.stdin)["psnr_db"])))'
}
opened=$(near 1-page 2-picture) zoomed=$(near 2-picture 3-zoomed) whole=$(near 2-picture 4-whole)
closed=$(near 1-page 5-closed)
echo "dB: page and picture $opened, picture and zoomed $zoomed, whole again $whole, page again $closed"
[ "$opened" -lt 20 ] || fail "the picture did not open"
[ "$zoomed" -lt 25 ] || fail "two fingers did not zoom"
[ "$whole" -gt $((zoomed + 8)) ] || fail "two taps did not show it whole again"
[ "$closed" -gt $((opened + 5)) ] || fail "it did not close"
