#!/bin/bash
# Meshes of so many triangles as asked, from the marching-cube octree of the Happy Buddha, beside quadric simplification.
# build/bench/octree.json. CELL=0.001: metres.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/tests/bench/bench_octree >/dev/null
scans=../shared/scans/happy-buddha-range/happyStandRight.conf
[ -f "$scans" ] || { echo "$scans is absent"; exit 0; }
mkdir -p build/bench
build/tests/bench/bench_octree "${CELL:-0.001}" "$scans" 2>/dev/null >build/bench/octree.part
mv build/bench/octree.part build/bench/octree.json
