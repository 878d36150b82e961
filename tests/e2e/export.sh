#!/bin/bash
# A textured scan becomes one GLB file of so many bytes, which is what a IIIF manifest shows in place of the scan. Read
# back as a scan, it looks like the scan it was made of, and more so with more bytes.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/export
rm -rf "$work"
mkdir -p "$work/scan" "$work/web"
python3 tests/tools/leaning_pillar.py "$work/scan" 0
printf '[model]\nname = pillar\nscans = pillar.obj\n' >"$work/scan/temple.ini"
printf '{"parts": [{"id": "foot", "anchor": [0, -1, 0.2], "page": false, "title": {"en": "The foot"}}]}\n' \
	>"$work/scan/parts.json"
printf '%s\n' '0 -9 4 0 0 2 45' '6 -6 3 0 0 2 45' >"$work/views"

# draw FOLDER: its pictures go to FOLDER/drawn.
draw() {
	build/gopura-content render "$1" --views "$work/views" --size 480x270 --supersample 2 --out "$1/drawn" >/dev/null
}
draw "$work/scan"

# psnr BYTES: how near the model of so many bytes is to the scan, in dB.
psnr() {
	local folder=$work/of-$1
	mkdir -p "$folder"
	build/gopura-content export "$work/scan" --budget "$1B" --out "$folder/pillar.glb" >"$folder/said" ||
		fail "no model of $1 bytes"
	[ "$(stat -c %s "$folder/pillar.glb")" -le "$1" ] || fail "the model takes more than $1 bytes"
	printf '[model]\nname = pillar\nscans = pillar.glb\nup = y\n' >"$folder/temple.ini"
	draw "$folder"
	build/tests/tools/compare_pictures "$work/scan/drawn" "$folder/drawn" |
		python3 -c 'import json, sys; print(json.loads(sys.stdin.readlines()[-1])["psnr_db"])'
}
small=$(psnr 20000)
large=$(psnr 100000)
echo "20 kB: $small dB, 100 kB: $large dB"
python3 -c 'import sys; sys.exit(not float(sys.argv[2]) > max(26, float(sys.argv[1]) + 1))' "$small" "$large" ||
	fail "the models do not look like the scan"

# A closed surface of it has the colours of the picture, which hold their light, as the release has.
mkdir "$work/closed"
cp "$work/scan/"pillar.* "$work/closed/"
printf '%s\n' '[model]' 'name = pillar' 'scans = pillar.obj' '[hierarchy]' 'surface = octree' 'cell_mm = 100' \
	>"$work/closed/temple.ini"
build/gopura-content export "$work/closed" --budget 100kB --out "$work/closed.glb" >/dev/null || fail "no closed model"
grep -q KHR_materials_unlit "$work/closed.glb" || fail "the colours of a picture are lit once more"

# Of marble: no picture, but the colours of the stone.
mkdir "$work/marble"
cp "$work/scan/"pillar.* "$work/marble/"
printf '%s\n' '[model]' 'name = pillar' 'scans = pillar.obj' 'colours = marble' >"$work/marble/temple.ini"
build/gopura-content export "$work/marble" --budget 100kB --out "$work/marble.glb" >/dev/null || fail "no marble"
grep -q COLOR_0 "$work/marble.glb" && ! grep -q -e image/jpeg -e KHR_materials_unlit "$work/marble.glb" ||
	fail "the model of marble shows the scan's picture"

# The manifest of a web page, and back.
cp "$work/of-100000/pillar.glb" "$work/web/"
build/gopura-content annotations export "$work/scan" --iiif --model pillar.glb --base https://museum.example/pillar \
	--out "$work/web/scene.json" >/dev/null
grep -q '"https://museum.example/pillar/pillar.glb"' "$work/web/scene.json" || fail "the manifest does not show the model"
mkdir "$work/back"
cp "$work/web/"* "$work/back/"
printf '[model]\nname = pillar\nscans = scene.json\nup = y\n' >"$work/back/temple.ini"
draw "$work/back"
build/tests/tools/compare_pictures "$work/of-100000/drawn" "$work/back/drawn" | tail -1 >"$work/same"
python3 -c 'import json, sys; sys.exit(not json.load(sys.stdin)["psnr_db"] > 60)' <"$work/same" ||
	fail "through the manifest the model stands elsewhere: $(cat "$work/same")"

# refused ARGUMENTS... : must be refused with the words in $words.
refused() {
	local rc=0
	build/gopura-content export "$@" >"$work/said" 2>&1 || rc=$?
	[ "$rc" -gt 0 ] && grep -q -- "$words" "$work/said" || { cat "$work/said"; fail "export $*: not refused with '$words'"; }
}
words='--budget must be 10kB to 1GB' refused "$work/scan" --out a.glb --budget 9kB
words='give --out FILE.glb, not a.obj' refused "$work/scan" --out a.obj
words='name one content folder' refused --out a.glb
words='is the disk full, or the folder missing' refused "$work/scan" --out "$work/none/a.glb"
words='no/temple.ini' refused "$work/no" --out a.glb
