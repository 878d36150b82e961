#!/bin/bash
# Settled pictures against the truth, and what they cost: views of an orbit, nearer ones and
# close-ups, none on a sampling point, 1280 x 720, from an empty cache, in the three modes, fetched from
# the museum server: bytes are all that its connections brought.
#
#   ROWS="demo venus-70"  these rows alone
#   VIEWS=N            of each row, spread over its path (default 6: all rows in half an hour once they are built)
#   SUPERSAMPLE=N      of the truth (default 4: 16 samples a pixel)
#
# Rows, with VIEWS=60 of 60 views each: temple-300 and temple-100 (5 M triangles, colours of vertices, a tenth of it
# published; so many KB a view by the price of a kilobyte), temple-open-300 (all of it published), fine-250 (colours
# finer than vertices), venus-70 and zeus-70 (real scans, textured); demo (2 M triangles, colours finer
# than vertices) has the 40 farther apart of tests/e2e/pictures.sh.
# What is built stays in build/bench/view; build/bench/view.json has a row for each, and what the
# benchmarks frame, motion, visit, footprint and start left; first_picture_bytes_30db is that of the view with which a
# visit to the 5 M temple begins, over 10 Mbit/s and 40 ms.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib-server.sh
trap stop_server EXIT
work=build/bench/view scans=../shared/scans
visitor="orbit=20 walk=20 close=20"
mkdir -p "$work"
make --no-print-directory benches tests >/dev/null

# spread: of the views that come in, VIEWS
spread() {
	awk -v n="${VIEWS:-6}" '!/^#/ { line[++count] = $0 }
		END { for (i = 1; i <= count; i++)
			if (n >= count || int(i * n / count) > int((i - 1) * n / count)) print line[i] }'
}

# folder NAME LINE...: a content folder with that temple.ini; equal text keeps what was built.
folder() {
	mkdir -p "$work/$1/content"
	printf '%s\n' '[model]' "name = $1" "${@:2}" >"$work/temple.ini"
	cmp -s "$work/temple.ini" "$work/$1/content/temple.ini" || cp "$work/temple.ini" "$work/$1/content/"
}

# around RELEASE: views by the box of the model
around() {
	# shellcheck disable=SC2046
	python3 tests/bench/around.py $(build/gopura-content inspect "$1" | awk '$1 == "box" { print $3, $4, $5 }')
}

# draw NAME CONTENT RELEASE THRIFT CLASSES <PATH: truth, pictures, and how near they come.
# CLASSES: name=views of the path's parts, in order
draw() {
	local out=$work/$1 truth=${2%/content}/truth mode
	mkdir -p "$out"
	spread >"$out/views.txt"
	echo "$5" >"$out/classes"
	# Nobody waits for a frame, only until it is settled.
	printf '[render]\nprice_px_per_kb = %s\nupload_us = 100000\n' "$4" >"$out/board.ini"
	build/gopura-content render "$2" --views "$out/views.txt" --size 1280x720 \
		--supersample "${SUPERSAMPLE:-4}" --out "$truth" >&2
	# Those of a longer path before are of no use, and would be missed below.
	find "$truth/" -name 'view-*' | sort | awk -F'view-' -v n="$(wc -l <"$out/views.txt")" '$NF + 0 >= n' | xargs -r rm
	start_server "$3" "$out/server"
	for mode in lumigraph polygons corners; do
		rm -rf "${out:?}/$mode" "$out/state"
		build/gopura-kiosk --display headless --size 1280x720 --mode "$mode" --release "$server_url" \
			--ca "$server_ca" --trust "$3/root/1.json" --state "$out/state" --board "$out/board.ini" \
			--views "$out/views.txt" --capture "$out/$mode" 2>"$out/$mode.log"
		build/tests/tools/compare_pictures "$truth" "$out/$mode" >"$out/$mode.jsonl"
	done
	stop_server
	rm -rf "$out/state"
}

row_demo() {
	demo/prepare.sh >&2
	mkdir -p "$work/demo"
	ln -sfn "$PWD/build/demo/content" "$work/demo/content"
	grep -v '^#' tests/bench/views.txt | head -40 | draw demo "$work/demo/content" build/demo/release 0 "orbit=20 walk=12 close=8"
}

