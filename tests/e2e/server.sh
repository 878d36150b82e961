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
# An authority that is missing or damaged is never replaced by one that no terminal knows.
for damage in 'rm ca.pem' ': >ca.pem'; do
	cp "$folder/run2/ca.pem" "$folder/kept.pem"
	(cd "$folder/run2" && eval "$damage")
	said=$(setup) && fail "another authority after: $damage"
	grep -q "run2/ca.pem is missing or damaged" <<<"$said" || fail "after $damage it says: $said"
	cp "$folder/kept.pem" "$folder/run2/ca.pem"
	setup >"$folder/log" || fail "after $damage the old authority does not come back: $(cat "$folder/log")"
done
mv "$folder/run2/tls/ca.key" "$folder/ca.key"
setup third.name | grep -q 'tls/ca.key is missing' || fail "no word of a key that is missing"
mv "$folder/ca.key" "$folder/run2/tls/ca.key"
cp "$folder/run2/ca.pem" "$folder/kept.pem"
mv "$folder/run2/tls" "$folder/tls" # as on another machine that got what terminals have
setup | grep -q 'tls/ca.key is missing' || fail "no word of a folder tls that is missing"
cmp "$folder/run2/ca.pem" "$folder/kept.pem" || fail "another authority in the place of one whose key is missing"
rm -r "$folder/run2/tls"
mv "$folder/tls" "$folder/run2/tls"

# A disk that is full, or a kill, in the middle of it: the next start makes it whole.
mkdir "$folder/bin"
cat >"$folder/bin/openssl" <<-IN
	#!/bin/sh
	case "\$*" in *"\$FAILS"*) exit \$STATUS ;; esac
	exec $(command -v openssl) "\$@"
IN
chmod +x "$folder/bin/openssl"
! (PATH=$folder/bin:$PATH FAILS='x509 -req' STATUS=1 setup third.name) >"$folder/log" || fail "a certificate that was not made"
setup another.name >"$folder/log" || fail "after a certificate that was not made: $(cat "$folder/log")"
rm -r "$folder/run2"
! (PATH=$folder/bin:$PATH FAILS='req -x509' STATUS=0 setup) >"$folder/log" || fail "an authority that was not written"
setup >"$folder/log" || fail "after an authority that was not written: $(cat "$folder/log")"

# Addresses of both kinds, and another one to listen at.
setup 192.0.2.7 2001:db8::5 >"$folder/log" || fail "two addresses: $(cat "$folder/log")"
openssl x509 -in "$folder/run2/tls/server.pem" -noout -ext subjectAltName | grep -q 'IP Address:192.0.2.7, IP Address:2001:DB8:0:0:0:0:0:5' ||
	fail "the addresses are not in the certificate"
stop_server
GOPURA_LISTEN=127.0.0.2 start_server "$release" "$folder/run2" 0 127.0.0.2
[ "${server_url#https://127.0.0.2:}" != "$server_url" ] || fail "the address is $server_url"
get "${server_url}release.json" >/dev/null || fail "it does not listen where it should"
stop_server
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
