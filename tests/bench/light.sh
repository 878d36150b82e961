#!/bin/bash
# What the raking light and the section cost a frame, as a multiple of none, at three views of the demo
# temple: build/bench/light.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory benches >/dev/null
demo/prepare.sh >/dev/null
grep -v "^#" tests/bench/views.txt | head -40 | awk "NR % 14 == 1" >build/bench/light-views.txt
build/tests/bench/bench_light build/demo/release build/bench/light-views.txt 25 >build/bench/light.json
