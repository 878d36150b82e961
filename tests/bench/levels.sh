#!/bin/bash
# How far each level of the hierarchy lies from its scan, beside meshoptimizer at the same count: the
# demo temple and three real scans where they are at hand. build/bench/levels.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/bench/bench_levels >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# levels NAME SCAN: a line of JSON.
levels() {
	mkdir -p "$folder/$1"
	ln -sf "$2" "$folder/$1/${2##*/}"
	printf '[model]\nscans = %s\n' "${2##*/}" >"$folder/$1/temple.ini"
	build/gopura-content hierarchy "$folder/$1" >/dev/null 2>&1
	printf '"%s": ' "$1"
	build/tests/bench/bench_levels "$folder/$1/.work/mesh" "$folder/$1/.work/master"
}

mkdir -p "$folder/made"
build/gopura-content temple --triangles "${TRIANGLES:-2000000}" --out "$folder/made/temple.ply" >/dev/null 2>&1
{
	echo '{'
	levels temple "$folder/made/temple.ply"
	for scan in lionstatue/lionstatue.obj stanford-bunny/reconstruction/bun_zipper.ply lucy-100k/lucy.ply; do
		[ -f "../shared/scans/$scan" ] || continue
		echo ','
		levels "${scan%%/*}" "$(realpath "../shared/scans/$scan")"
	done
	echo '}'
} >"$folder/levels.json"
mkdir -p build/bench
mv "$folder/levels.json" build/bench/levels.json