# temple NAME QUALITY LINE...: a content folder of the temple of 5 M triangles
temple() {
	folder "$1" 'scans = scan.ply' 'lit = yes' 'sun = 0.60 -0.58 0.55' "${@:3}" '[grid]' \
		'points = 8' 'face_px = 2048' "quality = $2"
	[ -f "$work/temple.ply" ] ||
		build/gopura-content temple --triangles 5000000 --out "$work/temple.ply" >&2
	ln -f "$work/temple.ply" "$work/$1/content/scan.ply"
}

build_temple() {
	temple temple 93 'colours = scan'
	build/gopura-content build "$work/temple/content" --out "$work/temple/release" --keys "$work/temple/keys" >&2
}

row_temple_300() {
	build_temple
	draw temple-300 "$work/temple/content" "$work/temple/release" 0.8 "$visitor" <tests/bench/path.txt
	# Of the view with which a visit begins: bytes until it has 30 dB, on the bench's clock.
	build/gopura-content inspect "$work/temple/release" |
		awk '$1 == "start" { at = at $3 " " $4 " " $5 " " } END { print at 45 }' >"$work/first.txt"
	build/gopura-content render "$work/temple/content" --views "$work/first.txt" --size 1280x720 \
		--supersample "${SUPERSAMPLE:-4}" --out "$work/temple/first" >&2
	build/tests/bench/bench_first "$work/temple/release" "$work/first.txt" "$work/temple/first" --size 1280x720 \
		--kbit 10000 --rtt 40 --stream yes --most 5 | tail -n 1 >"$work/first-30db"
}

# The same scan in fewer bytes: what is fetched seldom need not be told so exactly.
row_temple_100() {
	temple temple-84 84 'colours = scan'
	build/gopura-content build "$work/temple-84/content" --out "$work/temple-84/release" --keys "$work/temple-84/keys" >&2
	ln -sfn ../temple/truth "$work/temple-84/truth"
	draw temple-100 "$work/temple-84/content" "$work/temple-84/release" 57 "$visitor" <tests/bench/path.txt
}

# The same hierarchy and samples, all of it published.
row_temple_open_300() {
	local open=$work/temple-open
	build_temple
	mkdir -p "$open"
	rm -rf "$open/content"
	cp -rl "$work/temple/content" "$open/content"
	cp --remove-destination "$work/temple/content/temple.ini" "$open/content/"
	printf '%s\n' '[release]' 'publish_share = 1' >>"$open/content/temple.ini"
	build/gopura-content publish "$open/content" --out "$open/release" --keys "$work/temple/keys" >&2
	ln -sfn ../temple/truth "$open/truth"
	draw temple-open-300 "$open/content" "$open/release" 6 "$visitor" <tests/bench/path.txt
}

row_fine_250() {
	temple fine 84 'colours = procedural'
	build/gopura-content build "$work/fine/content" --out "$work/fine/release" --keys "$work/fine/keys" >&2
	draw fine-250 "$work/fine/content" "$work/fine/release" 4 "$visitor" <tests/bench/path.txt
}

# scan NAME FILES LINE...: a real scan; skipped where it is not at hand
scan() {
	local file
	[ -d "$scans" ] || { echo "skipped: $1, no $scans" >&2; return; }
	folder "$1" "${@:3}"
	for file in $2; do cp -p --remove-destination "$file" "$work/$1/content/"; done
	build/gopura-content build "$work/$1/content" --out "$work/$1/release" --keys "$work/$1/keys" >&2
	around "$work/$1/release" | draw "$1-70" "$work/$1/content" "$work/$1/release" 0 \
		"orbit=24 nearer=20 close=16"
}

row_venus_70() {
	scan venus "$scans/venus-cc0-textured/decoded/*" 'scans = venus.obj' 'up = y' 'unit = 0.1' '[grid]' 'face_px = 2048'
}

row_zeus_70() {
	scan zeus "$scans/bust-zeus-head/*.obj $scans/bust-zeus-head/*.mtl $scans/bust-zeus-head/*.jpg" \
		'scans = koepfchenzeus.obj' 'up = y' 'unit = mm' '[grid]' 'face_px = 2048'
}

rows=${ROWS:-temple-300 temple-100 temple-open-300 fine-250 venus-70 zeus-70 demo}
for row in $rows; do
	echo "-- $row" >&2
	rm -f "$work/$row/lumigraph.jsonl"
	"row_${row//-/_}"
done
# shellcheck disable=SC2086
python3 tests/bench/view_rows.py "$work" $rows >build/bench/view.json
