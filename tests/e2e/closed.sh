#!/bin/bash
# A dirty scan becomes one closed surface (docs/octree.md): built with surface = octree, published, and drawn by the kiosk
# as the pipeline draws it. Cubes that are too small are refused with the cure.
set -u
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/closed
rm -rf "$work"
mkdir -p "$work/content"
build/gopura-content temple --triangles 20000 --out "$work/content/scan.ply" >"$work/log" 2>&1 || fail "no temple"
settings() {
	printf '%s\n' '[model]' 'name = Closed' 'scans = scan.ply' 'lit = yes' 'sun = 0.60 -0.58 0.55' 'colours = scan' \
		'[hierarchy]' 'surface = octree' "cell_mm = $1" '[grid]' 'points = 4' 'face_px = 256' \
		'[release]' 'publish_share = 1' >"$work/content/temple.ini"
}
build() { build/gopura-content build "$work/content" --out "$work/release" --keys "$work/keys" >"$work/log" 2>&1; }

settings 0.5
! build || fail "cubes of half a millimetre are not refused"
grep -q 'cell_mm = 0.5 makes over 65536 cubes.*write a larger one' "$work/log" || fail "half a millimetre: $(cat "$work/log")"
settings 600
build || fail "build: $(cat "$work/log")"
made=$(sed -nE 's/.*surface: ([0-9]+) triangles in ([0-9]+) closed parts of ([0-9]+) in ([0-9]+) shells.*/\1 \2 \3 \4/p' "$work/log")
read -r triangles parts before shells <<<"$made"
echo "$triangles triangles in $parts closed parts, of $before in $shells shells"
[ "${parts:-999}" -lt $((shells / 10)) ] || fail "the shells are not joined: $(cat "$work/log")"

sed -n '1p;26p' <(grep -v '^#' tests/bench/views.txt) >"$work/views.txt"
build/gopura-content render "$work/content" --views "$work/views.txt" --size 320x180 --supersample 2 --out "$work/truth" >/dev/null 2>&1 ||
	fail "render"
build/gopura-kiosk --display headless --size 320x180 --release "$work/release" --trust "$work/release/root/1.json" \
	--state "$work/state" --views "$work/views.txt" --capture "$work/pictures" 2>"$work/kiosk.log" || fail "kiosk: $(cat "$work/kiosk.log")"
build/tests/tools/compare_pictures "$work/truth" "$work/pictures" | tee "$work/compared"
tail -n 1 "$work/compared" | grep -qE '"psnr_db": (2[2-9]|[3-9][0-9])' || fail "the kiosk draws something else"
