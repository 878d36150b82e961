#!/bin/bash
# A terminal's health from outside, with real kiosk, fetcher and gopura-health: a strict parser reads the metrics as
# Prometheus would; programs that exit or hang turn the page red with the reason, and back.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v curl >/dev/null || skip "curl is not installed"
work=build/e2e/health
rm -rf "$work"
mkdir -p "$work"
small_release
release=$small/release kiosk= fetch= health=
trap '{ kill -CONT $kiosk; kill $kiosk $fetch $health; } 2>/dev/null || true' EXIT

start_fetch() {
	build/gopura-fetch --release "$release" --cache "$work/cache.db" --socket "$work/socket" \
		--metrics "$work/fetch" >>"$work/fetch.log" 2>&1 &
	fetch=$!
}
start_kiosk() {
	build/gopura-kiosk --display headless --size 320x180 --socket "$work/socket" \
		--trust "$release/root/1.json" --state "$work/state" --metrics "$work/kiosk" \
		--touch-replay tests/e2e/nothing.touch >>"$work/kiosk.log" 2>&1 &
	kiosk=$!
}
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
url=http://127.0.0.1:$port
options=(--kiosk "$work/kiosk" --fetch "$work/fetch" --faults "$work/faults" --data "$work"
	--visits "$work/visits.csv")

# says STATUS PATTERN PATH...: checks the response to a request
says() {
	local want=$1 pattern=$2
	shift 2
	[ "$(curl -s --max-time 60 -o "$work/answer" -w '%{http_code}' "$@")" = "$want" ] || return 1
	grep -qE -- "$pattern" "$work/answer"
}
becomes() { wait_for 60 "'$2' with $1 from $3" says "$@"; }

# ---- started as systemd does, by the first request; it exits when no more requests come
if command -v systemd-socket-activate >/dev/null; then
	systemd-socket-activate -l "127.0.0.1:$port" build/gopura-health --idle-s 1 "${options[@]}" \
		>"$work/activate.log" 2>&1 &
	health=$!
	becomes 503 '^critical: The display program does not respond: It is not running' "$url/health"
	becomes 503 '^critical: The download program does not respond' "$url/health"
	wait "$health" || { cat "$work/activate.log"; fail "it did not end well when idle"; }
	health=
fi
! build/gopura-health 2>"$work/log" || fail "it runs without a socket"
grep -q -- '--listen ADDR:PORT' "$work/log" || fail "without a socket: no cure is told"

# ---- everything works
start_fetch
start_kiosk
build/gopura-health --listen "127.0.0.1:$port" "${options[@]}" >"$work/health.log" 2>&1 &
health=$!
becomes 200 '^gopura_kiosk_picture 1' "$url/metrics"
becomes 200 '^gopura_kiosk_geometry_bytes [1-9]' "$url/metrics" # the first picture is of the streaming mesh
becomes 200 '^gopura_kiosk_release_sequence 1' "$url/metrics"
# This machine's GPU and clock may deserve a warning, but nothing is critical.
becomes 200 '^(ok|warning)$' "$url/health"
says 200 'Prasat Gopura, version 1' "$url/" || fail "the page does not say what is shown"
says 200 '' "$url/metrics" || fail "no figures"
python3 - "$work/answer" <<'P' || fail "not Prometheus's format"
# The text format 0.0.4, strictly: each sample belongs to the TYPE and HELP right before it, no name
# comes twice, counters end in _total and are not below zero, gauges do not end so.
import re, sys
text = open(sys.argv[1], "rb").read().decode("utf-8")
assert text.endswith("\n"), "cut"
sample = re.compile(r'([a-z_]+)(?:\{((?:[a-z_]+="(?:[^"\\\n]|\\["\\n])*",?)+)\})? (-?[0-9][0-9.e+-]*)')
seen, helped, typed = {}, None, None
for n, line in enumerate(text.split("\n")[:-1], 1):
    head = re.fullmatch(r"# (HELP|TYPE) ([a-z_]+) (\S.*)", line)
    if head and head[1] == "HELP":
        assert head[2] not in seen, (n, line)
        helped = head[2]
    elif head:
        assert head[2] == helped and head[3] in ("gauge", "counter"), (n, line)
        typed = (head[2], head[3])
    else:
        m = sample.fullmatch(line)
        assert m and typed and m[1] == typed[0] == helped and m[1] not in seen, (n, line)
        assert (typed[1] == "counter") == m[1].endswith("_total"), (n, line)
        seen[m[1]] = float(m[3])
        assert typed[1] == "gauge" or seen[m[1]] >= 0, (n, line)
for name in ("gopura_kiosk_frames_total", "gopura_fetch_received_bytes_total", "gopura_kiosk_up",
             "gopura_terminal_uptime_seconds", "gopura_kiosk_geometry_bytes", "gopura_kiosk_starts_total"):
    assert seen.get(name, 0) > 0, name
