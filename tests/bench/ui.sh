#!/bin/bash
# What callouts and pages cost a frame: build/bench/ui.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory benches >/dev/null
build/tests/bench/bench_ui demo/content/pages/central-tower.km.html >build/bench/ui.json
