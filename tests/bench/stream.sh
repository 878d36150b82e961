#!/bin/bash
# What a visitor waits for at a new terminal: the first view of the demo temple from an empty cache, over lines on the
# stage's clock, without the streaming mesh and with it (tests/bench/bench_first.c). build/bench/stream.json.
#
#   LINES="64:100 1000:40"   kbit/s and round trip in ms of each line (default: also 10000:40)
#   CONTENT=DIR RELEASE=DIR  another model than the demo's
#   VIEWS=FILE               whose first line is the view (default: tests/bench/views.txt)
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/stream
content=${CONTENT:-build/demo/content} release=${RELEASE:-build/demo/release}
make --no-print-directory benches >/dev/null
[ -n "${RELEASE:-}" ] || demo/prepare.sh >/dev/null
mkdir -p "$work"
grep -v '^#' "${VIEWS:-tests/bench/views.txt}" | head -n 1 >"$work/view.txt"
build/gopura-content render "$content" --views "$work/view.txt" --size 960x540 --supersample 4 --out "$work/truth" >&2
: >"$work/rows"
for line in ${LINES:-64:100 1000:40 10000:40}; do
	for stream in no yes; do
		build/tests/bench/bench_first "$release" "$work/view.txt" "$work/truth" --size 960x540 \
			--kbit "${line%:*}" --rtt "${line#*:}" --stream "$stream" --most "${MOST_S:-150}" \
			--film "$work/film-${line%:*}-$stream" 2>/dev/null >>"$work/rows"
	done
done
python3 - "$work/rows" >build/bench/stream.json <<'P'
import json
import sys

rows = []
for row in map(json.loads, open(sys.argv[1])):
    line = f"{row.pop('kbit')} kbit/s, {row.pop('rtt_ms')} ms"
    rows.append({"line": line} | {key: None if value == -1 else value for key, value in row.items()})
print(json.dumps({"rows": rows}, indent=1))
P
