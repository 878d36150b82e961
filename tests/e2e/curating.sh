#!/bin/bash
# What `make curator` promises, from the printed address to the terminal: a curator signs in, marks a part by strokes, gives
# it a title and a text, and publishes (curating.mjs); the kiosk that runs takes the release up, and a tap on the part opens
# its card. The pictures of each step are in build/curator/.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-curator.sh
work=build/e2e/curating pictures=build/curator
rm -rf "$work" "$pictures"/[1-7]-*.png
mkdir -p "$work" "$pictures"
small_release
cp -a "$small/"{content,release,keys} "$work/" # with the times of its scan, so the hierarchy is still its own
# While nobody is there the camera stays where the curator's begins, so the test knows where the part is on the panel, and
# the kiosk has time for a release on a busy machine.
sed -i '0,/"stay": 7/s//"stay": 120/' "$work/content/tours.json"
build/gopura-content build "$work/content" --out "$work/release" --keys "$work/keys" >"$work/log" 2>&1 || { cat "$work/log"; fail "release 2"; }

FOLDER=$work PORT=0 setsid demo/curator.sh >"$work/curator.log" 2>&1 &
curator=$!
kiosk=
trap 'kill -- -$curator $kiosk 2>/dev/null || true' EXIT
wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
address=$(sed -nE 's|.*(http://127.0.0.1:[0-9]+/).*|\1|p' "$work/curator.log")
password=$(sed -n 's/^Sign in as demo with the password //p' "$work/curator.log")

# ---- a terminal, which is tapped in the middle every 40 s until the card is open; a visitor who is there delays a release
for s in $(seq 40 40 240); do
	printf '%s000 down 0 320 180\n%s080 up 0\n' "$s" "$s" >>"$work/taps.touch"
	echo "$((s + 2))000 tapped-$s" >>"$work/shots.txt"
done
start_kiosk() {
	build/gopura-kiosk --display headless --size 640x360 --release "$work/release" --poll-s 1 --idle-s 5 --log debug \
		--trust "$work/release/root/1.json" --state "$work/state" --touch-replay "$work/taps.touch" \
		--capture "$work/shots" --shots "$work/shots.txt" 2>"$work/kiosk.log" &
	kiosk=$!
	wait_for 60 "first picture" grep -q 'app: showing' "$work/kiosk.log"
}
timeout 120 node tests/e2e/curating.mjs write "$address" "$password" "$pictures" || { tail "$work/curator.log"; fail "marking and writing"; }
echo "written after $SECONDS s"
start_kiosk
timeout 120 node tests/e2e/curating.mjs publish "$address" "$password" "$pictures" || { tail "$work/curator.log"; fail "publishing"; }
echo "published after $SECONDS s"
wait_for 120 "release 3 on the panel" sh -c "[ \$(grep -c 'app: showing' '$work/kiosk.log') -ge 2 ]"
echo "on the panel after $SECONDS s"
wait_for 200 "card of the new part" grep -q 'app: card of corner-of-the-gallery' "$work/kiosk.log"
echo "tapped after $SECONDS s"
picture() { [ "$(ls "$work"/shots/*.png 2>/dev/null | wc -l)" -ge "$(grep -c 'app: card of' "$work/kiosk.log")" ]; }
wait_for 20 "picture of the card" picture
sleep 1 # until the last one is written
cp "$(ls -t "$work"/shots/*.png | head -n 1)" "$pictures/7-card.png"
kill "$kiosk"
wait "$kiosk" || fail "the kiosk did not end well"
kiosk=
