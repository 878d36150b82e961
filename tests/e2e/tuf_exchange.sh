#!/bin/bash
# Keys are exchanged, because a thief has them or because they are old: terminal, our client, python-tuf and both forms of
# `verify` follow from the first root, what the thief signs is refused, and what he had set too high is cleared. Keys that
# were lost are exchanged too; after that of all that sign, numbers may begin again. What cannot be exchanged is refused and
# nothing is changed; a call on a file fails at each place in turn, and the next exchange goes on.
#
#   STEP=1 tests/e2e/tuf_exchange.sh     every call on a file fails, not one in 9
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-tuf.sh
tuf_work build/e2e/tuf_exchange
deps=$PWD/../shared/conformance/tuf/deps client=build/tests/tools/tuf_client
try() { "$content" "${@:2}" >"$work/log" 2>&1 || { cat "$work/log"; fail "$1"; }; }
says() { grep -q -- "$1" "$work/log" || { cat "$work/log"; fail "it does not say: $1"; }; }
all_of() { (cd "$1" && find . -type f -exec sha256sum {} + | sort); }
refuses() {
	local before
	before=$(all_of "$keys")
	! "$content" "${@:2}" >"$work/log" 2>&1 || fail "$1 is accepted"
	[ "$before" = "$(all_of "$keys")" ] || fail "$1 changed the keys"
}
exchange() { try "exchange $*" keys "$work/content" --keys "$keys" "${@/#/--exchange=}"; }
verifies() {
	try "$1: The Update Framework" verify "$release" --trust "$keys/tuf/1.root.json"
	try "$1: the earlier form" verify "$release" --trust "$keys/root/1.json"
}
# offer FOLDER: its signed files on the server; the roots there stay
offer() { find "$1/tuf" -name '*.json' ! -name '*.root.json' ! -path '*/targets/*' -exec cp {} "$release/tuf/" \; && cp -r "$1/tuf/targets" "$release/tuf/"; }
ours() { "$client" --ca "$server_ca" --metadata-dir "$work/ours" --metadata-url "${server_url}tuf/" "$@"; }

try keys keys "$work/content" --keys "$keys" --tuf
publish first
serve "$release" "$work/server"
terminal hall "$keys/tuf/1.root.json"
mkdir "$work/ours"
"$client" --metadata-dir "$work/ours" init "$keys/tuf/1.root.json"
ours refresh || fail "our client does not get the first release"
wait_for 60 "the first release" shown hall 1

# ---- timestamp.key is stolen, and the thief sets the version too high
cp -a "$keys" "$work/thief"
cp -a "$release" "$work/own"
tests/e2e/tuf_sign.py "$work/thief" "$release" set timestamp.json version=2000000000
is_high() { [ "$(figure hall gopura_kiosk_trust_timestamp_version)" = 2000000000 ]; }
wait_for 20 "the thief's timestamp" is_high
cp "$work/own/tuf/timestamp.json" "$release/tuf/"
wait_for 20 "what the thief did" said hall 'timestamp 1 is older than 2000000000'
exchange timestamp
says 'exchanged timestamp.key in'
says "root/2.json and tuf/2.root.json name the new keys, valid until 20"
says 'timestamp.key.old'
says "next: gopura-content publish $work/content"
[ "$(stat -c %a "$keys"/timestamp.key*)" = $'600\n600' ] || fail "others may read a key"
[ ! -e "$keys/exchange" ] && [ ! -e "$keys/exchange.part" ] || fail "something is left of the exchange"
cmp "$keys/timestamp.key.old" "$work/thief/timestamp.key" || fail "the old key was not kept"
cmp "$keys/root.key" "$work/thief/root.key" || fail "another key was exchanged too"
try "nothing but a timestamp" publish "$work/content" --keys "$keys" --out "$release"
says 'nothing changed'
verifies "the timestamp alone"
publish 'after the theft'
wait_for 30 "a release after the theft" said hall 'release 2 is shown'
ours refresh || fail "our client does not follow the new timestamp.key"

