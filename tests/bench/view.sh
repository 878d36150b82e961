#!/bin/bash
# Settled pictures against the truth, and what they cost: views of an orbit, nearer ones and
# close-ups, none on a sampling point, 1280 x 720, from an empty cache, in the three modes.
#
#   ROWS="demo venus-70"  these rows alone          VIEWS=N  of each row, spread over its path
#   SUPERSAMPLE=N      of the truth (default 4: 16 samples a pixel)
#
# Rows: demo (2 M triangles, colours finer than vertices; 40 views, those of tests/e2e/pictures.sh);
# of 60 views each: temple-300 and temple-100 (5 M triangles, colours of vertices, a tenth of it
# published; so many KB a view by thrift), temple-open-300 (all of it published), fine-250 (colours
# finer than vertices), venus-70 and zeus-70 (real scans, textured).
# What is built stays in build/bench/view; build/bench/view.json has a row for each.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/view scans=../shared/scans
mkdir -p "$work"

# spread: of the views that come in, VIEWS
spread() {
	awk -v n="${VIEWS:-1000}" '!/^#/ { line[++count] = $0 }
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

# draw NAME CONTENT RELEASE THRIFT <PATH: truth, pictures, and how near they come
draw() {
	local out=$work/$1 truth=${2%/content}/truth mode
	mkdir -p "$out"
	spread >"$out/views.txt"
	printf '[render]\nthrift = %s\n' "$4" >"$out/board.ini"
	build/gopura-content render "$2" --views "$out/views.txt" --size 1280x720 \
		--supersample "${SUPERSAMPLE:-4}" --out "$truth" >&2
	for mode in lumigraph polygons corners; do
		rm -rf "${out:?}/$mode" "$out/state"
		build/gopura-kiosk --display headless --size 1280x720 --mode "$mode" --release "$3" \
			--trust "$3/root/1.json" --state "$out/state" --board "$out/board.ini" \
			--views "$out/views.txt" --capture "$out/$mode" 2>"$out/$mode.log"
		build/tests/tools/compare_pictures "$truth" "$out/$mode" >"$out/$mode.jsonl"
	done
	rm -rf "$out/state"
}

row_demo() {
	demo/prepare.sh >&2
	mkdir -p "$work/demo"
	ln -sfn "$PWD/build/demo/content" "$work/demo/content"
	grep -v '^#' tests/bench/views.txt | head -40 | draw demo "$work/demo/content" build/demo/release 0
}

# temple NAME LINE...: a content folder of the temple of 5 M triangles
temple() {
	folder "$1" 'scans = scan.ply' 'lit = yes' 'sun = 0.60 -0.58 0.55' "${@:2}" '[grid]' \
		'points = 8' 'face_px = 2048' 'quality = 80'
	[ -f "$work/temple.ply" ] ||
		build/gopura-content temple --triangles 5000000 --out "$work/temple.ply" >&2
	ln -f "$work/temple.ply" "$work/$1/content/scan.ply"
}

build_temple() {
	temple temple 'colours = scan'
	build/gopura-content build "$work/temple/content" --out "$work/temple/release" >&2
}

row_temple_300() {
	build_temple
	draw temple-300 "$work/temple/content" "$work/temple/release" 2 <tests/bench/views.txt
}

row_temple_100() {
	build_temple
	draw temple-100 "$work/temple/content" "$work/temple/release" 15 <tests/bench/views.txt
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
	build/gopura-content publish "$open/content" --out "$open/release" >&2
	ln -sfn ../temple/truth "$open/truth"
	draw temple-open-300 "$open/content" "$open/release" 1 <tests/bench/views.txt
}

row_fine_250() {
	temple fine 'colours = procedural'
	build/gopura-content build "$work/fine/content" --out "$work/fine/release" >&2
	draw fine-250 "$work/fine/content" "$work/fine/release" 1 <tests/bench/views.txt
}

# scan NAME FILES LINE...: a real scan; skipped where it is not at hand
scan() {
	local file
	[ -d "$scans" ] || { echo "skipped: $1, no $scans" >&2; return; }
	folder "$1" "${@:3}"
	for file in $2; do ln -sf "$(realpath "$file")" "$work/$1/content/"; done
	build/gopura-content build "$work/$1/content" --out "$work/$1/release" >&2
	around "$work/$1/release" | draw "$1-70" "$work/$1/content" "$work/$1/release" 0
}

row_venus_70() {
	scan venus "$scans/venus-cc0-textured/decoded/*" 'scans = venus.obj' 'up = y' 'unit = 0.1' '[grid]' 'face_px = 2048'
}

row_zeus_70() {
	scan zeus "$scans/bust-zeus-head/*.obj $scans/bust-zeus-head/*.mtl $scans/bust-zeus-head/*.jpg" \
		'scans = koepfchenzeus.obj' 'up = y' 'unit = mm' '[grid]' 'face_px = 2048'
}

rows=${ROWS:-demo temple-300 temple-100 temple-open-300 fine-250 venus-70 zeus-70}
for row in $rows; do
	echo "-- $row" >&2
	rm -f "$work/$row/lumigraph.jsonl"
	"row_${row//-/_}"
done
# shellcheck disable=SC2086
python3 - "$work" $rows >build/bench/view.json <<'P'
import json
import os
import sys

work, rows = sys.argv[1], []


def last(row, mode):
    return json.loads(open(f"{work}/{row}/{mode}.jsonl").readlines()[-1])


def kb(views):
    return round(sum(v["bytes_fetched"] for v in views) / 1000 / len(views), 1)


for name in sys.argv[2:]:
    if not os.path.exists(f"{work}/{name}/lumigraph.jsonl"):
        continue
    of = {m: [json.loads(line) for line in open(f"{work}/{name}/{m}/views.jsonl")]
          for m in ("lumigraph", "polygons", "corners")}
    views, quality = of["lumigraph"], last(name, "lumigraph")
    orbit = views[: max(1, len(views) // 3)]
    middle = lambda key: sorted(v[key] for v in views)[len(views) // 2]
    row = {
        "name": name, "views": len(views), "kb_per_view": kb(views),
        "first_view_kb": kb(views[:1]),
        "psnr_db": quality["psnr_db"], "psnr_worst5_db": quality["psnr_worst5_db"], "ssim": quality["ssim"],
        "image_share": round(sum(v["image_share"] for v in views) / len(views), 3),
        "image_share_orbit": round(sum(v["image_share"] for v in orbit) / len(orbit), 3),
        "settled_ms": middle("settled_ms"), "all_settled": all(v["settled"] for m in of.values() for v in m),
    }
    for mode in ("polygons", "corners"):
        other = last(name, mode)
        row |= {f"{mode}_psnr_db": other["psnr_db"], f"{mode}_psnr_worst5_db": other["psnr_worst5_db"],
                f"{mode}_ssim": other["ssim"], f"{mode}_kb_per_view": kb(of[mode])}
    rows.append(row)
print(json.dumps({"rows": rows}, indent=1))
P
