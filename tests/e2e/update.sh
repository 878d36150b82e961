#!/bin/bash
# A content update while the kiosk runs: version 2 arrives in the background and is switched to at once because nobody
# is there; a bad signature, an older sequence and a server that dies leave the current release; a kiosk that remembers
# a release that no longer exists anywhere shows the next one.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/update
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content"
cp -a "$small/release" "$work/release"
cp -a "$work/release" "$work/release1"
serve "$work/release" "$work/server"
start_kiosk() {
	build/gopura-kiosk --display headless --size 320x180 --release "$url" --ca "$ca" --poll-s 1 \
		--log debug --trust "$work/release/root/1.json" --state "$work/state" 2>"$1" &
	pid=$!
}
start_kiosk "$work/kiosk.log"
trap 'kill $pid 2>/dev/null || true; stop_server' EXIT
shown() { [ "$(grep -c 'is shown' "$work/kiosk.log")" -ge "$1" ]; }
wait_for 60 "first release" shown 1

# ---- a release.json whose signature is not the publisher's
cp "$work/release/release.json" "$work/good.json"
python3 - "$work/release/release.json" <<'P'
import base64, json, sys
envelope = json.load(open(sys.argv[1]))
signature = bytearray(base64.b64decode(envelope["signatures"][0]["signature"]))
signature[5] ^= 1
envelope["signatures"][0]["signature"] = base64.b64encode(signature).decode()
json.dump(envelope, open(sys.argv[1], "w"))
P
wait_for 20 "refusal of a bad signature" grep -q 'refused release.json' "$work/kiosk.log"
cp "$work/good.json" "$work/release/release.json"

# ---- version 2: a page says something else
sed -i 's/<h1>/<h1>New: /' "$work"/content/pages/*.en.html
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys"
wait_for 90 "version 2" shown 2
on_panel() { [ "$(grep -c 'app: showing' "$work/kiosk.log")" = "$1" ]; }
wait_for 20 "version 2 on the panel" on_panel 2 # remembered first, then shown, by two threads

# ---- an older release is offered
cp "$work/release/release.json" "$work/release/timestamp.json" "$work/"
cp "$work/release1/release.json" "$work/release1/timestamp.json" "$work/release/"
wait_for 20 "refusal of an older release" grep -q 'refused timestamp.json: .*older' "$work/kiosk.log"
kill -0 "$pid" || fail "the kiosk ended"

# ---- the server dies: the kiosk stays, and rests (a frame is several switches of context)
stop_server
wait_for 60 "notice that the server is gone" grep -q 'does not answer: offline' "$work/kiosk.log"
switches() { awk '/^voluntary_ctxt/ { print $2 }' "/proc/$pid/status"; }
is_at_rest() {
	local before
	before=$(switches)
	sleep 3
	[ $(($(switches) - before)) -lt 60 ]
}
wait_for 60 "rest without a server" is_at_rest
kill "$pid"
wait "$pid" || fail "the kiosk did not end well"
[ "$(grep -c 'is shown' "$work/kiosk.log")" = 2 ] || fail "something else was chosen"
on_panel 2 || fail "something else was shown"

# ---- version 3 is published, what the kiosk remembers is gone from server and cache
find "$work/release/locator" -type f -delete
rm -f "$work"/state/cache.db*
cp "$work/release.json" "$work/timestamp.json" "$work/release/"
sed -i 's/<h1>/<h1>Newer: /' "$work"/content/pages/*.en.html
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys"
serve "$work/release" "$work/server"
start_kiosk "$work/kiosk3.log"
wait_for 60 "version 3 in place of one that is gone" grep -q 'release .* is shown' "$work/kiosk3.log"
kill "$pid"
wait "$pid" || fail "the kiosk did not end well after a release that was gone"
