#!/bin/bash
# Frame times of each material as a ratio to flat shading: build/bench/materials.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory build/tests/bench/bench_materials >/dev/null
build/tests/bench/bench_materials >build/bench/materials.json
