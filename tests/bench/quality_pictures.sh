#!/bin/bash
# By make bench-full, most of an hour: the kiosk's settled pictures of releases of the same bytes, whose tiles have their
# qualities by the rules uniform and gain (docs/quality.md).
#
#   SCANS="temple venus"     these alone, of temple, nefertiti, venus and zeus
#
# 4 points along the longest side, faces of 1008 px; 24 views of 960 x 540 against the ray-cast truth. Budgets are what a
# release takes with all tiles at quality 40, at 60 and at 80, and for uniform half-way from there to 95, and at 95. What
# was built stays in build/bench/quality_pictures; build/bench/quality_pictures.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" all build/tests/bench/bench_choice build/tests/bench/bench_view \
	build/tests/tools/compare_pictures >/dev/null
work=build/bench/quality_pictures scans=../shared/scans
mkdir -p "$work"

# folder SCAN LINE...: a content folder of it
folder() {
	mkdir -p "$work/$1/content"
	printf '%s\n' '[model]' "name = $1" "${@:2}" '[grid]' 'points = 4' 'face_px = 1024' 'effort = quick' \
		'[samples]' 'quality = gain' >"$work/$1/content/temple.ini"
}

content_temple() {
	folder temple 'scans = scan.ply' 'colours = procedural' 'lit = yes' 'sun = 0.60 -0.58 0.55'
	[ -f "$work/temple/content/scan.ply" ] ||
		build/gopura-content temple --triangles 300000 --seed 1 --out "$work/temple/content/scan.ply" >&2
}

content_nefertiti() {
	folder nefertiti 'scans = nefertiti-lowres.obj' 'up = y' 'unit = mm'
	cp -p --remove-destination "$scans"/nefertiti/*.obj "$work/nefertiti/content/"
}

content_venus() {
	folder venus 'scans = venus.obj' 'up = y' 'unit = 0.1'
	cp -p --remove-destination "$scans"/venus-cc0-textured/decoded/* "$work/venus/content/"
}

content_zeus() {
	folder zeus 'scans = koepfchenzeus.obj' 'up = y' 'unit = mm'
	cp -p --remove-destination "$scans"/bust-zeus-head/*.{obj,mtl,jpg} "$work/zeus/content/"
}

# build_release SCAN RULE BUDGET
build_release() {
	sed -i "s/^quality = .*/quality = $2/" "$work/$1/content/temple.ini"
	rm -rf "${work:?}/$1/release"
	build/gopura-content build "$work/$1/content" --out "$work/$1/release" --keys "$work/$1/keys" --budget "$3" \
		>"$work/$1/build.txt" 2>&1 || { cat "$work/$1/build.txt" >&2; return 1; }
}

bytes_of() { cat "$work/$1"/release/packs/* | wc -c; }

# views SCAN: 24 of 60
views() {
	if [ "$1" = temple ]; then
		grep -v '^#' tests/bench/path.txt
	else
		# shellcheck disable=SC2046
		python3 tests/bench/around.py $(build/gopura-content inspect "$work/$1/release" |
			awk '$1 == "box" { print $3, $4, $5 }')
	fi | awk 'NR % 5 == 2 || NR % 5 == 0'
}

# draw SCAN RUN [OPTION...]: settled pictures of the release
draw() {
	local out=$work/$1/runs/$2
	mkdir -p "$out"
	build/tests/bench/bench_view "$work/$1/release" "$work/$1/views.txt" "$out" --size 960x540 "${@:3}" >&2
	build/tests/tools/compare_pictures "$work/$1/truth" "$out" >"$out/pictures.jsonl"
	rm "$out"/*.png
	bytes_of "$1" >"$out/bytes"
}

# budgets SCAN MOST SHARE...: of the release with all tiles at the qualities 20, 40 ... (0, 100 ...) and between them
budgets() {
	python3 - "$work/$1/tiles.json" "${@:2}" <<'P'
import json
import sys

tiles = json.load(open(sys.argv[1]))["tile_bytes"]
for share in map(int, sys.argv[3:]):
    low, part = tiles[share // 100], share % 100 / 100
    print(share, round(int(sys.argv[2]) - tiles[-1] + low + part * (tiles[min(share // 100 + 1, 4)] - low)))
P
}

compare_pictures_of() {
	local share budget most
	"content_$1"
	rm -rf "${work:?}/$1/runs" "$work/$1"/shown-*
	build_release "$1" gain 1GB
	most=$(bytes_of "$1")
	views "$1" >"$work/$1/views.txt"
	build/gopura-content render "$work/$1/content" --views "$work/$1/views.txt" --size 960x540 --supersample 3 \
		--out "$work/$1/truth" >&2
	draw "$1" uniform-400 --shown "$work/$1/shown"
	build/tests/bench/bench_choice "$work/$1/content" "$work/$1"/shown-* >"$work/$1/tiles.json"
	budgets "$1" "$most" 100 200 300 350 | while read -r share budget; do
		for rule in uniform gain; do
			[ "$share-$rule" = 350-gain ] && continue
			build_release "$1" "$rule" "${budget}B"
			draw "$1" "$rule-$share"
		done
	done
}

names=
for name in ${SCANS:-temple nefertiti venus zeus}; do
	[ "$name" = temple ] || [ -d "$scans" ] || { echo "skipped: $name, no $scans" >&2; continue; }
	compare_pictures_of "$name"
	names="$names $name"
done
# shellcheck disable=SC2086
python3 tests/bench/quality_rows.py "$work" $names >build/bench/quality_pictures.json
