#!/bin/bash
# Curators make tours in a real browser (touring.mjs): stops from the eye, their order, words, playing, two at once, going
# back; gopura-content takes what was saved. Its pictures are in build/e2e/touring/.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v chromium >/dev/null || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"
work=build/e2e/touring
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content" # with the times of its scan, so the hierarchy is still its own
for one in ana:editor petra:publisher rolf:reader; do
	echo "password of ${one%:*}" | build/gopura-curator user add "$work/content" "${one%:*}" --role "${one#*:}" >"$work/log"
done
build/gopura-curator "$work/content" --port 0 >"$work/curator.log" 2>&1 &
curator=$!
trap 'kill $curator 2>/dev/null || true' EXIT
wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
port=$(sed -nE 's|.*http://127.0.0.1:([0-9]+)/.*|\1|p' "$work/curator.log")
timeout 240 node tests/e2e/touring.mjs "$port" "$work" || { tail "$work/curator.log"; fail "in the browser"; }
kill "$curator"
wait "$curator" || fail "it did not end well"
! grep -qE '[5-8] are$' "$work/curator.log" || fail "pages that were left are still connected"

# ---- a build finds no fault in what was saved
build/gopura-content build "$work/content" --dry-run >"$work/log" 2>&1 || { cat "$work/log"; fail "its tours are refused"; }
grep -q 'A short way' "$work/content/tours.json" || fail "the new tour is not in tours.json"
