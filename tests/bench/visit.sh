#!/bin/bash
# By make bench-full: a visit at its own speed with the governor in control, 1920 x 1080, on the temple
# of 1 and 5 million triangles: what frames take, which level they are drawn at, and what the pictures on
# the panel are worth; once undisturbed, and on the first temple with a core taken away for ten
# seconds and with a clock that falls by a third. build/bench/visit.json; frame times over the visits
# as pictures in build/bench/visit/*.svg.
#
#   SIZES="1 5"  of these millions alone; the others' rows are those measured before
#
# Scans, samples, releases and true pictures stay in build/bench/visit.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/visit visit=tests/bench/visit.txt
make --no-print-directory all benches >/dev/null

build() {
	local content=$work/$1/content
	mkdir -p "$content"
	printf '%s\n' '[model]' 'name = visit' 'scans = scan.ply' 'lit = yes' 'sun = 0.60 -0.58 0.55' \
		'colours = scan' '[grid]' 'points = 8' 'face_px = 2048' 'quality = 93' >"$work/temple.ini"
	cmp -s "$work/temple.ini" "$content/temple.ini" || cp "$work/temple.ini" "$content/"
	if [ ! -f "$content/scan.ply" ]; then
		build/gopura-content temple --triangles "${1}000000" --out "$work/scan.part" >&2
		mv "$work/scan.part" "$content/scan.ply"
	fi
	build/gopura-content build "$content" --out "$work/$1/release" --keys "$work/$1/keys" >&2
}

# play SIZE LOAD
play() {
	local at=$work/$1
	build/tests/bench/bench_visit "$at/release" "$visit" "$at/$2" --truth "$at/truth" --load "$2"
}

for size in ${SIZES:-1 5}; do
	echo "-- $size million triangles" >&2
	build "$size"
	build/tests/bench/bench_visit "$work/$size/release" "$visit" "$work/$size"
	build/gopura-content render "$work/$size/content" --views "$work/$size/views.txt" \
		--size 1920x1080 --supersample 4 --out "$work/$size/truth" >&2
	play "$size" none
	[ "$size" != 1 ] || for load in core heat; do play 1 "$load"; done
done
python3 tests/bench/visit_rows.py "$work" >build/bench/visit.json
