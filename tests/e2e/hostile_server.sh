#!/bin/bash
# The fetcher against a hostile server, or somebody who answers in its place: a captive portal, endless bodies and
# headers, a byte per second, redirections, wrong ranges, broken connections, a place that cannot be read. The fetcher
# accepts no wrong object, contacts no other server, stays small, keeps sending its status, and loads everything once
# the server is good again. Then a new root after a portal, through the fetcher alone.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib-fetch.sh
server=
pids=()
fail() { echo "FAIL: $*" >&2; tail -n 20 "$folder/fetch.log" >&2 || true; exit 1; }
end_all() { for pid in "${pids[@]}" $server; do kill "$pid" 2>/dev/null && wait "$pid" 2>/dev/null || true; done; }
trap 'end_all; rm -rf "$folder"' EXIT

read -r root bytes < <("$tool" make "$folder/release" 6 40 8000 1)
objects=247
be() { echo "$1" >"$folder/mode.new"; mv "$folder/mode.new" "$folder/mode"; }
be good
mkfifo "$folder/end"
python3 tests/tools/hostile_server.py "$folder/release" "$folder/mode" "$folder/port" <"$folder/end" &
server=$!
exec 9>"$folder/end"
for _ in $(seq 100); do [ ! -f "$folder/port" ] || break; sleep 0.1; done
read -r port neighbour <"$folder/port"

walk() { # NAME SECONDS: prints the tool's line of figures
	"$tool" walk --socket "$folder/$1.socket" --root "$root" --bytes "$bytes" --most-s "$2" 2>"$folder/$1.walk"
}
figure() { sed -E "s/.*\"$1\":(-?[0-9]+).*/\1/" <<<"$2"; }
peak_kib() { awk '/^VmHWM/ { print $2 }' "/proc/$1/status"; }

# try MODE: a fetcher of its own, with the hostile server for a while, then with the good one.
try() {
	local pid line came
	"$fetch" --release "http://127.0.0.1:$port" --cache "$folder/$1.db" --socket "$folder/$1.socket" --stall-s 2 \
		--poll-s 1 2>"$folder/fetch.log" &
	pid=$!
	pids+=("$pid")
	for _ in $(seq 100); do [ ! -S "$folder/$1.socket" ] || break; sleep 0.1; done
	be "$1"
	line=$(walk "$1" 4) && [ "$1" != longer ] && fail "$1: all came: $line"
	came=$(figure came "$line")
	kill -0 "$pid" || fail "$1: the fetcher ended"
	[ ! -f "$folder/mode.visits" ] || fail "$1: the neighbour was visited"
	be good
	line=$(walk "$1" 90) || fail "$1: not all came once the server was good: $line"
	[ "$(figure came "$line")" = "$objects" ] || fail "$1: $line"
	[ "$(peak_kib "$pid")" -lt $((96 << 10)) ] || fail "$1: the fetcher took $(peak_kib "$pid") KiB"
	echo "$1: $came objects, then all in $(figure ms "$line") ms, $(peak_kib "$pid") KiB at most"
	kill "$pid"
	wait "$pid" || fail "$1: the fetcher did not end well"
}
for how in portal elsewhere home round silent slow endless headers shifted overlapping longer reset bomb rubbish; do
	try "$how"
done

# ---- a place that the server cannot read: all but the one object come, and the fetcher looks for a release meanwhile
be broken
"$fetch" --release "http://127.0.0.1:$port" --cache "$folder/broken.db" --socket "$folder/broken.socket" --poll-s 1 \
	2>"$folder/fetch.log" &
pids+=($!)
for _ in $(seq 100); do [ ! -S "$folder/broken.socket" ] || break; sleep 0.1; done
line=$(walk broken 15) && fail "broken: all came: $line"
[ "$(figure came "$line")" = $((objects - 1)) ] || fail "broken: $line"
[ "$(wc -l <"$folder/mode.looks")" -ge 4 ] || fail "broken: the fetcher does not look for a release"
be good
line=$(walk broken 90) || fail "broken: the object did not come once the server was good: $line"

# ---- a portal for many rounds, then the next roots
mkdir -p "$folder/release/root"
for version in 2 3; do echo "root $version" >"$folder/release/root/$version.json"; done
be portal
"$fetch" --release "http://127.0.0.1:$port" --cache "$folder/root.db" --socket "$folder/root.socket" --poll-s 1 \
	2>"$folder/fetch.log" &
pids+=($!)
for _ in $(seq 100); do [ ! -S "$folder/root.socket" ] || break; sleep 0.1; done
timeout 120 python3 tests/tools/root_rounds.py "$folder/root.socket" "$folder/mode" || fail "the roots did not arrive"
echo "nothing wrong was taken, nobody else was visited, all came in the end"
