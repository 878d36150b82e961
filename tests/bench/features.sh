#!/bin/bash
# Simplifiers by what surfaces look like and what they take: feature edges, quadrics, meshoptimizer; furniture and an
# aircraft that are built, the demo temple, and scans where they are at hand. build/bench/features.json.
# PICTURES=DIR: also writes the pictures of docs/hierarchy.md.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/bench/bench_features >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/gopura-content temple --triangles "${TRIANGLES:-300000}" --seed 1 --out "$folder/temple.ply" >/dev/null 2>&1
comma='{'
# compare NAME FILE UP [SHARE VIEW]: rows, and a picture at that share of the triangles.
compare() {
	case $2 in */*) [ -f "$2" ] || return 0 ;; esac
	printf '%s"%s": ' "$comma" "$1"
	comma=', '
	build/tests/bench/bench_features "$2" "$3"
	[ -z "${PICTURES:-}" ] || [ $# -lt 5 ] ||
		build/tests/bench/bench_features "$2" "$3" "$PICTURES/features-$1.jpg" "$4" "$5"
}
scans=../shared/scans
{
	compare furniture furniture z 0.02 0
	compare aircraft aircraft z 0.01 0
	compare temple "$folder/temple.ply" z 0.05 2
	compare bunny "$scans/stanford-bunny/reconstruction/bun_zipper.ply" y 0.02 2
	compare sphinx "$scans/bust-sphinx-head/koepfchensphinx.obj" y
	compare lion "$scans/lionstatue/lionstatue.obj" y
	echo '}'
} >"$folder/features.json"
mkdir -p build/bench
mv "$folder/features.json" build/bench/features.json
