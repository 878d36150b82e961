#!/bin/bash
# Bytes and speed of the streaming mesh of the published tenth of the demo temple with 2 million triangles.
# build/bench/stream_mesh.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/bench/bench_stream >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r demo/content "$folder/temple"
build/gopura-content temple --triangles 2000000 --seed 1 --regions "$folder/temple/regions" \
	--out "$folder/temple/scan.ply" >/dev/null 2>&1
build/gopura-content hierarchy "$folder/temple" >/dev/null 2>&1
mkdir -p build/bench
build/tests/bench/bench_stream "$folder/temple/.work/master" 0.1 >build/bench/stream_mesh.json
