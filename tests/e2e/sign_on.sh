#!/bin/bash
# A museum's own sign-on: nginx with server/curator.conf asks a stand-in who it is, and gopura-curator, on a Unix socket,
# believes nginx. Beside it, that gopura-curator believes nobody else.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v nginx >/dev/null || skip "nginx is not installed"
nginx -V 2>&1 | grep -q http_auth_request_module || skip "nginx has no auth_request"
work=$PWD/build/e2e/sign_on
rm -rf "$work"
mkdir -p "$work/logs"
small_release
cp -a "$small/content" "$work/content"
pids=
trap '[ -z "$pids" ] || kill $pids 2>/dev/null || true' EXIT
free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'; }

for one in ana:publisher rolf:reader; do
	build/gopura-curator user add "$work/content" "${one%:*}" --role "${one#*:}" --no-password
done

# ---- a header is believed only where a proxy on this machine can be the one who sends it
for listen in 0.0.0.0 192.0.2.1; do
	status=0
	build/gopura-curator "$work/content" --port 0 --listen "$listen" --sign-on Remote-User 2>"$work/log" || status=$?
	[ "$status" = 2 ] || fail "it would believe everybody at $listen"
done
for header in Authorization 'Remote User' 'Remote-User:'; do
	! build/gopura-curator "$work/content" --port 0 --sign-on "$header" 2>"$work/log" || fail "it takes the header $header"
done

socket=$work/socket
[ ${#socket} -lt 100 ] || socket=$(mktemp -d)/socket
build/gopura-curator "$work/content" --listen "unix:$socket" --host curator.museum.example --sign-on Remote-User \
	>"$work/curator.log" 2>&1 &
pids="$pids $!"
wait_for 60 "curator" grep -q 'a proxy serves it' "$work/curator.log"

# ---- nginx, with the configuration that the documentation names
port=$(free_port) verify=$(free_port)
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=curator.museum.example \
	-keyout "$work/key.pem" -out "$work/cert.pem" 2>/dev/null
{
	[ "$(id -u)" != 0 ] || echo "user root;"
	echo "daemon off; pid $work/nginx.pid; error_log $work/logs/error.log;"
	echo "events {} http { access_log off;"
	for kind in client_body proxy fastcgi uwsgi scgi; do echo "${kind}_temp_path $work/temp-$kind;"; done
	sed -e "s|listen 443 |listen 127.0.0.1:$port |" -e "s|/etc/ssl/curator.pem|$work/cert.pem|" \
		-e "s|/etc/ssl/curator.key|$work/key.pem|" -e "s|/run/gopura-curator/socket|$socket|" \
		-e "s|127.0.0.1:9091|127.0.0.1:$verify|" server/curator.conf
	echo "}"
} >"$work/nginx.conf"
python3 tests/e2e/sign_on.py stand-in "$verify" >"$work/stand-in.log" 2>&1 &
pids="$pids $!"
nginx -p "$work" -c "$work/nginx.conf" >"$work/nginx.log" 2>&1 &
pids="$pids $!"
wait_for 20 "stand-in" curl -s "http://127.0.0.1:$verify/" -o /dev/null
wait_for 20 "nginx" curl -sk "https://127.0.0.1:$port/" -o /dev/null
python3 tests/e2e/sign_on.py check "$port" || { cat "$work/curator.log" "$work/logs/error.log" | tail -20; fail "the sign-on"; }

# ---- whoever reaches the socket without nginx has no name, and no other host is served
code() { curl -s -o /dev/null -w '%{http_code}' --unix-socket "$socket" "$@"; }
[ "$(code http://curator.museum.example/api/parts)" = 401 ] || fail "it lets somebody without a name in"
[ "$(code -H 'Remote-User: eve' http://curator.museum.example/api/parts)" = 401 ] || fail "it lets a stranger in"
[ "$(code -H 'Remote-User: ana' http://other.example/api/parts)" = 403 ] || fail "it serves another host"
