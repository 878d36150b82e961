#!/bin/bash
# Several temples on one server, each signed by its own team: the commands of docs/tuf.md, as they stand there, lead from
# nothing to two temples and two terminals that show each its own; python-tuf finds both. Then a team's key is exchanged,
# stolen, joined by a second one; what is wrong changes nothing; a call on a file fails at each place in turn, and what is
# published stays whole; a release is signed in two steps; a curator publishes for one team; a role is removed; the museum
# exchanges its keys.
#
#   STEP=1 tests/e2e/tuf_teams.sh     every call on a file fails, not one in 13
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-tuf.sh
top=$PWD work=build/e2e/tuf_teams deps=$PWD/../shared/conformance/tuf/deps
rm -rf "$work"
mkdir -p "$work"
trap stop_all EXIT
tiny_content "$work/angkor" 10000 5000
cp -r "$work/angkor" "$work/bayon"
sed -i 's/^name = .*/name = Bayon/' "$work/bayon/temple.ini"
cp docs/tuf.md "$work"
cd "$work"
export PATH=$top/build:$PATH
# try WHAT COMMAND...: with its output in the log; refuses: the same, which must fail and change nothing that is published.
try() { "${@:2}" >log 2>&1 || { cat log; fail "$1"; }; }
signed_files() { (cd release/tuf && sha256sum ./*.json); }
refuses() {
	local before
	before=$(signed_files)
	! "${@:2}" >log 2>&1 || fail "$1 is accepted"
	[ "$before" = "$(signed_files)" ] || fail "$1 changed what is published"
}
says() { grep -q -- "$1" log || { cat log; fail "it does not say: $1"; }; }
delegate() { gopura-content delegate release "$@" --keys museum; }
publish_as() { gopura-content publish "$1" --out release --keys "$1.keys" "${@:2}"; }
verifies() { gopura-content verify release --trust museum/tuf/1.root.json --target "$1/release.json"; }
# key NAME [OPTION OF ITS ALGORITHM]: NAME.pem and NAME.pub
key() {
	openssl genpkey -algorithm "${3:-EC}" -pkeyopt "${2:-ec_paramgen_curve:P-256}" -out "$1.pem" 2>/dev/null
	openssl pkey -in "$1.pem" -pubout -out "$1.pub"
}

# ---- as the page has it: what a team does, the other one does too
first=$(sed -n '/^    gopura-content keys --keys museum --museum/,/^    gopura-content verify/p' tuf.md)
[ "$(grep -c '^    [a-z]' <<<"$first")" -ge 9 ] || fail "the commands of docs/tuf.md are not found"
theirs=()
follow() { for one in "${theirs[@]}"; do try "$one" eval "$one"; done && theirs=(); }
while read -r line; do
	case $line in "" | "#"*) continue ;; esac
	try "$line" eval "$line"
	case $line in *delegate*) ;; *angkor*) theirs+=("${line//angkor/bayon}") ;; esac
	case $line in printf*) follow ;; esac
done <<<"$first"
follow
says 'release 1 of "Bayon"'
[ "$(stat -c %a angkor.keys/angkor.key bayon.keys/snapshot.key angkor.keys | tr '\n' ' ')" = "600 600 700 " ] || fail "others may read a key"
[ -z "$(find angkor.keys handed-over -name release.key -o -name root.key)" ] || fail "a team has the museum's own keys"
cmp release/tuf/1.root.json museum/tuf/1.root.json || fail "the museum's root is not published"
try "bayon again" publish_as bayon --comment "of bayon alone"
try list delegate
says 'angkor signs angkor/\*, with 1 of these keys'
says 'release 2.bayon.json, valid until'

# ---- each terminal shows its own
cd "$top"
start_server "$work/release" "$work/server"
cd "$work"
url=$server_url ca=$top/$server_ca
# terminal_of TEMPLE: starts it
terminal_of() {
	gopura-kiosk --display headless --size 320x180 --release "$url" --ca "$ca" --poll-s 1 --state "state-$1" \
		--trust museum/tuf/1.root.json --target "$1/release.json" 2>"$1.log" &
	pids[$1]=$!
}
takes() { grep -q "release $2 is published: $3" "$1.log"; }
terminal_of angkor
terminal_of bayon
for temple in angkor bayon; do wait_for 60 "release on the terminal of $temple" grep -q 'release .* is shown' $temple.log; done
takes bayon 2 'of bayon alone' || { cat bayon.log; fail "not Bayon's release"; }
! grep -q 'of bayon alone' angkor.log || fail "the terminal of Angkor shows Bayon"

# ---- python-tuf, from the museum's root to both
if [ -d "$deps/tuf" ]; then
	PYTHONPATH=$deps REQUESTS_CA_BUNDLE=$ca python3 - "$url" <<'P'
import pathlib, shutil, sys
from tuf.ngclient import Updater
url, theirs = sys.argv[1], pathlib.Path("theirs")
theirs.mkdir()
shutil.copy("museum/tuf/1.root.json", theirs / "root.json")
(theirs / "targets").mkdir()
updater = Updater(str(theirs), url + "tuf/", str(theirs / "targets"), url + "tuf/targets/")
for temple, sequence in ("angkor", 1), ("bayon", 2):
    info = updater.get_targetinfo(f"{temple}/release.json")
    assert info and updater.download_target(info), temple
    assert f"{sequence}.{temple}.json" in [path.name for path in pathlib.Path("release/tuf").iterdir()]
assert updater.get_targetinfo("release.json") is None
P
fi

# ---- no team publishes what is another's
sed -i 's,^target = .*,target = angkor/release.json,' bayon/temple.ini
refuses "another's path" publish_as bayon --comment stolen
says 'does not delegate the path to bayon'
sed -i 's/^role = .*/role = angkor/' bayon/temple.ini
refuses "another's role" publish_as bayon --comment stolen
says 'by none of the keys'
sed -i 's,^target = .*,target = bayon/release.json,; s/^role = .*/role = bayon/' bayon/temple.ini
refuses "a team that delegates" gopura-content delegate release bayon --keys bayon.keys --key handed-over/none.pub
mkdir thief
cp -r bayon.keys/tuf bayon.keys/snapshot.key bayon.keys/timestamp.key thief
cp bayon.keys/snapshot.key thief/release.key
key new
refuses "a list that the key of all teams signed" gopura-content delegate release bayon --keys thief --key new.pub --invalidate
says 'by none of the keys'

# ---- wrong keys, names, folders
key rsa rsa_keygen_bits:2048 RSA
key p384 ec_paramgen_curve:P-384
python3 - <<'P'
import json
root = json.load(open("museum/tuf/1.root.json"))["signed"]
json.dump(root["keys"][root["roles"]["targets"]["keyids"][0]], open("museum.json", "w"))
P
refuses "a key that is missing" delegate chan --key nowhere.pub
says 'nowhere.pub: No such file'
refuses "a private key" delegate chan --key new.pem
says 'new.pem: a private key'
refuses "our private key" delegate chan --key angkor.keys/angkor.key
says 'a private key'
refuses "a key of another curve" delegate chan --key p384.pub
says 'p384.pub: only ed25519'
refuses "no key" delegate chan --key angkor/temple.ini
says 'not a public key'
refuses "one key twice" delegate chan --key new.pub --key new.pub
says 'the same key as'
refuses "another team's key" delegate chan --key angkor.keys/angkor.pub
says 'is used already, by angkor'
refuses "the museum's key" delegate chan --key museum.json
says 'is used already, by the museum itself'
refuses "a threshold above the keys" delegate chan --key new.pub --threshold 2
says '2 of its keys have to sign, but it has 1'
for role in targets root snapshot timestamp .hidden a/b ../up 'a*'; do
	refuses "the role $role" delegate "$role" --key new.pub
	says 'a role is up to 64'
done
refuses "a role that is not there" delegate chan --remove
says 'delegates nothing to chan'
cp -r museum/root rootless
refuses "keys without a root" gopura-content delegate release chan --keys rootless --key new.pub
says '1.root.json: is not there'
touch release/release.json
refuses "the earlier form" delegate chan --key new.pub
says 'metadata = tuf'
rm release/release.json
refuses "keys of another museum" gopura-content keys angkor --keys angkor.keys --team angkor --from museum/root
says '1.root.json: missing'
refuses "keys that publish by themselves" gopura-content keys angkor --keys museum --team angkor --from handed-over
says 'publish a temple by themselves'

# ---- another key for a team: at once it would make the release invalid; both, then the new one
refuses "a key that has signed nothing" delegate angkor --key new.pub
says 'would not be valid any more'
try "both keys" delegate angkor --key angkor.keys/angkor.pub --key new.pub
try "the release stays" verifies angkor
install -m 600 new.pem angkor.keys
sed -i 's/^targets = .*/targets = new.pem/' angkor.keys/signing.ini
try "the new key signs" publish_as angkor --comment 'by the new key'
try "the old key goes" delegate angkor --key new.pub
[ "$(grep -c '^    e[cd]' log)" = 2 ] || { cat log; fail "the old key is still there"; }
wait_for 30 "release by the new key" takes angkor 2 'by the new key'

# ---- a call on a file fails, at each place in turn: the list before or after, and both temples whole
shim=$top/build/tests/tools/failing_calls.so
FAIL_KIND=io FAIL_COUNT=$PWD/calls LD_PRELOAD=$shim try "counting calls" delegate chan --key rsa.pub
calls=$(sort -n calls | tail -n 1) failed=0
[ "$calls" -gt 20 ] || fail "only $calls calls on files"
try "chan goes" delegate chan --remove
for ((n = 1; n <= calls; n += ${STEP:-13})); do
	if ! FAIL_KIND=io FAIL_AT=$n LD_PRELOAD=$shim delegate chan --key rsa.pub >log 2>&1; then
		[ -s log ] || fail "call $n: it fails without a word"
		failed=$((failed + 1))
	fi
	try "failing call $n" verifies angkor
	try "failing call $n: what is next" delegate chan --key rsa.pub
	try "failing call $n: what is next" delegate chan --remove
done
echo "of $calls calls on files one in ${STEP:-13} failed, and $failed times the command"
[ "$failed" -ge 4 ] || fail "hardly any call mattered"
try "bayon after all of them" verifies bayon
try "after all of them" delegate chan --key rsa.pub
says '^chan signs chan/\*'
says 'has published nothing yet'

# ---- a key was stolen: terminals keep what they show until the team publishes by another one
key third
try "a stolen key" delegate angkor --key third.pub --invalidate
says 'terminals keep what they show'
says 'its team has to publish again'
refuses "the stolen key" publish_as angkor --comment 'by the thief'
refuses "what the stolen key signed" verifies angkor
try "the other temple" verifies bayon
try "bayon goes on" publish_as bayon --comment 'while angkor waits'
wait_for 30 "Bayon's next release" takes bayon 3 'while angkor waits'
grep -q 'refused' angkor.log || { cat angkor.log; fail "the terminal of Angkor did not refuse"; }
install -m 600 third.pem angkor.keys
sed -i 's/^targets = .*/targets = third.pem/' angkor.keys/signing.ini
try "the third key signs" publish_as angkor --comment 'by the third key'
wait_for 30 "release by the third key" takes angkor 3 'by the third key'

# ---- two signatures of two keys
try "two keys" delegate angkor --key third.pub --key angkor.keys/angkor.pub --threshold 2 --invalidate
refuses "one signature of two" publish_as angkor --comment 'by one'
says '1 signatures, fewer than its threshold of 2'
sed -i 's/^targets = .*/targets = third.pem, angkor.key/' angkor.keys/signing.ini
try "two signatures" publish_as angkor --comment 'by two'
try "two signatures" verifies angkor
wait_for 30 "release by two keys" takes angkor 4 'by two'

# ---- in two steps: the museum signs snapshot and timestamp; then a list that is signed elsewhere
sed -i 's/^snapshot = .*/snapshot = none/; s/^timestamp = .*/timestamp = none/' bayon.keys/signing.ini
refuses "a team without the shared keys" publish_as bayon --comment 'in two steps'
before=$(signed_files)
try "the first step" publish_as bayon --comment 'in two steps' --write-unsigned staged
[ "$before" = "$(signed_files)" ] || fail "the first step published"
cp -r staged forged
sed -i 's/"version":4/"version":5/' forged/4.bayon.json
refuses "what the team did not sign" delegate --add-signature forged
try "the second step" delegate --add-signature staged
says 'release 4.bayon.json'
wait_for 30 "release in two steps" takes bayon 4 'in two steps'
refuses "the second step twice" delegate --add-signature staged
printf '[keys]\ntargets = none\n' >museum/signing.ini
refuses "a list that nobody signs" delegate chan --remove
try "the list, unsigned" delegate chan --remove --write-unsigned list
refuses "the list without its signature" delegate --add-signature list
says 'fewer than its threshold'
python3 - <<'P'
seed = bytes.fromhex(open("museum/release.key").read().split()[-1])
open("release.der", "wb").write(bytes.fromhex("302e020100300506032b657004220420") + seed)
P
openssl pkey -inform DER -in release.der -out release.pem
for one in list/*.targets.json.bytes; do openssl pkeyutl -sign -rawin -inkey release.pem -in "$one" -out "${one%.bytes}.museum.sig"; done
try "the list with its signature" delegate --add-signature list
! grep -q '^chan' log || fail "the role is still there"
rm museum/signing.ini

# ---- the curator's page of a team lists that team's releases, publishes, and goes back to one
sed -i 's/^snapshot = .*/snapshot = snapshot.key/; s/^timestamp = .*/timestamp = timestamp.key/' bayon.keys/signing.ini
# ask NUMBER SEQUENCE COMMENT: what the page would ask for; the publisher works it off
ask() {
	printf '{"number": %s, "sequence": %s, "at": 1, "by": "petra", "comment": "%s"}\n' "$@" >bayon/.curator/publish/request.json
	try "the curator's request $1" gopura-curator publisher bayon --out release --keys bayon.keys --once
}
# listed: numbers and comments of the releases, the newest first
listed() { python3 -c 'import json
print(*[f"""{one["sequence"]}:{one["comment"]}:{one["by"]}""" for one in json.load(open("bayon/.curator/publish/releases.json"))["releases"]], sep=", ")'; }
try "the publisher" gopura-curator publisher bayon --out release --keys bayon.keys --once
[ "$(listed)" = "4:in two steps:, 3:while angkor waits:, 2:of bayon alone:, 1::" ] || fail "the curator lists $(listed)"
ask 1 0 'from the page'
ask 2 3 'back'
[ "$(listed)" = "6:back:petra, 5:from the page:petra, 4:in two steps:, 3:while angkor waits:, 2:of bayon alone:, 1::" ] || fail "the curator lists $(listed)"
wait_for 30 "the curator's release" takes bayon 6 back
sed -i 's/^name = .*/name = /' bayon/temple.ini
! gopura-curator publisher bayon --out release --keys bayon.keys --once >log 2>&1 || true
says 'temple.ini has faults'
[ "$(listed | cut -d: -f1)" = 6 ] || fail "a fault in temple.ini empties the list"
sed -i 's/^name = .*/name = Bayon/' bayon/temple.ini

# ---- a team leaves: its role goes, and another snapshot.key comes
refuses "a role that has published" delegate bayon --remove
says 'terminals that show it would keep it'
try "bayon leaves" delegate bayon --remove --invalidate
says 'take nothing any more'
refuses "bayon publishes" publish_as bayon --comment 'after its end'
wait_for 30 "the terminal of Bayon to say so" grep -q 'there is no target bayon/release.json' bayon.log
try "another snapshot.key" gopura-content keys --keys museum --exchange snapshot
says 'next: gopura-content delegate RELEASE --keys museum --renew'
[ -f museum/tuf/2.root.json ] || fail "there is no second root"
try "what there is already" gopura-content keys --keys museum --museum
[ ! -f museum/tuf/3.root.json ] || fail "a root was made for nothing"
hand_over() {
	cp -r museum/tuf museum/snapshot.key museum/timestamp.key handed-over
	try "handed over" gopura-content keys angkor --keys angkor.keys --team angkor --from handed-over
}
hand_over
grep -q '^targets = third.pem, angkor.key' angkor.keys/signing.ini || fail "the team's signing.ini was replaced"
try "angkor goes on" publish_as angkor --comment 'without bayon'
wait_for 30 "release after the second root" takes angkor 5 'without bayon'
try "angkor goes on" verifies angkor
cp -r bayon.keys/snapshot.key bayon.keys/timestamp.key thief
cp -r museum/tuf angkor.keys/angkor.key angkor.keys/third.pem thief
printf '[keys]\ntargets = angkor.key, third.pem\nsnapshot = snapshot.key\n' >thief/signing.ini
refuses "the old snapshot.key" gopura-content publish angkor --out release --keys thief --comment 'by the one who left'
says 'snapshot.key: its signature is by none'

# ---- the museum exchanges all its keys: the list, which the old one signed, is carried on only if somebody says so
cp -r museum old
try "the snapshot.key" gopura-content keys --keys museum --exchange snapshot
hand_over
refuses "a release beside a snapshot of the old key" publish_as angkor --comment early
says 'the last snapshot is signed with a key that was exchanged since'
try "all keys" gopura-content keys --keys museum --exchange root --exchange release --exchange snapshot --exchange timestamp
hand_over
refuses "a release under a list of the old key" publish_as angkor --comment early
says 'tuf: targets.json is signed with a key that was exchanged since, and says'
refuses "another role beside a list of the old key" delegate chan --key rsa.pub
says 'tuf: targets.json is signed with a key that was exchanged since, and says'
try "the list" delegate
says 'signed with a key that was exchanged since'
says '^angkor signs'
try "the list, anew" delegate --renew
! grep -q 'exchanged since: if' log || fail "the list is still that of the old key"
says 'release 5.angkor.json'
try "the list, anew" verifies angkor
try "after the exchange" publish_as angkor --comment 'by new keys of the museum'
wait_for 30 "release after the exchange" takes angkor 6 'by new keys of the museum'
refuses "the old release.key" gopura-content delegate release chan --key rsa.pub --keys old
says 'by none of the keys\|not signed with the keys'
stop_terminal angkor
stop_terminal bayon
