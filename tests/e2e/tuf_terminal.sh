#!/bin/bash
# A terminal follows The Update Framework over nginx: one in the field goes over by a release signed both ways, follows
# the next release after the earlier form is gone from the server, roots with other keys, and a stick; a power cut forgets
# nothing. A new terminal begins with tuf/1.root.json. A root that the terminal's own root keys did not sign is not taken.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-tuf.sh
tuf_work build/e2e/tuf_terminal

# ---- a terminal in the field, before anybody thought of The Update Framework
publish "the first"
serve "$release" "$work/server"
terminal field "$release/root/1.json"
wait_for 60 "the first release" shown field 1

# ---- another root, which the terminal's root keys did not sign, then the right one
"$content" keys "$work/content" --keys "$keys" --tuf >/dev/null
"$content" keys "$work/content" --keys "$work/others" --tuf >/dev/null
"$content" build "$work/content" --out "$work/strange" --keys "$work/others" >"$work/strange.log" 2>&1 ||
	fail "a release of strangers: $(tail -n 1 "$work/strange.log")"
cp -a "$release" "$work/exchanged"
(release=$work/exchanged publish "whose root was exchanged")
rm -rf "$work/exchanged/tuf"
cp -a "$work/strange/tuf" "$release/tuf"
cp -au "$work/exchanged/." "$release/"
wait_for 60 "a release of the earlier form" shown field 2
wait_for 30 "the refusal of a root of strangers" said field 'refused tuf/1.root.json: .*not signed by the root keys'
rm -rf "$release/tuf"
cp -a "$release" "$work/both"
(release=$work/both publish "signed both ways")
mv "$work/both/tuf" "$work/later" # a copy to the server may bring the root last
cp -au "$work/both/." "$release/" # what is newer alone: quick, as a publisher is
wait_for 60 "the release signed both ways" shown field 3
wait_for 30 "a root that is not there" said field 'refused tuf/1.root.json: it is not there'
cp -a "$work/later" "$release/tuf"
cp -a "$work/later" "$work/both/tuf"
wait_for 30 "going over" said field 'root 1 of The Update Framework is trusted from now on'

# ---- what only the earlier form says counts no more, and the earlier form may go
publish "without the earlier form"
mkdir "$work/earlier"
mv "$release/root" "$release/release.json" "$release/timestamp.json" "$work/earlier/"
wait_for 60 "a release of The Update Framework alone" shown field 4
refused field && fail "something was refused: $(grep refused "$work/field.log")"

# ---- kill -9 and again: it follows what it followed, and refuses what is older
kill_terminal field
mv "$release" "$work/four"
cp -a "$work/both" "$release"
terminal field
wait_for 60 "the refusal of what is older" said field 'refused tuf: timestamp .* is older than'
has_shown field 4 || fail "not the release before the kill"
rm -rf "$release"
cp -a "$work/four" "$release"
cp -a "$work/earlier/." "$release/" # the publisher goes on from there

# ---- a new terminal, which never knew the earlier form
terminal fresh "$keys/tuf/1.root.json"
wait_for 60 "the first release of a new terminal" shown fresh 1
said fresh 'release 4 is published' || fail "a new terminal shows another release"

# ---- rounds in which nothing is new draw nothing
rests() {
	local frames
	frames=$(figure fresh gopura_kiosk_frames_total)
	sleep 4
	[ "$(figure fresh gopura_kiosk_frames_total)" = "$frames" ]
}
wait_for 40 "rest" rests

# ---- the next root
tests/e2e/tuf_sign.py "$keys" "$release" root 'expires="2040-01-01T00:00:00Z"'
publish "under root 2"
wait_for 60 "a release under root 2" shown field 1
wait_for 60 "a release under root 2" shown fresh 2

# ---- a stick brings the next release to a terminal whose server is gone
stop_server
mkdir -p "$work/media"
publish "on a stick"
cp -a "$release" "$work/media/release"
wait_for 60 "the release on the stick" said field 'is on the stick: on a stick'
wait_for 60 "the release on the stick" shown field 2

# ---- the release is of a role to which the targets delegate, with a key of its own
cp -a "$release" "$work/next"
release=$work/next publish "of a role"
sed "s/[0-9a-f]\{64\}/$(sha256sum </dev/null | cut -c 1-64)/" "$keys/release.key" >"$keys/temple-a.key"
tests/e2e/tuf_sign.py "$keys" "$work/next" delegate temple-a
serve "$work/next" "$work/server" "$port" # again, where it was
wait_for 60 "a release that is delegated" shown field 3
said field 'release 7 is published: of a role' || fail "another release"
stop_terminal field
stop_terminal fresh
