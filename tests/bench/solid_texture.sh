#!/bin/bash
# Solid texturing on one core: on the fly, the whole 3D texture first, one cache cube, several:
# build/bench/solid_texture.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory build/tests/bench/bench_solid_texture >/dev/null
build/tests/bench/bench_solid_texture >build/bench/solid_texture.json
