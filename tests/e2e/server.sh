#!/bin/bash
# The museum server as set up by server/: what it serves, how, and what it refuses.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib-server.sh
folder=$(mktemp -d)
trap 'stop_server; rm -rf "$folder"' EXIT
release="$folder/a release" run=$folder/run
mkdir -p "$release/packs" "$release/locator" "$release/root" "$release/secret"
pack=packs/0123456789abcdef0123456789abcdef
head -c 300000 /dev/urandom >"$release/$pack"
echo locator >"$release/locator/0123456789abcdef0123456789abcdef"
for file in release.json timestamp.json root/1.json; do echo '{}' >"$release/$file"; done
echo hidden >"$release/secret/file"
start_server "$release" "$run"

fail() { echo "FAIL: $*" >&2; exit 1; }
get() { curl -sS --max-time 20 --cacert "$server_ca" "$@"; }

# has NAME PATTERN PATH: a response header.
has() { get -I "$server_url$3" | tr -d '\r' | grep -qiE "^$1: $2\$" || fail "$3: $1 is not $2"; }

[ "$(get -o "$folder/got" -w '%{http_version} %{http_code}' "$server_url$pack")" = "2 200" ] || fail "no HTTP/2"
cmp "$folder/got" "$release/$pack"
[ "$(get -o "$folder/got" -w '%{http_code}' -r 1000-1999 "$server_url$pack")" = 206 ] || fail "no ranges"
cmp "$folder/got" <(tail -c +1001 "$release/$pack" | head -c 1000)
has cache-control '.*immutable' "$pack"
has cache-control '.*immutable' locator/0123456789abcdef0123456789abcdef
has content-type application/octet-stream "$pack"
has x-content-type-options nosniff "$pack"
[ "$(get -I "$server_url$pack" | wc -c)" -lt 256 ] || fail "what is said beside a range is long"
for file in release.json timestamp.json root/1.json; do
	has cache-control no-cache "$file"
	has content-type application/json "$file"
	has x-content-type-options nosniff "$file"
	has etag '.*' "$file"
done

# An atomic switch is seen by the very next request.
echo '{"new":1}' >"$release/new" && mv "$release/new" "$release/release.json"
[ "$(get "${server_url}release.json")" = '{"new":1}' ] || fail "an old release.json is served"

# refused STATUS CURL_ARGUMENTS...
refused() {
	local want=$1 got
	shift
	got=$(get -o /dev/null -w '%{http_code}' "$@")
	[ "$got" = "$want" ] || fail "$* answered $got, not $want"
}
refused 404 "${server_url}secret/file"
refused 404 "${server_url}"
refused 404 "${server_url}packs/"
refused 404 "${server_url}packs/ffffffffffffffffffffffffffffffff"
refused 404 --path-as-is "${server_url}packs/../secret/file"
refused 403 -X POST -d x "${server_url}release.json"
refused 403 -X DELETE "$server_url$pack"
get -I "${server_url}packs/ffffffffffffffffffffffffffffffff" | grep -qi immutable && fail "a 404 may be kept for ever"
curl -sS --max-time 20 "${server_url}release.json" >/dev/null 2>&1 && fail "trusted without the CA"
[ "$(stat -c %a "$run/tls")" = 700 ] || fail "the CA's key is readable"

# Each round of a terminal asks for the next root, for years.
refused 404 "${server_url}root/2.json"
refused 404 "${server_url}tuf/2.root.json"
! grep 'root' "$run/logs/error.log" || fail "a root that is not there yet fills the log"
grep -q 'packs/f' "$run/logs/error.log" || fail "a pack that is missing is not in the log"

# The same certificate after a restart; a signal ends all of it.
before=$(sha256sum <"$run/tls/server.pem") port=${server_url%/} port=${port##*:}
stop_server
curl -s --max-time 5 --cacert "$server_ca" "${server_url}release.json" >/dev/null && fail "still listening"
start_server "$release" "$run" "$port"
[ "$(sha256sum <"$run/tls/server.pem")" = "$before" ] || fail "another certificate"
get "${server_url}release.json" >/dev/null
server/serve.sh "$release" "$port" "$folder/run2" >"$folder/second.log" 2>&1 && fail "two on one port"
grep -q "port $port" "$folder/second.log" || fail "the message does not name the port"

# The authority outlives the terminals; of one that does not, setup warns, and signs nothing that would outlive it. Terminals
# may trust two at once, for the change.
lasts() { openssl x509 -in "$1" -noout -checkend $(($2 * 86400)) >/dev/null; }
setup() { server/setup.sh "$release" 443 "$folder/run2" "$@" 2>&1; }
lasts "$run/ca.pem" 10900 || fail "the authority ends too soon"
! setup | grep WARNING || fail "a new authority is warned of"
openssl req -x509 -new -key "$folder/run2/tls/ca.key" -sha256 -days 300 -subj "/CN=old" -out "$folder/run2/ca.pem"
setup another.name | grep -q 'WARNING: the certificate authority .* ends on' || fail "no warning of an authority that ends"
openssl verify -CAfile "$folder/run2/ca.pem" "$folder/run2/tls/server.pem" >/dev/null || fail "not signed by it"
lasts "$folder/run2/tls/server.pem" 298 || fail "a certificate that ends too soon"
! lasts "$folder/run2/tls/server.pem" 300 || fail "a certificate that outlives its authority"
rm -r "$folder/run2"
cat "$run/ca.pem" >"$folder/both.pem"
stop_server
start_server "$release" "$folder/run2"
cat "$folder/run2/ca.pem" >>"$folder/both.pem"
for one in "$run" "$folder/run2"; do
	stop_server
	start_server "$release" "$one"
	server_ca=$folder/both.pem
	get "${server_url}release.json" >/dev/null || fail "two authorities in one file: $one is not reached"
done
echo "the server serves releases and nothing else"
