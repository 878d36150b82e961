#!/bin/bash
# By make bench-full: from scans to their hierarchies, as the rows of build.sh: the three sizes of the paper
# (P0, Table 1) and 100 million triangles. build/bench/build_large.json.
#
#   MILLIONS="100"  of triangles, a row each
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory build/gopura-content build/tests/bench/bench_loaded >/dev/null
# shellcheck disable=SC2086
printf '{"cores": %s, "rows": %s}\n' "$(nproc)" "$(python3 tests/bench/build_rows.py build/bench/build-large ${MILLIONS:-5.92279 9.162909 18.132893 100})" \
	>build/bench/build_large.json.new
mv build/bench/build_large.json.new build/bench/build_large.json
