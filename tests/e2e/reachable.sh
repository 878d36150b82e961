#!/bin/bash
# The curator's pages for everyone: a part is marked, written about and published with the keyboard alone; axe finds nothing
# to complain of in any view, in light and dark, on a desk and on a tablet (reachable.mjs). The views' pictures are in
# build/curator/.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-curator.sh
work=build/e2e/reachable pictures=build/curator
rm -rf "$work" "$pictures"/view-*.png
mkdir -p "$work" "$pictures"
small_release
cp -a "$small/"{content,release,keys} "$work/" # with the times of its scan, so the hierarchy is still its own
status=0
axe=$(tests/tools/axe.sh) || status=$?
[ "$status" = 0 ] || [ "$status" = 77 ] || fail "axe"

FOLDER=$work PORT=0 setsid demo/curator.sh >"$work/curator.log" 2>&1 &
curator=$!
trap 'kill -- -$curator 2>/dev/null || true' EXIT
wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
address=$(sed -nE 's|.*(http://127.0.0.1:[0-9]+/).*|\1|p' "$work/curator.log")
password=$(sed -n 's/^Sign in as demo with the password //p' "$work/curator.log")
timeout 240 node tests/e2e/reachable.mjs "$address" "$password" "$pictures" "$axe" || { tail "$work/curator.log"; fail "in the browser"; }
[ -n "$axe" ] || skip "the keyboard reaches everything, but axe-core could not be fetched"
