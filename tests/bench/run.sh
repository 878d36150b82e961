#!/bin/bash
# make bench [BENCH=NAME]: runs tests/bench/NAME.sh (or all of them), each of which writes
# build/bench/NAME.json, and prints that. Those whose second line says "By make bench-full" take hours:
# by name, or all of them by make bench-full (run.sh --full).
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory -j"$(nproc)" tests >/dev/null
# Whole, it draws one row of view; all of them take longer than the rest together.
[ $# -gt 0 ] || export ROWS=${ROWS:-demo}
asked=${1:-} full=
[ "$asked" != --full ] || asked='' full=yes
for script in tests/bench/${asked:-*}.sh; do
	name=$(basename "$script" .sh)
	[ "$name" != run ] || continue
	[ -f "$script" ] || { echo "no such benchmark: $name" >&2; exit 2; }
	takes_hours=
	! sed -n 2p "$script" | grep -q '^# By make bench-full' || takes_hours=yes
	[ -n "$asked" ] || [ "$takes_hours" = "$full" ] || continue
	echo "== $name"
	status=0
	bash "$script" || status=$?
	[ $status -ne 77 ] || continue # it said what it lacks
	[ $status -eq 0 ] || exit $status
	cat "build/bench/$name.json"
done
