#!/bin/bash
# A visit on a clock of its own over 10 Mbit/s and 40 ms: pictures while the eye moves, the time to
# settle at each stop, a frame's work, pops and holes; once whole at 1280 x 720, and at half of that
# without and with each of three faults, to show what is found. build/bench/motion.json; pictures in build/bench/motion.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/motion release=build/demo/release visit=tests/bench/visit.txt
make --no-print-directory benches >/dev/null
demo/prepare.sh >/dev/null
mkdir -p "$work"
play() { build/tests/bench/bench_motion "$release" "$visit" "$@"; }
play "$work/visit"
build/gopura-content render build/demo/content --views "$work/visit/views.txt" --size 1280x720 \
	--supersample 4 --out "$work/truth" >&2
play "$work/visit" --truth "$work/truth"
for fault in none patch tile sample; do
	play "$work/$fault" --size 640x360 --fault "$fault"
done
python3 - "$work" >build/bench/motion.json <<'P'
import json
import sys

read = lambda name: json.load(open(f"{sys.argv[1]}/{name}/motion.json"))
found = lambda of: {key: of[key] for key in ("popping_frames", "popped_blocks_most", "holes")}
figures = read("visit")
for fault in ("none", "patch", "tile", "sample"):
    figures[f"fault_{fault}"] = found(read(fault))
print(json.dumps(figures, indent=1))
P
