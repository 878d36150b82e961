#!/bin/bash
# [hierarchy] surface = octree: how often ways to tell inside from outside are wrong on dirty boxes whose truth is known,
# and what real scans become. build/bench/closed.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/tests/bench/bench_closed build/gopura-content >/dev/null
temple=$(mktemp -d)
trap 'rm -rf "$temple"' EXIT
build/gopura-content temple --triangles "${TRIANGLES:-1000000}" --out "$temple/temple.ply" >/dev/null
scans=../shared/scans
mkdir -p build/bench
{
	echo '{"signs":'
	build/tests/bench/bench_closed signs
	echo ', "scans": ['
	comma=
	# name, file, up axis, metres in its unit, cubes in metres (0: default)
	while read -r name file up unit cell; do
		[ "$name" = temple ] && file=$temple/temple.ply || file=$scans/$file
		[ -f "$file" ] || continue
		printf '%s' "$comma"
		build/tests/bench/bench_closed "$name" "$file" "$up" "$unit" "$cell" 2>/dev/null
		comma=,
	done <<-S
		temple temple.ply z 1 0
		lucy lucy-100k/lucy.ply z 0.001 0
		zeus bust-zeus-head/koepfchenzeus.obj y 0.001 0
		zeus bust-zeus-head/koepfchenzeus.obj y 0.001 0.001
		sphinx bust-sphinx-head/koepfchensphinx.obj y 0.001 0
		venus venus-cc0-textured/decoded/venus.obj y 0.1 0
		nefertiti nefertiti/nefertiti-lowres.obj y 1 0
		demosthenes demosthenes/demosthenes-low-res.obj y 1 0
		lion lionstatue/lionstatue.obj y 1 0
		bunny stanford-bunny/reconstruction/bun_zipper.ply y 1 0
		gargoyle gargoyle-vertex-colour/gargo.ply y 1 0
	S
	echo ']}'
} >build/bench/closed.part
mv build/bench/closed.part build/bench/closed.json
