#!/bin/bash
# A textured pillar that leans is made upright by a JSON file, published and drawn by the kiosk. Its picture is that of a
# pillar which never leaned, textures included.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/deform
rm -rf "$work"

# content NAME LEAN: a content folder with a pillar.
content() {
	mkdir -p "$work/$1"
	python3 tests/tools/leaning_pillar.py "$work/$1" "$2"
	printf '[model]\nname = %s\nscans = pillar.obj\n[grid]\npoints = 6\nface_px = 256\n' "$1" >"$work/$1/temple.ini"
}
content upright 0
content leaning 0.2
mkdir "$work/bent"
cp "$work/leaning/temple.ini" "$work/bent/"

# The control points k metres above the foot go back by what the pillar leans there.
awk 'BEGIN {
	printf "{\"steps\": [{\"lattice\": [1, 1, 4], \"box\": {\"low\": [-2, -2, 0], \"high\": [2, 2, 4]}, \"moves\": ["
	for (k = -1; k <= 5; k++)
		printf("%s\n{\"points\": [\"all\", \"all\", %d], \"by\": [%.1f, 0, 0]}", (k > -1) ? "," : "", k, -0.2 * k)
	print "]}]}"
}' >"$work/upright.json"
build/gopura-content deform --with "$work/upright.json" --out "$work/bent/pillar.obj" "$work/leaning/pillar.obj" |
	tee "$work/report"
grep -q 'around a vertex, space grew 1 to 1 times' "$work/report" || fail "leaning changed the volume"
grep -q "^map_Kd pillar-[0-9]*.png" "$work/bent/pillar.mtl" || fail "the texture did not go along"
# The same into a PLY says what it leaves out.
build/gopura-content deform --with "$work/upright.json" --out "$work/bent.ply" "$work/leaning/pillar.obj" \
	2>"$work/said" >/dev/null
grep -q 'bent.ply: a PLY has colours at its vertices instead of the 1 textures' "$work/said" || fail "the lost texture was not named"

build/gopura-content build "$work/bent" --out "$work/release" --keys "$work/keys" >"$work/build.log" 2>&1 ||
	{ tail -5 "$work/build.log"; fail "the upright pillar was not built"; }
printf '%s\n' '0 -9 4 0 0 2 45' '6 -6 3 0 0 2 45' >"$work/views"
for name in upright leaning; do
	build/gopura-content render "$work/$name" --views "$work/views" --size 480x270 --supersample 2 \
		--out "$work/$name-drawn" >/dev/null
done
build/gopura-kiosk --display headless --size 480x270 --release "$work/release" --trust "$work/release/root/1.json" \
	--state "$work/state" --views "$work/views" --capture "$work/drawn" 2>"$work/kiosk.log" ||
	{ tail -20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }

# psnr NAME: how near the kiosk's pictures are to those of a pillar, in dB.
psnr() {
	build/tests/tools/compare_pictures "$work/$1-drawn" "$work/drawn" |
		python3 -c 'import json, sys; print(json.loads(sys.stdin.readlines()[-1])["psnr_db"])'
}
upright=$(psnr upright)
leaning=$(psnr leaning)
echo "the pillar as drawn: $upright dB from the upright one, $leaning dB from the leaning one"
python3 -c 'import sys; sys.exit(not (float(sys.argv[1]) > 22 and float(sys.argv[1]) > float(sys.argv[2]) + 5))' \
	"$upright" "$leaning" || fail "what was drawn is not the upright pillar"
