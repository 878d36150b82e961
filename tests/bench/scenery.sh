#!/bin/bash
# What scenery costs a frame, as a multiple of none, before the demo temple's eastern gate, at its corner and from afar:
# build/bench/scenery.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory benches >/dev/null
demo/prepare.sh >/dev/null
printf '%s\n' '22.6 0 4 17.8 0 4.2 45' '24 -24 7 12 -12 4 45' '45 -32.5 12 0.3 -0.2 8.1 36.5' >build/bench/scenery-views.txt
build/tests/bench/bench_scenery build/demo/release build/bench/scenery-views.txt 25 >build/bench/scenery.json
