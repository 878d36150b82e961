#!/bin/bash
# A release that is signed as The Update Framework does as well: our own client and python-tuf follow it over nginx to the
# same release.json; a root that python-tuf signed, with an ECDSA key beside ours, is followed by our client; `verify`
# finds a file that was exchanged.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-server.sh
trap stop_server EXIT
work=build/e2e/tuf_release deps=$PWD/../shared/conformance/tuf/deps
rm -rf "$work"
mkdir -p "$work/content" "$work/ours/metadata" "$work/ours/targets" "$work/theirs/targets"
content=build/gopura-content release=$work/release keys=$work/keys
tiny_content "$work/content" 10000 5000
"$content" keys "$work/content" --keys "$keys" --tuf >"$work/log"
grep -q 'tuf/1.root.json$' "$work/log" || fail "keys does not say where the root is"
"$content" keys "$work/content" --keys "$keys" --tuf >/dev/null || fail "asked twice, it fails"
"$content" build "$work/content" --out "$release" --keys "$keys" >"$work/log" 2>&1 || { cat "$work/log"; fail build; }
"$content" verify "$release" >"$work/log" 2>&1 || { cat "$work/log"; fail "it does not verify"; }

start_server "$release" "$work/server"
client=build/tests/tools/tuf_client
# ours ARGUMENT...: our client, against the museum server
ours() {
	"$client" --ca "$server_ca" --metadata-dir "$work/ours/metadata" --metadata-url "${server_url}tuf/" "$@"
}
"$client" --metadata-dir "$work/ours/metadata" init "$keys/tuf/1.root.json"
download=(--target-name release.json --target-base-url "${server_url}tuf/targets/" --target-dir "$work/ours/targets" download)
ours "${download[@]}" || fail "our client does not get the release"
cmp "$work/ours/targets/release.json" "$release/release.json" || fail "our client got another release"

# ---- renewed, and published again
cp -a "$release/tuf" "$work/tuf1"
"$content" publish "$work/content" --out "$release" --keys "$keys" >"$work/log" 2>&1 || { cat "$work/log"; fail renew; }
grep -q '"version":2' "$release/tuf/timestamp.json" || fail "the timestamp was not signed anew"
[ ! -e "$release/tuf/2.targets.json" ] || fail "nothing changed, and there are new targets"
"$content" publish "$work/content" --out "$release" --keys "$keys" --comment again >"$work/log" 2>&1 || fail publish
ours "${download[@]}" || fail "our client does not follow"
cmp "$work/ours/targets/release.json" "$release/release.json" || fail "our client has the release before"

# ---- a publisher that was killed before it had signed this form: the next one does
rm -rf "$release/tuf"
cp -a "$work/tuf1" "$release/tuf"
! "$content" verify "$release" >"$work/log" 2>&1 || fail "verify takes the release before"
"$content" publish "$work/content" --out "$release" --keys "$keys" >"$work/log" 2>&1 || { cat "$work/log"; fail renew; }
"$content" verify "$release" >"$work/log" 2>&1 || { cat "$work/log"; fail "what was left half signed stays so"; }

# ---- what verify finds
cp "$release/tuf/2.targets.json" "$work/aside"
cp "$release/tuf/1.targets.json" "$release/tuf/2.targets.json"
! "$content" verify "$release" >"$work/log" 2>&1 || fail "verify takes the targets of the release before"
grep -q 'tuf: targets' "$work/log" || { cat "$work/log"; fail "verify does not name the file"; }
cp "$work/aside" "$release/tuf/2.targets.json"

mv "$release/tuf/1.root.json" "$work/aside"
! "$content" verify "$release" >"$work/log" 2>&1 || fail "verify takes a release whose terminals find no first root"
grep -q 'tuf/1.root.json, and the first is missing' "$work/log" || { cat "$work/log"; fail "verify does not name the root"; }
mv "$work/aside" "$release/tuf/1.root.json"

# ---- another implementation
[ -d "$deps/tuf" ] || skip "no ../shared/conformance/tuf/deps: python-tuf is not in Debian 12; our own client passed"
PYTHONPATH=$deps REQUESTS_CA_BUNDLE=$server_ca python3 - "$keys" "$release" "$server_url" "$work/theirs" <<'P'
import sys, shutil, pathlib
from tuf.ngclient import Updater
from tuf.api.metadata import Metadata, Root
from securesystemslib.signer import CryptoSigner

keys, release, url, theirs = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3], pathlib.Path(sys.argv[4])
shutil.copy(keys / "tuf/1.root.json", theirs / "root.json")
updater = Updater(str(theirs), url + "tuf/", str(theirs / "targets"), url + "tuf/targets/")
info = updater.get_targetinfo("release.json")
got = updater.download_target(info)
assert open(got, "rb").read() == (release / "release.json").read_bytes(), "python-tuf got another release"
print("python-tuf:", info.length, "bytes of release.json, root page", info.custom["root_page"])

# A museum brings a key of another kind: python-tuf adds it to the root and signs with the old one and it.
seed = bytes.fromhex((keys / "root.key").read_text().split()[-1])
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey
old = CryptoSigner(Ed25519PrivateKey.from_private_bytes(seed))
ecdsa = CryptoSigner.generate_ecdsa()
root = Metadata[Root].from_file(str(keys / "tuf/1.root.json"))
old.public_key.keyid = root.signed.roles["root"].keyids[0]
root.signed.version = 2
root.signed.add_key(ecdsa.public_key, "root")
root.signed.roles["root"].threshold = 2
root.sign(old)
root.sign(ecdsa, append=True)
root.to_file(str(keys / "tuf/2.root.json"))
P
"$content" publish "$work/content" --out "$release" --keys "$keys" --comment "another root" >"$work/log" 2>&1 || fail "publish"
ours refresh || fail "our client refuses a root that python-tuf signed"
grep -q '"version": *2' "$work/ours/metadata/root.json" || fail "our client has not the second root"
"$content" verify "$release" >"$work/log" 2>&1 || { cat "$work/log"; fail "the second root does not verify"; }
