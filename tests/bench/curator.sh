#!/bin/bash
# What a picture costs the curator's server, on one processor and on two: 20 views of a temple of 5 million triangles.
# Then what one curator waits for it over the loopback, and what two at once do. build/bench/curator.json.
#
#   MILLION=1  so many million triangles
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" all build/tests/bench/bench_curator >/dev/null
million=${MILLION:-5}
content=build/bench/curator/$million
mkdir -p "$content"
printf '%s\n' '[model]' 'name = curator' 'scans = scan.ply' 'lit = yes' 'colours = scan' '[view]' 'start = eye 38 -24 20 target 0 0 9' >"$content/temple.ini"
[ -f "$content/scan.ply" ] || {
	build/gopura-content temple --triangles "${million}000000" --out "$content/scan.part" >&2
	mv "$content/scan.part" "$content/scan.ply"
}
build/gopura-content hierarchy "$content" >&2
build/gopura-curator user list "$content" 2>/dev/null | grep -q ' ana$' ||
	echo 'password of ana' | build/gopura-curator user add "$content" ana --role editor >&2
{
	for processors in 0 0,1; do
		grep -v '^#' tests/bench/views.txt | head -60 | awk 'NR % 3 == 0' |
			taskset -c "$processors" build/tests/bench/bench_curator "$content"
	done
	build/gopura-curator "$content" --port 0 >build/bench/curator.log 2>&1 &
	curator=$!
	trap 'kill $curator 2>/dev/null || true' EXIT
	until port=$(grep -om1 '127\.0\.0\.1:[0-9]*' build/bench/curator.log); do
		kill -0 $curator
		sleep 0.2
	done
	for curators in 1 2 1 2; do
		python3 tests/e2e/curator.py "${port#*:}" "$content" measure $curators
	done
} | awk '{ rows = rows (NR > 1 ? ",\n " : " ") $0 } END { printf "{\"rows\": [\n%s\n]}\n", rows }' >build/bench/curator.json
