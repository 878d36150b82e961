#!/bin/bash
# The attacks that The Update Framework names (specification 1.0.34, section 1.5.2), each on a kiosk with its fetcher and
# nginx: the terminal keeps the release that it has, says what it refused, and takes the next honest one. The attacker
# has the web server; where it is said, also stolen keys.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-tuf.sh
tuf_work build/e2e/tuf_attacks
publish one
"$content" keys "$work/content" --keys "$keys" --tuf >/dev/null
for n in 2 3 4 5 6 7 8; do
	publish "$n"
	cp -a "$release" "$work/$n"
done
# Strangers have other keys for each role, the publisher's successors for all but the root.
for who in strangers successors; do
	cp -a "$keys" "$work/$who"
	for role in root release timestamp; do
		[ "$who $role" = "successors root" ] ||
			sed -i "s/[0-9a-f]\{64\}/$(printf "$who $role" | sha256sum | cut -c 1-64)/" "$work/$who/$role.key"
	done
done
sign() { tests/e2e/tuf_sign.py "$work/$1" "$next" "${@:2}"; }

# prepare N: a copy of release N to be changed; offer: it is served from now on.
next=$work/next
prepare() {
	rm -rf "$next"
	cp -a "$work/$1" "$next"
}
offer() {
	rm -rf "$work/gone"
	[ ! -e "$release" ] || mv "$release" "$work/gone"
	mv "$next" "$release"
}
# shows N: by the terminal's metrics.
shows() { [ "$(figure hall gopura_kiosk_release_sequence)" = "$1" ]; }
begin() { echo "$*"; count=$(figure hall gopura_kiosk_refusals_total); }
# refuses WHY: the terminal has refused something since `begin`, its metrics say why, and it shows what it had.
refused_since() { [ "$(figure hall gopura_kiosk_refusals_total)" -gt "$count" ] && why hall | grep -qE "$1"; }
refuses() {
	wait_for 20 "refusal: $1" refused_since "$1"
	shows "$has" || fail "it shows another release"
}
# fetch_lacks FILE [WHY]: the fetcher's metrics say that it did not get the file.
fetch_lacks() { metrics hall-fetch | grep "^gopura_fetch_refusal_info{what=\"$1\"" | grep -q "${2:-}"; }
honest() { # N: the next honest release is taken
	prepare "$1"
	offer
	wait_for 20 "the honest release $1" shows "$1"
	has=$1
}

# slow_server NAME: nginx has tuf/NAME from a server that sends a byte in five seconds.
slow_server() {
	python3 - "$work/slow" <<-'P' &
		import pathlib, socket, sys, threading, time
		def drip(client):
		    try:
		        client.recv(4096)
		        client.sendall(b"HTTP/1.1 200 OK\r\nContent-Length: 400\r\n\r\n{")
		        for _ in range(399):
		            time.sleep(5)
		            client.sendall(b" ")
		    except OSError:
		        client.close()
		listener = socket.create_server(("127.0.0.1", 0))
		pathlib.Path(sys.argv[1]).write_text(str(listener.getsockname()[1]))
		while True:
		    threading.Thread(target=drip, args=[listener.accept()[0]], daemon=True).start()
	P
	pids[slow]=$!
	wait_for 10 "the slow server" test -s "$work/slow"
	cp "$work/server/nginx.conf" "$work/nginx.conf"
	sed -i "s|^\t\t# A release has no other files|\t\tlocation = /tuf/$1 { proxy_pass http://127.0.0.1:$(cat "$work/slow"); proxy_buffering off; }\n&|" \
		"$work/server/nginx.conf"
	kill -HUP "$server_pid"
	sleep 0.5
}
end_slow_server() {
	cp "$work/nginx.conf" "$work/server/nginx.conf"
	kill -HUP "$server_pid"
	kill "${pids[slow]}"
	unset "pids[slow]"
}

prepare 2
offer
serve "$release" "$work/server"
export LD_PRELOAD=$PWD/build/tests/tools/set_clock.so # expiry is judged
terminal hall "$keys/tuf/1.root.json"
unset LD_PRELOAD
wait_for 60 "the first release" shown hall 1
wait_for 20 "the first release in the metrics" shows 2
has=2

