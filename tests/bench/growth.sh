#!/bin/bash
# By make bench-full: what a larger scan costs the kiosk. The temple of 1, 6 and 18 million triangles,
# a tenth of each published, everything else alike: bytes, frames, memory. build/bench/growth.json.
#
#   SIZES="1 6 18 18s" of these millions alone; the others' rows are those measured before. 18s: the 18
#                      million again, of which as many triangles are published as of 6
#   VIEWS=N            every N-th of tests/bench/path.txt (default 5)
#
# Faces have 1024 px, to save time, and the price of a kilobyte is 0.5 pixels at every size: the question is how figures grow.
# Scans, hierarchies, samples, releases and true pictures stay in build/bench/growth, so a run that was
# cut short goes on where it was; figures are measured anew. 18 M takes 0.9 GB of the disk.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/growth price=0.5
make --no-print-directory -j"$(nproc)" all benches >/dev/null
mkdir -p "$work"

# views NAME EVERY: of the visitor's way
views() {
	grep -v '^#' tests/bench/path.txt | awk -v n="$2" '(NR - 1) % n == 0' >"$work/$1.txt"
}

# build SIZE: the temple's release; what is there already stays.
build() {
	local content=$work/$1/content
	mkdir -p "$content"
	printf '%s\n' '[model]' 'name = growth' 'scans = scan.ply' 'lit = yes' 'sun = 0.60 -0.58 0.55' \
		'colours = scan' '[grid]' 'points = 8' 'face_px = 1024' 'quality = 80' >"$work/temple.ini"
	cmp -s "$work/temple.ini" "$content/temple.ini" || cp "$work/temple.ini" "$content/"
	if [ ! -f "$content/scan.ply" ]; then
		build/gopura-content temple --triangles "${1}000000" --out "$work/scan.part" >&2
		mv "$work/scan.part" "$content/scan.ply"
	fi
	build/gopura-content build "$content" --out "$work/$1/release" --keys "$work/$1/keys" >&2
	build/gopura-content inspect "$work/$1/release" >"$work/$1/inspect"
}

# build_18s: the hierarchy and samples of 18 are its own, and the truth is.
build_18s() {
	build 18
	mkdir -p "$work/18s"
	rm -rf "$work/18s/content"
	cp -rl "$work/18/content" "$work/18s/content"
	cp --remove-destination "$work/18/content/temple.ini" "$work/18s/content/"
	printf '%s\n' '[release]' 'publish_share = 0.0333' >>"$work/18s/content/temple.ini"
	build/gopura-content publish "$work/18s/content" --out "$work/18s/release" --keys "$work/18/keys" >&2
	build/gopura-content inspect "$work/18s/release" >"$work/18s/inspect"
	ln -sfn ../18/truth "$work/18s/truth"
}

# measure SIZE: each figure into a file of its own
measure() {
	local at=$work/$1
	build/gopura-content render "$at/content" --views "$work/views.txt" --size 1280x720 \
		--supersample 4 --out "$at/truth" >&2
	build/tests/bench/bench_view "$at/release" "$work/views.txt" "$at/views" --truth "$at/truth" \
		--price "$price" >&2
	# Not limited by the line, like the paper's: what the visit asks for.
	build/tests/bench/bench_motion "$at/release" tests/bench/visit.txt "$at/visit" --fault none \
		--price "$price" --link 1000
	build/tests/bench/bench_frame "$at/release" "$work/frames.txt" 15 frames >"$at/frame.json"
	rm -rf "$at/rest"
	mkdir -p "$at/rest"
	python3 tests/bench/footprint.py "$at/rest" "$at/release" "$work/board.ini" >"$at/rest.json"
	rm -rf "$at/rest"
}

views views "${VIEWS:-5}"
views frames 20 # one of each kind
printf '%s\n' '[render]' 'texture_mib = 32' "price_px_per_kb = $price" >"$work/board.ini"
for size in ${SIZES:-1 6 18 18s}; do
	echo "-- $size million triangles" >&2
	case $size in 18s) build_18s ;; *) build "$size" ;; esac
	measure "$size"
done
python3 tests/bench/growth_rows.py "$work" 1 6 18 18s >build/bench/growth.json
