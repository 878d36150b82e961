#!/bin/bash
# What a picture costs the curator's server, on one processor and on two: 20 views of a temple of 5 million triangles.
# build/bench/curator.json.
#
#   MILLION=1  so many million triangles
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" all build/tests/bench/bench_curator >/dev/null
million=${MILLION:-5}
content=build/bench/curator/$million
mkdir -p "$content"
printf '%s\n' '[model]' 'name = curator' 'scans = scan.ply' 'lit = yes' 'colours = scan' >"$content/temple.ini"
[ -f "$content/scan.ply" ] || {
	build/gopura-content temple --triangles "${million}000000" --out "$content/scan.part" >&2
	mv "$content/scan.part" "$content/scan.ply"
}
build/gopura-content hierarchy "$content" >&2
for processors in 0 0,1; do
	grep -v '^#' tests/bench/views.txt | head -60 | awk 'NR % 3 == 0' |
		taskset -c "$processors" build/tests/bench/bench_curator "$content"
done | awk 'NR == 1 { printf "{\"rows\": [\n %s,\n", $0 } NR == 2 { printf " %s\n]}\n", $0 }' >build/bench/curator.json
