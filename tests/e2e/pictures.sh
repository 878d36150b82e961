#!/bin/bash
# Compares the kiosk's settled pictures of the demo temple with the reference, through nginx, fetcher and cache: 16 of
# the first 40 views of the bench's path (VIEWS=N: N of them, spread over it; DEMO=build/demo SIZE=1280x720: the temple
# of make demo itself).
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/pictures size=${SIZE:-640x360}
rm -rf "$work/state" "$work/lumigraph" "$work/polygons"
mkdir -p "$work"
if [ -n "${DEMO:-}" ]; then demo=$DEMO; else demo_release; fi
grep -v '^#' tests/bench/views.txt | head -40 | awk -v n="${VIEWS:-16}" 'int(NR * n / 40) > int((NR - 1) * n / 40)' >"$work/views.txt"
build/gopura-content render "$demo/content" --views "$work/views.txt" --size "$size" \
	--supersample 4 --out "$work/truth"
serve "$demo/release" "$work/server"
for mode in lumigraph polygons; do
	rm -rf "$work/state"
	build/gopura-kiosk --display headless --size "$size" --mode "$mode" --release "$url" --ca "$ca" \
		--trust "$demo/release/root/1.json" --state "$work/state" \
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
assert images["psnr_db"] >= 28.2, f"mean {images['psnr_db']} dB"
assert images["psnr_worst5_db"] >= 25.6, f"worst {images['psnr_worst5_db']} dB"
assert images["psnr_db"] >= polygons["psnr_db"] + 6, "images are hardly better than polygons"
P
