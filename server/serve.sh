#!/bin/bash
# Serves a release folder with nginx over TLS and HTTP/2, in the foreground; a signal ends it.
#
#   server/serve.sh RELEASE PORT RUN [NAME ...]
#
# Calls server/setup.sh. PORT 0 takes a free port. When nginx listens, RUN/url holds the address and RUN/ca.pem the
# certificate authority to trust:
#
#   curl --cacert RUN/ca.pem "$(cat RUN/url)release.json"
set -eu
[ "${1:-}" != --help ] || { sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0; }
[ $# -ge 3 ] || { "$0" --help >&2; exit 2; }
here=$(cd "$(dirname "$0")" && pwd)
command -v nginx >/dev/null || { echo "serve.sh: nginx is missing (Debian: nginx-light)" >&2; exit 1; }
release=$1 port=$2 run=$3
shift 3
host=localhost at=127.0.0.1 # where this machine reaches it
case ${GOPURA_LISTEN:-} in
'' | 0.0.0.0 | 127.0.0.1) ;;
'[::]') at=::1 ;;
*) host=$GOPURA_LISTEN at=${GOPURA_LISTEN#[} at=${at%]} ;;
esac
taken() { (exec 3<>"/dev/tcp/$at/$1") 2>/dev/null; }
if [ "$port" = 0 ]; then
	port=$((20000 + RANDOM % 12000))
	while taken "$port"; do port=$((20000 + RANDOM % 12000)); done
elif taken "$port"; then
	echo "serve.sh: port $port is in use; give another one, or 0 for a free port" >&2
	exit 1
fi
mkdir -p "$run"
rm -f "$run/url"
"$here/setup.sh" "$release" "$port" "$run" "$@"
run=$(cd "$run" && pwd)
echo "serving $release"
echo "url https://$host:$port/"
echo "ca $run/ca.pem"
# A child process writes the file once the port answers, so a program that waits for the file also waits for the server.
(for _ in $(seq 100); do
	if taken "$port"; then
		echo "https://$host:$port/" >"$run/url.new"
		mv "$run/url.new" "$run/url"
		break
	fi
	sleep 0.1
done) &
exec nginx -p "$run" -e logs/error.log -c nginx.conf
