#!/bin/bash
# What a visitor waits for at a new terminal, with the real programs: kiosk and fetcher from an empty cache, nginx, and a
# line that delays, shares, loses and swings packets (tests/tools/line.c), on the machine's clock; beside them the same on the
# stage's clock (bench_first). The form is Table 3-4 of paper P3. build/bench/lines.json.
#
#   LINES="KBIT:RTT[:LOSS[:SWING[:WAIT]]] ..."  the lines: percent lost, seconds of a swing, ms of a turn (default 500)
#   CONTENT=DIR RELEASE=DIR                     another model than the demo's
#   VIEWS=FILE                                  whose first line is the view (default: tests/bench/views.txt)
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib-server.sh
work=build/bench/lines
content=${CONTENT:-build/demo/content} release=${RELEASE:-build/demo/release}
make --no-print-directory all tests benches >/dev/null
[ -n "${RELEASE:-}" ] || demo/prepare.sh >/dev/null
rm -rf "$work"
mkdir -p "$work/truth"
grep -v '^#' "${VIEWS:-tests/bench/views.txt}" | head -n 1 >"$work/view.txt"
build/gopura-content render "$content" --views "$work/view.txt" --size 960x540 --supersample 4 --out "$work/truth" >&2
trap stop_server EXIT
GOPURA_LISTEN=0.0.0.0 start_server "$release" "$work/server" 0 10.77.0.1
port=${server_url##*:}
# shellcheck disable=SC2086
python3 tests/bench/lines.py "$work" "$release" "${port%/}" ${LINES:-32:100 64:100 1000:40 1000:300 10000:40 100000:20 \
	1000:40:2 10000:40:2 2000:40:0:5 1000:600:10 64:100:0:0:30000 64:100:0:0:50 1000:40:0:0:30000 1000:40:0:0:50} >build/bench/lines.json.new
mv build/bench/lines.json.new build/bench/lines.json
