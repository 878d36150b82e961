#!/bin/bash
# Meshes of so many triangles as asked, from the marching-cube octree of the Happy Buddha's range images, of Lucy and of
# the demo temple with TRIANGLES triangles (1 000 000), beside quadric simplification. build/bench/octree.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/tests/bench/bench_octree build/gopura-content >/dev/null
scans=../shared/scans
temple=$(mktemp -d)
trap 'rm -rf "$temple"' EXIT
build/gopura-content temple --triangles "${TRIANGLES:-1000000}" --out "$temple/temple.ply" >/dev/null
mkdir -p build/bench
comma='{'
# name, side of a leaf cube in metres, file, metres of its unit
while read -r name cell file unit; do
	[ -f "$file" ] || { echo "$file is absent" >&2; continue; }
	printf '%s"%s": ' "$comma" "$name"
	build/tests/bench/bench_octree "$cell" "$file" "$unit" 2>/dev/null
	comma=,
done <<-S >build/bench/octree.part
	buddha 0.001 $scans/happy-buddha-range/happyStandRight.conf 1
	lucy 0.006 $scans/lucy-100k/lucy.ply 0.001
	temple 0.15 $temple/temple.ply 1
S
echo '}' >>build/bench/octree.part
mv build/bench/octree.part build/bench/octree.json
