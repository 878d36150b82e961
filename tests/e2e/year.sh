#!/bin/bash
# A few days of a museum's terminal, or with DAYS=366 a year (`make soak-year`), on a clock that is set forward whenever
# nothing happens: memory, descriptors, threads, files and wear stay flat (docs/life.md). The card is a small tmpfs, so
# that it can be full. HOURS=8 (`make soak-night`) are hours of real time instead, and the card is a folder of the disk.
#
#   DAYS=4 START=2028-02-27 VISITS=1 tests/e2e/year.sh
set -eu
cd "$(dirname "$0")/../.."
if [ -z "${YEAR_MOUNTS:-}${HOURS:-}" ]; then
	map=$([ "$(id -u)" = 0 ] || echo --map-root-user)
	# shellcheck disable=SC2086
	if unshare -m $map mount -t tmpfs -o size=1m none /mnt 2>/dev/null; then
		export YEAR_MOUNTS=yes
		exec unshare -m $map bash "$0"
	fi
fi
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
[ -n "${YEAR_MOUNTS:-}${HOURS:-}" ] || skip "a disk of its own cannot be mounted here"
command -v nginx >/dev/null || skip "nginx is not installed"
make --no-print-directory build/tests/tools/virtual_clock.so >/dev/null
days=${DAYS:-4} work=${WORK:-build/e2e/year}
rm -rf "$work"
mkdir -p "$work/content" "$work/disk"
[ -n "${HOURS:-}" ] || mount -t tmpfs -o size="${DISK:-64m}" none "$work/disk"
tiny_content "$work/content" 10000 5000
build/gopura-content keys "$work/content" --keys "$work/keys" --tuf >/dev/null
if [ -n "${HOURS:-}" ]; then
	table=hours time=(--hours "$HOURS")
else
	table=year time=(--days "$days" --start "${START:-2028-02-27}" --visits "${VISITS:-1}")
fi
tests/tools/museum_year.py "$work" "${time[@]}"
tests/tools/museum_year.py plot "$work/$table.csv" "$work/$table.svg"
tests/tools/museum_year.py check "$work/$table.csv"
