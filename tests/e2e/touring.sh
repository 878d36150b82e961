#!/bin/bash
# Curators make tours in a real browser (touring.mjs): stops from the eye, their order, words, playing, two at once, going
# back; gopura-content takes what was saved. Its pictures are in build/e2e/touring/.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-curator.sh
work=build/e2e/touring
serve_curator ana:editor petra:publisher rolf:reader
in_browser touring.mjs "$port" "$work"
kill "$curator"
wait "$curator" || fail "it did not end well"
! grep -qE '[5-8] are$' "$work/curator.log" || fail "pages that were left are still connected"

# ---- a build finds no fault in what was saved
build/gopura-content build "$work/content" --dry-run >"$work/log" 2>&1 || { cat "$work/log"; fail "its tours are refused"; }
grep -q 'A short way' "$work/content/tours.json" || fail "the new tour is not in tours.json"
