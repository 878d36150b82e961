#!/bin/bash
# Bytes, decoding and encoding of patches: the published tenth of temples of 2 and 3 million triangles, and
# everything of the first. build/bench/patch.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/bench/bench_patch >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# temple NAME MILLIONS: with the demo's stone; its hierarchy.
temple() {
	cp -r demo/content "$folder/$1"
	build/gopura-content temple --triangles "$((${2} * 1000000))" --seed 1 --regions "$folder/$1/regions" \
		--out "$folder/$1/scan.ply" >/dev/null 2>&1
	build/gopura-content hierarchy "$folder/$1" >/dev/null 2>&1
}

temple two 2
temple three 3
mkdir -p build/bench
{
	printf '{"2 M": '
	build/tests/bench/bench_patch "$folder/two/.work/master" 0.1
	printf ', "3 M": '
	build/tests/bench/bench_patch "$folder/three/.work/master" 0.1
	printf ', "2 M, the master": '
	build/tests/bench/bench_patch "$folder/two/.work/master" 0
	echo '}'
} >"$folder/patch.json"
mv "$folder/patch.json" build/bench/patch.json
