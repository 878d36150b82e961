#!/bin/bash
# How soon a page is there whose objects are in the cache: build/bench/page.json. Five parts of the small
# temple by the search, two rounds: the first fills the cache, the second is measured. FULL=yes: with its images.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/bench/page
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory build/gopura-fetch build/tests/bench/bench_page >/dev/null
small_release
python3 - "$work/pages.touch" <<'P'
import sys

now, lines = 8000, []


def tap(x, y, then):
    global now
    lines.append(f"{now} down 0 {x} {y}\n{now + 60} up 0 {x} {y}")
    now += then


for row in range(5):
    tap(128, 516, 1500)  # the search
    tap(720, 75 + 58 * row, 5000)  # a row of it: card and flight, until the eye rests
    tap(480, 430, 4000)  # the card
    tap(915, 22, 1000)  # what closes the page
open(sys.argv[1], "w").write("\n".join(lines) + "\n")
P
# Few triangles without images: what is left of a frame where no GPU draws it is the words.
printf '[render]\ntriangles = 10000\n' >"$work/board.ini"
light=(--mode polygons --board "$work/board.ini")
[ -z "${FULL:-}" ] || light=(--mode lumigraph)
for round in 1 2; do
	build/tests/bench/bench_page "${light[@]}" --fetch build/gopura-fetch --display headless --size 960x540 \
		--release "$small/release" --trust "$small/release/root/1.json" --state "$work/state" \
		--touch-replay "$work/pages.touch" --quit-after-replay >"$work/$round.jsonl" 2>"$work/log" ||
		{ tail -n 20 "$work/log"; fail "the kiosk ended with an error"; }
done
python3 - "$work/2.jsonl" >build/bench/page.json <<'P'
import json
import sys

pages = [json.loads(line) for line in open(sys.argv[1])]
assert len(pages) == 5, f"{len(pages)} pages opened, not 5"
middle = lambda name: sorted(page[name] for page in pages)[2]
worst = lambda name: max(page[name] for page in pages)
names = ("first_frame_ms", "whole_ms", "frames", "with_pictures_ms", "words_cpu_ms", "first_frame_cpu_ms",
         "whole_cpu_ms")
print(json.dumps({"panel": "960x540", "pages": pages, "median": {n: middle(n) for n in names},
                  "worst": {n: worst(n) for n in names}}, indent=1))
P
