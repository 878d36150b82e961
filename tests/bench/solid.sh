#!/bin/bash
# Questions about the space for the eye on the demo temple, at several sizes of cells and of the scan, and random
# gestures on it. build/bench/solid.json. TRIANGLES="4000000 18000000": scans besides that of a million; GESTURES=10000.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/tests/bench/bench_solid build/gopura-content >/dev/null
mkdir -p build/bench
scans=()
for triangles in 1000000 ${TRIANGLES:-4000000 18000000}; do
	scan=build/bench/temple-$triangles.ply
	[ -f "$scan" ] || build/gopura-content temple --triangles "$triangles" --seed 1 --out "$scan" >/dev/null
	scans+=("$scan")
done
build/tests/bench/bench_solid "${GESTURES:-10000}" "${scans[@]}" 2>/dev/null >build/bench/solid.part
mv build/bench/solid.part build/bench/solid.json
