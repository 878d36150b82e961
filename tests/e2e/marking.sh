#!/bin/bash
# Curators mark parts at the same time in real browsers (marking.mjs): none of them overwrites what another one has saved,
# and what is not saved is not left without a question.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v chromium >/dev/null || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"
work=build/e2e/marking
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content" # with the times of its scan, so the hierarchy is still its own
for one in ana:editor petra:publisher; do
	echo "password of ${one%:*}" | build/gopura-curator user add "$work/content" "${one%:*}" --role "${one#*:}" >"$work/log"
done
build/gopura-curator "$work/content" --port 0 >"$work/curator.log" 2>&1 &
curator=$!
trap 'kill $curator 2>/dev/null || true' EXIT
wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
port=$(sed -nE 's|.*http://127.0.0.1:([0-9]+)/.*|\1|p' "$work/curator.log")
timeout 240 node tests/e2e/marking.mjs "$port" "$curator" "$work" || { tail "$work/curator.log"; fail "in the browser"; }
