#!/bin/bash
# The two addresses of gopura.conf in the service manager's files: an address is passed on, any other text is not.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=$PWD/build/e2e/addresses
rm -rf "$work"
mkdir -p "$work/bin" "$work/from"
printf '#!/bin/sh\necho "$*" >>"%s/said"\n' "$work" >"$work/bin/systemctl"
chmod +x "$work/bin/systemctl"

# give HEALTH FETCH: what gopura-setup wrote; said: what the manager was told
give() {
	printf "$1" >"$work/from/health-address"
	printf "$2" >"$work/from/fetch-address"
	: >"$work/said"
	PATH=$work/bin:$PATH FROM=$work/from TO=$work/to sh image/root/usr/lib/gopura/gopura-health-address >"$work/log" 2>&1
}
listen=$work/to/gopura-health.socket.d/listen.conf server=$work/to/gopura-fetch.service.d/server.conf

give '192.168.1.2:9100\n' ''
grep -qx 'ListenStream=192.168.1.2:9100' "$listen" || fail "the health page's address is not taken"
[ ! -e "$server" ] || fail "an address is allowed that nobody named"
[ "$(cat "$work/said")" = daemon-reload ] || fail "the fetcher is restarted for nothing"

give '[fe80::1]:9100\n' '169.254.7.9\n'
[ "$(cat "$server")" = "$(printf '[Service]\nIPAddressAllow=169.254.7.9')" ] || fail "a server that is link-local is not allowed"
grep -q 'try-restart gopura-fetch.service' "$work/said" || fail "the fetcher goes on without its address"

give '[fe80::1]:9100\n' '169.254.7.9\n'
! grep -q restart "$work/said" || fail "the fetcher is restarted though nothing changed"

for text in 'any\n' '0.0.0.0/0\n' '1.2.3.4\nExecStart=/bin/sh\n' '1.2.3.4 5.6.7.8\n' '%%i\n'; do
	give "$text" "$text"
	[ ! -e "$listen" ] && [ ! -e "$server" ] || fail "this is no address: $text"
done
