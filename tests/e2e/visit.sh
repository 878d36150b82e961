#!/bin/bash
# A visit with real nginx: turn, zoom, touch a part, read its page; the server is killed half-way and comes back, the
# fetcher is killed, and the visitor notices nothing. Afterwards the kiosk starts from its cache without a network.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/visit
rm -rf "$work"
mkdir -p "$work"
small_release
serve "$small/release" "$work/server"

kiosk=(build/gopura-kiosk --display headless --size 1280x720 --release "$url" --ca "$ca"
	--trust "$small/release/root/1.json" --state "$work/state" --log debug)
"${kiosk[@]}" --touch-replay demo/visit.touch --quit-after-replay --shots demo/visit.shots \
	--capture "$work/shots" 2>"$work/kiosk.log" &
pid=$!
wait_for 60 "first picture" grep -q 'app: showing' "$work/kiosk.log"
sleep 8
stop_server; echo "server killed"
sleep 3
pkill -9 -P "$pid" gopura-fetch || fail "there was no fetcher to kill"
sleep 4
serve "$small/release" "$work/server" "$port"; echo "server back"
wait "$pid" || { tail -30 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
grep -q 'the fetcher is disconnected' "$work/kiosk.log" || fail "the fetcher's death went unnoticed"
grep -q 'app: card of' "$work/kiosk.log" || { tail -30 "$work/kiosk.log"; fail "no card was opened"; }
grep -q 'app: page of' "$work/kiosk.log" || { tail -30 "$work/kiosk.log"; fail "no page was opened"; }
[ "$(ls "$work/shots"/*.png | wc -l)" = "$(grep -vc '^#' demo/visit.shots)" ] || fail "shots are missing"

# ---- no network at all, and no server's name even
stop_server
echo '12000 offline' >"$work/offline.shots"
timeout 60 build/gopura-kiosk --display headless --size 1280x720 --release https://localhost:9/ --ca "$ca" \
	--state "$work/state" --touch-replay tests/e2e/nothing.touch --quit-after-replay \
	--shots "$work/offline.shots" --capture "$work/shots" 2>"$work/offline.log" ||
	{ tail -30 "$work/offline.log"; fail "the kiosk does not start without network"; }
grep -q 'app: showing' "$work/offline.log" || fail "nothing was shown without network"
python3 tests/e2e/tones.py "$work/shots/offline.png" 300
python3 tests/e2e/tones.py "$work/shots/1-far.png" 300
