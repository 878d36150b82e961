#!/bin/bash
# A frame with the eye moving a millimetre a frame over a warm cache, as a multiple of the same
# triangles with one plain texture lookup, of one textured quad that fills the screen, and of the same
# patches without images, all in one run: three views of the demo temple. build/bench/frame.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory benches >/dev/null
demo/prepare.sh >/dev/null
grep -v "^#" tests/bench/views.txt | head -40 | awk "NR % 14 == 1" >build/bench/frame-views.txt
build/tests/bench/bench_frame build/demo/release build/bench/frame-views.txt 25 >build/bench/frame.json
