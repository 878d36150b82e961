#!/bin/bash
# Pictures of the demo temple against the truth, and what they cost: 40 views (an orbit, a walk,
# close-ups; none on a sampling point), 1280 x 720, from an empty cache, in the three modes.
#
#   VIEWS=N   N of them, spread over the path     SUPERSAMPLE=N  of the truth (default 4: 16 samples a pixel)
set -eu
cd "$(dirname "$0")/../.."
demo=build/demo work=build/bench/view
mkdir -p "$work"
demo/prepare.sh
grep -v '^#' tests/bench/views.txt | awk -v n="${VIEWS:-40}" 'int(NR * n / 40) > int((NR - 1) * n / 40)' >"$work/views.txt"
build/gopura-content render "$demo/content" --views "$work/views.txt" --size 1280x720 \
	--supersample "${SUPERSAMPLE:-4}" --out "$work/truth"

for mode in lumigraph polygons corners; do
	rm -rf "$work/$mode" "$work/state-$mode"
	build/gopura-kiosk --display headless --size 1280x720 --mode "$mode" --release "$demo/release" \
		--trust "$demo/release/root/1.json" --state "$work/state-$mode" \
		--views "$work/views.txt" --capture "$work/$mode" 2>"$work/$mode.log"
	build/tests/tools/compare_pictures "$work/truth" "$work/$mode" >"$work/$mode.jsonl"
done
python3 - "$work" lumigraph polygons corners >build/bench/view.json <<'P'
import json
import sys

work, modes = sys.argv[1], sys.argv[2:]
rows = []
for mode in modes:
    views = [json.loads(line) for line in open(f"{work}/{mode}/views.jsonl")]
    quality = json.loads(open(f"{work}/{mode}.jsonl").readlines()[-1])
    orbit = views[: max(1, len(views) // 2)]
    mean = lambda key, of: sum(v[key] for v in of) / len(of)
    middle = lambda key: sorted(v[key] for v in views)[len(views) // 2]
    rows.append({
        "name": mode, "views": len(views),
        "psnr_db": quality["psnr_db"], "psnr_worst5_db": quality["psnr_worst5_db"], "ssim": quality["ssim"],
        "kb_per_view": round(mean("bytes_fetched", views) / 1000, 1),
        "first_view_kb": round(views[0]["bytes_fetched"] / 1000, 1),
        "image_share": round(mean("image_share", views), 3),
        "image_share_orbit": round(mean("image_share", orbit), 3),
        "frame_ms": middle("frame_ms"), "settled_ms": middle("settled_ms"),
        "all_settled": all(v["settled"] for v in views),
    })
print(json.dumps({"rows": rows}, indent=1))
P
