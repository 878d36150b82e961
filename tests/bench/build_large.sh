#!/bin/bash
# By make bench-full: from a scan of 100 million triangles to its hierarchy, as the rows of build.sh.
# build/bench/build_large.json.
#
#   MILLIONS="100"  of triangles, a row each
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory build/gopura-content >/dev/null
# shellcheck disable=SC2086
printf '{"cores": %s, "rows": %s}\n' "$(nproc)" "$(python3 tests/bench/build_rows.py build/bench/build-large ${MILLIONS:-100})" \
	>build/bench/build_large.json.new
mv build/bench/build_large.json.new build/bench/build_large.json
