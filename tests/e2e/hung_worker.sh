#!/bin/bash
# A process of the museum server hangs, as on a disk that does not answer, while its kernel goes on acknowledging: the
# fetcher leaves that connection, and another process of the server brings what is wanted.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib-server.sh
. tests/e2e/lib-fetch.sh
fetch_pid='' hung=''
end_all() {
	[ -z "$hung" ] || kill -KILL $hung 2>/dev/null || true
	[ -z "$fetch_pid" ] || { kill "$fetch_pid" && wait "$fetch_pid" || true; } 2>/dev/null
	stop_server
}
trap 'end_all; rm -rf "$folder"' EXIT
fail() { echo "FAIL: $*" >&2; tail -n 20 "$folder/fetch.log" >&2 || true; exit 1; }

read -r root bytes < <("$tool" make "$folder/release" 6 40 8000 1)
start_server "$folder/release" "$folder/run"
"$fetch" --release "${server_url%/}" --ca "$server_ca" --cache "$folder/cache.db" --socket "$folder/socket" --stall-s 1 \
	2>"$folder/fetch.log" &
fetch_pid=$!
for _ in $(seq 100); do [ ! -S "$folder/socket" ] || break; sleep 0.1; done
walk() { "$tool" walk --socket "$folder/socket" --root "$root" --bytes "$bytes" "$@" 2>"$folder/walk.log"; }

line=$(walk --every 4) || fail "not all came: $line"
hung=$(pgrep -P "$server_pid")
kill -STOP $hung
kill -HUP "$server_pid" # others take their place
for _ in $(seq 100); do [ "$(pgrep -c -P "$server_pid")" -le "$(wc -w <<<"$hung")" ] || break; sleep 0.1; done
line=$(walk --most-s 60) || fail "what others would serve did not come: $line"
grep -q 'offline:' "$folder/fetch.log" || fail "nothing hung"
echo "all came beside a server that hangs"
