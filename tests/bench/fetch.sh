#!/bin/bash
# The fetcher on loopback: requests an object, received bytes an object byte, objects a second from
# nginx, from a folder and from the cache. Releases of random objects of 1 to 3 times 4 kB.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
tool=build/tests/tools/fetch_tool
make -s build/gopura-fetch "$tool"
folder=$(mktemp -d)
nginx_pid=
trap '[ -z "$nginx_pid" ] || kill "$nginx_pid"; rm -rf "$folder"' EXIT
release=$folder/release run=$folder/run log=$folder/access.log
read -r root bytes < <("$tool" make "$release" 200 50 8000 1)
port=$((20000 + RANDOM % 12000))
server/setup.sh "$release" "$port" "$run" >/dev/null
sed -i "s|access_log off;|access_log $log;|" "$run/nginx.conf"
nginx -p "$run" -e logs/error.log -c nginx.conf &
nginx_pid=$!
for _ in $(seq 100); do ! (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break; sleep 0.1; done

walk() { # URL CACHE [OPTIONS...]
	local url=$1 cache=$2
	shift 2
	"$tool" walk --fetch build/gopura-fetch --release "$url" --ca "$run/ca.pem" --budget 512 \
		--cache "$folder/$cache" --root "$root" --bytes "$bytes" "$@" 2>/dev/null
}
figure() { sed -E "s/.*\"$1\":(-?[0-9]+).*/\1/" <<<"$2"; }
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.4f", a / b }'; }
per_second() { awk -v a="$(figure came "$1")" -v b="$(figure ms "$1")" 'BEGIN { printf "%d", a * 1000 / b }'; }
asked() { grep -c 'GET /packs/' "$log" || true; }

url=https://localhost:$port
all=$(walk "$url" all.db) asked_all=$(asked)
: >"$log"
sparse=$(walk "$url" sparse.db --every 4) asked_sparse=$(asked)
again=$(walk "$url" all.db)
local=$(walk "$release" local.db)
mkdir -p build/bench
cat >build/bench/fetch.json <<END
{"objects": $(figure came "$all"), "bytes": $(figure bytes "$all"),
 "requests_per_object": $(ratio "$asked_all" "$(figure came "$all")"),
 "requests_per_object_every_fourth_wanted": $(ratio "$asked_sparse" "$(figure came "$sparse")"),
 "received_per_object_byte": $(ratio "$(figure received "$all")" "$(figure bytes "$all")"),
 "received_per_object_byte_every_fourth_wanted": $(ratio "$(figure received "$sparse")" "$(figure bytes "$sparse")"),
 "objects_per_s_nginx": $(per_second "$all"), "objects_per_s_folder": $(per_second "$local"),
 "objects_per_s_cache": $(per_second "$again"),
 "first_object_ms_nginx": $(figure first_ms "$all"), "first_object_ms_cache": $(figure first_ms "$again")}
END
