#!/bin/bash
# A rate limit that would take minutes for the first picture: objects of the shown release arrive at once nevertheless,
# those of a new release do not.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/rate
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content"
cp -a "$small/release" "$work/release"
fetch= kiosk= log=$work/kiosk.log
trap 'kill -9 $fetch $kiosk 2>/dev/null || true' EXIT
says() { grep -qE "$1" "$log"; }

start_fetch() { # OPTION...
	build/gopura-fetch --release "$work/release" --cache "$work/cache.db" --socket "$work/socket" --poll-s 1 "$@" \
		2>>"$work/fetch.log" &
	fetch=$!
}
start_fetch --rate-limit 1
build/gopura-kiosk --display headless --size 320x180 --socket "$work/socket" --trust "$work/release/root/1.json" \
	--poll-s 1 --state "$work/state" --log debug 2>"$log" &
kiosk=$!
wait_for 60 "whole picture beside the limit" says 'the picture has settled'
bytes=$(cat "$work"/cache.db* | wc -c)
[ "$bytes" -gt $((60 * 1024 * 2)) ] || fail "the picture took $bytes bytes: too few for this test to tell anything"

sed -i 's/<h1>/<h1>New: /' "$work"/content/pages/*.en.html
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >/dev/null
wait_for 30 "the next release" says 'release 2 is published'
sleep 10
! says 'release 2 is shown' || fail "the limit does not hold the release that is not shown yet"

# Without the limit it is a matter of moments.
kill "$fetch"
wait "$fetch" || true
start_fetch
wait_for 60 "release 2 without the limit" says 'release 2 is shown'
kill "$kiosk"
wait "$kiosk" || fail "the kiosk did not end well"
echo "$bytes bytes for the first picture, beside a limit of 1 KiB a second"
