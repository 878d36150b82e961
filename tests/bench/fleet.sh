#!/bin/bash
# 200 terminals at one nginx over TLS on loopback: TERMINALS real fetchers, each with a cache of its own
# and empty. "visits": in each of them a visitor looks at 20 new objects every 4 seconds, 10 times.
# "release": all of them bring all 200 objects at once. "outage": the visits again; after 12 s the server is gone for
# OUTAGE_S seconds. Server and terminals share this machine.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
terminals=${TERMINALS:-200} outage_s=${OUTAGE_S:-15}
tool=build/tests/tools/fetch_tool
make -s build/gopura-fetch "$tool"
folder=$(mktemp -d)
nginx_pid=
trap '[ -z "$nginx_pid" ] || kill "$nginx_pid"; rm -rf "$folder"' EXIT
release=$folder/release run=$folder/run log=$folder/access.log
read -r root bytes < <("$tool" make "$release" 4 50 8000 1)
port=$((20000 + RANDOM % 12000))
server/setup.sh "$release" "$port" "$run" >/dev/null
sed -i "s|access_log off;|log_format fleet '\$bytes_sent \$msec'; access_log $log fleet;|" "$run/nginx.conf"
serve() {
	nginx -p "$run" -e logs/error.log -c nginx.conf &
	nginx_pid=$!
	for _ in $(seq 100); do ! (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break; sleep 0.1; done
}
serve

# Ticks of CPU that nginx and its workers took so far.
server_ticks() {
	cat "/proc/$nginx_pid/stat" $(pgrep -P "$nginx_pid" | sed 's|.*|/proc/&/stat|') |
		awk '{ sum += $14 + $15 } END { print sum }'
}
fleet() { # NAME SPREAD_MS OPTIONS...: a line a terminal, and each object's latency
	local name=$1 spread_ms=$2 i pids=() failed=0 before
	shift 2
	mkdir -p "$folder/$name"
	: >"$log"
	before=$(server_ticks)
	for i in $(seq "$terminals"); do
		(sleep "$((RANDOM % spread_ms))e-3"
		exec "$tool" walk --fetch build/gopura-fetch --release "https://localhost:$port" --ca "$run/ca.pem" \
			--budget 8 --most-s 120 --cache "$folder/$name/$i.db" --root "$root" --bytes "$bytes" \
			--latencies "$folder/$name/$i.ms" "$@" >"$folder/$name/$i.json" 2>"$folder/$name/$i.log") &
		pids+=($!)
	done
	if [ "$name" = outage ]; then
		sleep 12
		kill "$nginx_pid"
		wait "$nginx_pid" || true
		sleep "$outage_s"
		before=0 # of another process
		serve
		date +%s.%N >"$folder/$name/back"
	fi
	for i in "${pids[@]}"; do wait "$i" || failed=$((failed + 1)); done
	echo "$failed $(($(server_ticks) - before)) $(getconf CLK_TCK)" >"$folder/$name/sums"
	cp "$log" "$folder/$name/access"
}
fleet visits 4000 --batch 20 --pause-ms 4000
fleet release 1000
fleet outage 4000 --batch 20 --pause-ms 4000
mkdir -p build/bench
python3 - "$folder" "$terminals" >build/bench/fleet.json <<'P'
import glob, json, sys
folder, terminals = sys.argv[1], int(sys.argv[2])
def at(values, share):
    return values[min(len(values) - 1, int(share * len(values)))]
rows = {"terminals": terminals}
for name in ("visits", "release", "outage"):
    walks = [json.load(open(f)) for f in glob.glob(f"{folder}/{name}/*.json")]
    ms = sorted(int(line) for f in glob.glob(f"{folder}/{name}/*.ms") for line in open(f))
    log = open(f"{folder}/{name}/access").readlines()
    failed, ticks, per_s = map(int, open(f"{folder}/{name}/sums").read().split())
    came, size = sum(w["came"] for w in walks), sum(w["bytes"] for w in walks)
    rows[name] = {
        "failed": failed, "objects": came, "object_mb": round(size / 1e6, 1),
        "received_per_object_byte": round(sum(w["received"] for w in walks) / size, 3),
        "requests": len(log), "requests_per_object": round(len(log) / came, 3),
        "object_ms_p50": at(ms, 0.5), "object_ms_p99": at(ms, 0.99), "object_ms_most": ms[-1],
        "last_terminal_s": round(max(w["ms"] for w in walks) / 1000, 1),
        "sent_mb": round(sum(int(line.split()[0]) for line in log) / 1e6, 1),
        "server_cpu_s": round(ticks / per_s, 1),
    }
# How evenly the terminals come back: requests in each second after the server is there again.
back = float(open(f"{folder}/outage/back").read())
after = [float(line.split()[1]) - back for line in open(f"{folder}/outage/access")]
rows["outage"]["requests_in_second_after"] = [sum(s <= t < s + 1 for t in after) for s in range(30)]
json.dump(rows, sys.stdout)
print()
P
[ "$(python3 -c 'import json; r = json.load(open("build/bench/fleet.json")); print(sum(r[n]["failed"] for n in ("visits", "release", "outage")))')" = 0 ]
