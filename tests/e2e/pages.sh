#!/bin/bash
# Curators write texts and pages over HTTP: two at once, with wrong content, with pictures (pages.py); gopura-content
# publishes what they wrote. Then the program is killed while it saves, again and again: the folder is always whole.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/pages
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content" # with the times of its scan, so the hierarchy is still its own
content=$work/content
sed -i '0,/"parts": \[/s//"parts": [{"id": "spare", "anchor": [0, 0, 9], "title": {"en": "A part to remove"}},/' "$content/parts.json"
echo '<p>Nobody needs this.</p>' >"$content/pages/spare.en.html"
for one in ana:editor rolf:reader petra:publisher; do
	echo "password of ${one%:*}" | build/gopura-curator user add "$content" "${one%:*}" --role "${one#*:}" >"$work/log"
done
curator=
trap '[ -z "$curator" ] || kill -9 $curator 2>/dev/null || true' EXIT
start() {
	rm -f "$work/curator.log" # else the address of the one before may be found in it
	build/gopura-curator "$content" --port 0 >"$work/curator.log" 2>&1 &
	curator=$!
	wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
	port=$(sed -nE 's|.*http://127.0.0.1:([0-9]+)/.*|\1|p' "$work/curator.log")
}

# ---- at work
start
! build/gopura-curator "$content" --port 0 2>"$work/log" || fail "two have one folder"
grep -q 'another gopura-curator' "$work/log" || fail "of two: $(cat "$work/log")"
python3 tests/e2e/pages.py "$port" check "$content" || { tail "$work/curator.log"; fail "writing"; }

# ---- killed while it saves
for _ in 1 2 3 4; do
	python3 tests/e2e/pages.py "$port" save "$work/counter" 2>"$work/saver.log" &
	saver=$!
	(wait_for 60 "saves" test -s "$work/counter") || { tail "$work/saver.log" "$work/curator.log"; exit 1; }
	sleep "0.$((RANDOM % 9))"
	kill -9 "$curator"
	wait "$curator" "$saver" 2>/dev/null || true
	page=$content/pages/lions.en.html
	found=$(sed -nE 's|.*<p>Number ([0-9]+)\.</p>.*|\1|p' "$page" | tail -1)
	grep -q '</html>' "$page" || fail "a half-written page"
	noted=$(cat "$work/counter")
	[ "$found" -ge "$noted" ] || fail "it said that $noted was saved, but there is $found"
	rm -f "$work/counter"
	start
	! grep -q 'is damaged' "$work/curator.log" || fail "the history: $(cat "$work/curator.log")"
done
kill "$curator"
wait "$curator" || fail "it did not end well"
curator=

# ---- what they wrote is content like any other
build/gopura-content build "$content" --out "$work/release" --keys "$small_keys" >"$work/log" 2>&1 || { cat "$work/log"; fail "it is refused"; }
build/gopura-content verify "$work/release" >"$work/log" 2>&1 || { cat "$work/log"; fail "the release"; }
build/gopura-content inspect "$work/release" >"$work/log" 2>&1 || { cat "$work/log"; fail "inspect"; }
grep -qE 'information page, [0-9]+ bytes, 20 children' "$work/log" || { cat "$work/log"; fail "the new picture is not published"; }
build/gopura-content annotations export "$content" --out "$work/parts.jsonld" >"$work/log" 2>&1 || { cat "$work/log"; fail "it cannot be exported"; }
grep -q 'The arrived end, by both' "$work/parts.jsonld" || fail "the page is not what they wrote"
! grep -q 'A part to remove' "$work/parts.jsonld" || fail "the part that was removed is there"