begin "arbitrary installation: another release, signed by strangers"
prepare 3
sign strangers set 3.targets.json 'expires="2049-01-01T00:00:00Z"'
sign strangers chain
offer
refuses 'timestamp version 4: fewer valid signatures than its threshold'

begin "malicious mirror: pages in place of files, then nothing"
echo '<html>out of order</html>' >"$release/tuf/timestamp.json"
refuses 'timestamp: '
rm "$release/tuf/timestamp.json"
wait_for 20 "a missing timestamp in the fetcher's metrics" fetch_lacks tuf/timestamp.json
shows 2 || fail "it shows another release"

begin "indefinite freeze: a timestamp that has expired"
prepare 3
sign keys set timestamp.json 'expires="2026-01-01T00:00:00Z"' version=90
offer
refuses 'timestamp version 90 has expired'

begin "mix-and-match: the snapshot of release 2 under the timestamp of release 3"
prepare 3
cp "$work/2/tuf/2.snapshot.json" "$next/tuf/3.snapshot.json"
offer
refuses 'snapshot: not of the length and hashes that the timestamp names'

begin "extraneous dependencies: a target beside the release that nobody signed"
prepare 3
sed -i 's/"targets":{/&"extra":{"hashes":{"sha256":"5a"},"length":1},/' "$next/tuf/3.targets.json"
offer
refuses '3.targets.json: .*too large|targets: not of the length and hashes that the snapshot names'

begin "arbitrary installation: other bytes in the place of the signed release.json"
prepare 3
tests/tools/flip_byte.sh "$(ls -t "$next"/tuf/targets/*.json | while read -r file; do cmp -s "$file" "$work/3/release.json" && echo "$file"; done)" 30
offer
refuses 'release.json is not the target that was signed'

begin "endless data: a root of two gigabytes, then a timestamp"
truncate -s 2G "$release/tuf/2.root.json"
before=$(figure hall-fetch gopura_fetch_received_bytes_total) requests=$(figure hall-fetch gopura_fetch_requests_total)
refuses '2.root.json: .*too large'
rm "$release/tuf/2.root.json"
truncate -s 2G "$release/tuf/timestamp.json"
wait_for 20 "a large timestamp in the fetcher's metrics" fetch_lacks tuf/timestamp.json 'larger than the limit'
each=$((($(figure hall-fetch gopura_fetch_received_bytes_total) - before) / ($(figure hall-fetch gopura_fetch_requests_total) - requests)))
echo "$each bytes for each request" # with what nginx had sent when the request was ended, on loopback
[ "$each" -lt 16000000 ] || fail "it received $each bytes for each request"

begin "slow retrieval: a byte in five seconds, behind nginx"
prepare 4
slow_server 4.snapshot.json
offer
before=$(figure hall-fetch gopura_fetch_errors_total)
given_up() { [ "$(figure hall-fetch gopura_fetch_errors_total)" -ge $((before + 2)) ]; }
wait_for 30 "two requests that were given up" given_up
shows 2 || fail "it shows another release"
end_slow_server
honest 4

begin "wrong installation: a signed target, but for another terminal; by stolen keys"
prepare 5
sign keys set 5.targets.json 'targets={"elsewhere/release.json":{"length":1,"hashes":{"sha256":"'"$(printf 5a%.0s $(seq 32))"'"}}}'
sign keys chain
offer
refuses 'there is no target release.json'
honest 7 # the thief's timestamp has the version of release 6

begin "rollback: all files as they were three releases ago"
prepare 4
offer
refuses 'timestamp 4 is older than 7'

begin "fast-forward: versions that the publisher cannot surpass, by stolen keys"
prepare 7
sign keys set 7.snapshot.json version=2000000000
sign keys rename 7.snapshot.json 2000000000.snapshot.json
sign keys set timestamp.json version=2000000000
sign keys chain
offer
taken() { [ "$(figure hall gopura_kiosk_trust_timestamp_version)" = 2000000001 ]; }
wait_for 20 "the thief's timestamp" taken
prepare 8
offer
refuses 'timestamp 8 is older than 2000000001'
echo "its recovery: the next root has other keys in place of those stolen"
prepare 8
sign successors root
sign successors set 8.targets.json
sign successors chain
offer
wait_for 20 "the release under the next root" shows 8
said hall 'root 2 revokes keys' || fail "it does not say that keys are revoked"
stop_terminal hall
