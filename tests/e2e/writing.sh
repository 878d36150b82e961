#!/bin/bash
# Curators write in a real browser (writing.mjs): typing, pasting, two on one page, previews. Its pictures are in
# build/e2e/writing/.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v chromium >/dev/null || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"
work=build/e2e/writing
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content"
for one in ana:editor petra:publisher; do
	echo "password of ${one%:*}" | build/gopura-curator user add "$work/content" "${one%:*}" --role "${one#*:}" >"$work/log"
done
build/gopura-curator "$work/content" --port 0 >"$work/curator.log" 2>&1 &
curator=$!
trap 'kill $curator 2>/dev/null || true' EXIT
wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
port=$(sed -nE 's|.*http://127.0.0.1:([0-9]+)/.*|\1|p' "$work/curator.log")
timeout 240 node tests/e2e/writing.mjs "$port" "$work" || { tail "$work/curator.log"; fail "in the browser"; }
