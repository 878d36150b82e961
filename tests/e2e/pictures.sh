#!/bin/bash
# The kiosk's settled pictures against the reference, over the whole path: nginx, fetcher, cache.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/pictures
rm -rf "$work/state" "$work/kiosk"
mkdir -p "$work"
small_release
grep -v '^#' tests/bench/views.txt | awk 'NR % 4 == 1' >"$work/views.txt"
build/gopura-content render "$small/content" --views "$work/views.txt" --size 1280x720 \
	--supersample 2 --out "$work/truth"
serve "$small/release" "$work/server"
for mode in lumigraph polygons; do
	rm -rf "$work/state"
	build/gopura-kiosk --display headless --size 1280x720 --mode "$mode" --release "$url" --ca "$ca" \
		--trust "$small/release/root/1.json" --state "$work/state" \
		--views "$work/views.txt" --capture "$work/$mode" 2>"$work/$mode.log" ||
		{ tail -20 "$work/$mode.log"; fail "the kiosk ended with an error"; }
	build/tests/tools/compare_pictures "$work/truth" "$work/$mode" >"$work/$mode.jsonl"
	echo "$mode: $(tail -n 1 "$work/$mode.jsonl")"
	! grep -q '"settled": false' "$work/$mode/views.jsonl" || fail "a view did not settle"
done
python3 - "$work" <<'P'
import json
import sys

last = lambda mode: json.loads(open(f"{sys.argv[1]}/{mode}.jsonl").readlines()[-1])
images, polygons = last("lumigraph"), last("polygons")
# A guard against getting worse, a little below what was measured (docs/figures.md); the goal for the
# whole demo temple is 30 dB in the mean and 26 in the worst 5 %.
assert images["psnr_db"] >= 25.2, f"mean {images['psnr_db']} dB"
assert images["psnr_worst5_db"] >= 22.5, f"worst {images['psnr_worst5_db']} dB"
assert images["psnr_db"] >= polygons["psnr_db"] + 1.5, "images are hardly better than polygons"
P
