#!/bin/bash
# Compares the kiosk's settled pictures with the reference, through nginx, fetcher and cache: 8 of the first 40 views of the
# bench's path around the small temple. "all" (make pictures): 16 views of the half-size demo temple, with as many images
# as a museum has (DEMO=build/demo SIZE=1280x720: the temple of make demo itself). VIEWS=N: N views, spread over the 40.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/pictures size=${SIZE:-640x360}
rm -rf "$work"
mkdir -p "$work"
# 1.3 dB below what was measured; of what images add, 0.9 (0.7 for the small temple).
views=16 least=(28.2 25.6 6)
if [ -n "${DEMO:-}" ]; then
	demo=$DEMO
elif [ "${1:-}" = all ]; then
	demo_release
else
	demo=$small views=8 least=(26.9 25.6 3.2)
	small_release
fi
grep -v '^#' tests/bench/views.txt | head -40 | awk -v n="${VIEWS:-$views}" 'int(NR * n / 40) > int((NR - 1) * n / 40)' >"$work/views.txt"
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
python3 - "$work" "${least[@]}" <<'P'
import json
import sys

last = lambda mode: json.loads(open(f"{sys.argv[1]}/{mode}.jsonl").readlines()[-1])
images, polygons = last("lumigraph"), last("polygons")
mean, worst, gain = map(float, sys.argv[2:])
assert images["psnr_db"] >= mean, f"mean {images['psnr_db']} dB"
assert images["psnr_worst5_db"] >= worst, f"worst {images['psnr_worst5_db']} dB"
assert images["psnr_db"] >= polygons["psnr_db"] + gain, "images are hardly better than polygons"
P
