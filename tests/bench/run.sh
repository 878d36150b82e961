#!/bin/bash
# make bench [BENCH=NAME]: runs tests/bench/NAME.sh (or all of them), each of which writes
# build/bench/NAME.json, and prints that.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory -j"$(nproc)" tests >/dev/null
# Whole, it draws one row of view; all of them take longer than the rest together.
[ $# -gt 0 ] || export ROWS=${ROWS:-demo}
for script in tests/bench/${1:-*}.sh; do
	name=$(basename "$script" .sh)
	[ "$name" != run ] || continue
	[ -f "$script" ] || { echo "no such benchmark: $name" >&2; exit 2; }
	echo "== $name"
	bash "$script"
	cat "build/bench/$name.json"
done