# ---- so are all others; the thief publishes by them, as long as he can
mv "$keys/root.key" "$work/safe.key"
refuses "root.key in the safe" keys "$work/content" --keys "$keys" --exchange release
says 'root.key: not here; bring it back'
mv "$work/safe.key" "$keys/root.key"
rm -rf "$work/thief"
cp -a "$keys" "$work/thief"
cp -a "$release" "$work/stolen"
exchange root targets timestamp
says 'exchanged root.key, release.key, timestamp.key'
says 'destroy root.key.old'
publish 'by the new key'
! grep -q 'all objects are packed again' "$work/log" || fail "what was published is packed again"
grep -q 'only its number counts' "$work/log" || { cat "$work/log"; fail "it does not say what is left of the release before"; }
[ -e "$release/tuf/3.targets.json" ] && [ ! -e "$release/tuf/4.targets.json" ] || fail "versions do not go on"
verifies "the third root"
wait_for 30 "a release by the new key" said hall 'release 3 is shown'
cp -a "$release" "$work/third"
try "the thief publishes" publish "$work/content" --keys "$work/thief" --out "$work/stolen" --comment stolen
offer "$work/stolen"
wait_for 30 "the refusal of the stolen keys" said hall 'refused tuf: timestamp.*signatures'
! said hall 'release 4 is' || fail "a terminal shows what the thief published"
! "$content" verify "$release" --trust "$keys/tuf/1.root.json" >"$work/log" 2>&1 || fail "verify takes what the thief published"
! ours refresh 2>/dev/null || fail "our client takes what the thief published"
cp "$work/third/tuf"/*.json "$release/tuf/"
cp -r "$keys/tuf" "$keys/root" "$work/thief/"
! "$content" publish "$work/content" --keys "$work/thief" --out "$work/stolen" --comment stolen >"$work/log" 2>&1 || fail "publish signs with keys that nobody trusts"
says 'the newest root does not name these keys'

# ---- from the first root to all the others
rm -rf "$work/ours"
mkdir "$work/ours"
"$client" --metadata-dir "$work/ours" init "$keys/tuf/1.root.json"
ours refresh || fail "our client does not follow from the first root"
grep -q '"version":3' "$work/ours/root.json" || fail "our client has not the third root"
if [ -d "$deps/tuf" ]; then
	mkdir -p "$work/theirs/targets"
	cp "$keys/tuf/1.root.json" "$work/theirs/root.json"
	PYTHONPATH=$deps REQUESTS_CA_BUNDLE=$server_ca python3 - "$work/theirs" "$server_url" <<'P'
import sys
from tuf.ngclient import Updater
theirs, url = sys.argv[1:]
updater = Updater(theirs, url + "tuf/", theirs + "/targets", url + "tuf/targets/")
assert updater.download_target(updater.get_targetinfo("release.json"))
assert updater._trusted_set.root.version == 3
P
fi

# ---- what is wrong changes nothing
refuses "a team's key" keys "$work/content" --keys "$keys" --exchange angkor
says 'exchanged by `gopura-content delegate`'
refuses "two commands in one" keys "$work/content" --keys "$keys" --exchange root --tuf
says '--exchange goes with'
refuses "a snapshot.key that is not there" keys "$work/content" --keys "$keys" --exchange snapshot
says 'release.key signs snapshots too'
mkdir "$work/none"
refuses "a folder without keys" keys --keys "$work/none" --exchange timestamp
says 'no keys to exchange'
[ -z "$(ls "$work/none")" ] || fail "a folder without keys has something now"
cp "$keys/timestamp.key" "$work/aside"
cp "$work/thief/timestamp.key" "$keys/"
refuses "a key that the root does not name" keys "$work/content" --keys "$keys" --exchange timestamp
says 'timestamp.key: the newest tuf/N.root.json does not name this key'
rm "$keys/timestamp.key"
printf '[keys]\ntimestamp = token.sh\n' >"$keys/signing.ini"
refuses "a key in a token" keys "$work/content" --keys "$keys" --exchange timestamp
says 'others sign than timestamp.key'
rm "$keys/signing.ini"
cp "$keys/root.key" "$work/aside"
cp "$work/thief/root.key" "$keys/"
refuses "the root.key before" keys "$work/content" --keys "$keys" --exchange timestamp
says 'root.key alone may not sign'
cp "$work/aside" "$keys/root.key"

# ---- a key that was lost
rm "$keys/timestamp.key.old"
exchange timestamp
! grep -q 'timestamp.key.old' "$work/log" || fail "it speaks of a key that was not there"
publish 'by a key in place of the lost one'
verifies "a key in place of the lost one"
wait_for 30 "a release by a key in place of the lost one" said hall 'release 4 is shown'

# ---- numbers begin again in an empty folder
exchange release timestamp
rm -rf "${release:?}"/*
publish 'begun again'
verifies "a folder begun again"
is_begun_again() { sed -n '/release 1 is published: begun again/,$p' "$work/hall.log" | grep -q 'release 1 is shown'; }
wait_for 30 "a release with a lower number, after an exchange" is_begun_again
stop_terminal hall

# ---- a call on a file fails, at each place in turn: the next exchange goes on, and nothing is signed before
cp -a "$keys" "$work/whole"
cp -a "$release" "$work/last"
shim=$PWD/build/tests/tools/failing_calls.so
all=(keys "$work/content" --keys "$keys" --exchange root --exchange release --exchange timestamp)
FAIL_KIND=io FAIL_COUNT=$PWD/$work/calls LD_PRELOAD=$shim try "counting calls" "${all[@]}"
calls=$(sort -n "$work/calls" | tail -n 1) failed=0 amid=0
[ "$calls" -gt 60 ] || fail "only $calls calls on files"
again() { "$content" publish "$work/content" --keys "$keys" --out "$release" "$@" >"$work/log" 2>&1; }
for ((n = 1; n <= calls; n += ${STEP:-9})); do
	rm -rf "$keys" "$release"
	cp -a "$work/whole" "$keys"
	cp -a "$work/last" "$release"
	if ! FAIL_KIND=io FAIL_AT=$n LD_PRELOAD=$shim "$content" "${all[@]}" >"$work/log" 2>&1; then
		[ -s "$work/log" ] || fail "call $n: it fails without a word"
		failed=$((failed + 1))
		if [ -e "$keys/exchange" ]; then
			amid=$((amid + 1))
			! again --renew || fail "call $n: publish signs amid the exchange"
			says 'with --exchange root --exchange release --exchange timestamp, which goes on'
			refuses "call $n: another exchange amid the first" keys "$work/content" --keys "$keys" --exchange timestamp
			says 'was not finished'
		else
			again || fail "call $n: publishing before it goes on"
			verifies "call $n: before it goes on"
		fi
		try "call $n: it does not go on" "${all[@]}"
	fi
	[ ! -e "$keys/exchange" ] || fail "call $n: it does not come to an end"
	again || { cat "$work/log"; fail "call $n: publishing by the new keys"; }
	verifies "call $n"
done
echo "of $calls calls on files one in ${STEP:-9} failed, $failed times the command, $amid times amid the exchange"
[ "$amid" -ge 2 ] || fail "hardly any call mattered"