assert seen["gopura_kiosk_texture_bytes"] <= seen["gopura_kiosk_texture_budget_bytes"]
assert seen["gopura_fetch_cache_bytes"] <= seen["gopura_fetch_cache_budget_bytes"]
P

# ---- requests that it does not answer
says 404 '^404' "$url/figures" || fail "another page"
says 404 '^404' --path-as-is "$url/../../etc/hostname" || fail "a file"
says 405 '^405' -d x=1 "$url/" || fail "a POST"
says 431 '' -H "A: $(head -c 10000 /dev/zero | tr '\0' a)" "$url/" || fail "a head too long"
printf 'GET / HTTP/3.0\r\n\r\n' | timeout 10 python3 -c '
import socket, sys
s = socket.create_connection(("127.0.0.1", int(sys.argv[1])))
s.sendall(sys.stdin.buffer.read())
assert s.recv(4096).startswith(b"HTTP/1.1 505 ")' "$port" || fail "another protocol"
[ "$(curl -s -I "$url/health" | head -c 12)" = 'HTTP/1.1 200' ] || fail "HEAD"

# ---- the counts of visitors: a file of any size, to slow readers too, without memory for it
says 404 '^404' "$url/visits.csv" || fail "counts that are not there"
mkfifo "$work/visits.csv"
says 404 '^404' "$url/visits.csv" || fail "a pipe as counts"
rm "$work/visits.csv"
head -c 40000000 /dev/urandom >"$work/counts"
cp "$work/counts" "$work/visits.csv"
python3 - "$port" "/proc/$health/status" <<'P' || fail "slow readers of the counts"
# Sixteen readers at four addresses request 40 MB and read nothing; MemoryMax= of the unit is 32 MB.
# Some are refused, so that there is room for those who want to know whether the terminal works.
import re, socket, sys
address = ("127.0.0.1", int(sys.argv[1]))
slow = []
for n in range(16):
    s = socket.socket()
    s.bind((f"127.0.0.{1 + n % 4}", 0))
    s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    s.settimeout(60)
    s.connect(address)
    s.sendall(b"GET /visits.csv HTTP/1.1\r\n\r\n")
    slow.append(s)
statuses = sorted(s.recv(12)[9:] for s in slow)
memory = int(re.search(r"VmHWM:\s*(\d+) kB", open(sys.argv[2]).read())[1])
print(statuses, memory, "kB at most")
assert set(statuses) == {b"200", b"503"}, statuses
assert memory < 12000, memory
for s in slow:
    s.close()
with socket.create_connection(address, 60) as s:
    s.sendall(b"GET /metrics HTTP/1.1\r\n\r\n")
    assert s.recv(12) == b"HTTP/1.1 200"
P
says 200 '' "$url/visits.csv" || fail "no counts"
cmp "$work/answer" "$work/counts" || fail "the counts did not arrive as they are"
[ "$(curl -sI "$url/visits.csv" | grep -i '^content-length' | tr -dc 0-9)" = 40000000 ] || fail "HEAD of the counts"
# The kiosk replaces the file while somebody reads it: the reader gets the previous one completely.
rm "$work/answer"
curl -s --max-time 60 --limit-rate 20M -o "$work/answer" "$url/visits.csv" &
reader=$!
wait_for 60 "beginning of the counts" test -s "$work/answer"
echo other >"$work/fresh"
mv "$work/fresh" "$work/visits.csv"
wait "$reader" || fail "the counts were cut when the file was replaced"
cmp "$work/answer" "$work/counts" || fail "the counts changed when the file was replaced"
rm "$work/visits.csv" "$work/answer" "$work/counts"

# ---- what was provisioned in vain
echo "gopura.conf, line 4: [panel] mode <big> is no mode" >"$work/faults"
becomes 200 'line 4: \[panel\] mode &#60;big&#62; is no mode' "$url/"
rm "$work/faults"

# ---- failures, and recovery
kill -KILL "$fetch"
wait "$fetch" 2>/dev/null || true
becomes 503 '^critical: The download program does not respond: It has exited' "$url/health"
says 503 '' "$url/health" && says 200 'Needs attention' "$url/" || fail "the page is not red"
says 200 '^gopura_fetch_up 0' "$url/metrics" || fail "the figures call a dead fetcher up"
start_fetch
becomes 200 '^gopura_fetch_starts_total 2' "$url/metrics"
becomes 200 'The download program was restarted: .* 1 restart since' "$url/health"
kill -STOP "$kiosk"
becomes 503 '^critical: The display program does not respond: It is running but' "$url/health"
kill -CONT "$kiosk"
becomes 200 '^(ok|warning)$' "$url/health"
kill "$kiosk"
wait "$kiosk"
becomes 503 '^critical: The display program does not respond: It is not running' "$url/health"
[ ! -e "$work/kiosk" ] || fail "the kiosk left its socket"
