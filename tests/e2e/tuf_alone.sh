#!/bin/bash
# Releases in the form of The Update Framework alone: what was published in both forms goes over; other keys sign than
# those of gopura, ECDSA and RSA, by a program and in two steps, with no key of gopura left; a signature that is missing
# or wrong publishes nothing.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
. tests/e2e/lib-tuf.sh
tuf_work build/e2e/tuf_alone
deps=$PWD/../shared/conformance/tuf/deps
# try WHAT ARGUMENT...: gopura-content with its output in the log; refuses: the same, which must fail.
try() { "$content" "${@:2}" >"$work/log" 2>&1 || { cat "$work/log"; fail "$1"; }; }
refuses() { ! "$content" "${@:2}" >"$work/log" 2>&1 || fail "$1"; }
says() { grep -q -- "$1" "$work/log" || { cat "$work/log"; fail "it does not say: $1"; }; }
at=(--out "$release" --keys "$keys")
own() { sed -i '/^\[release/d; /^metadata/d; /^target/d; /^role/d' "$1/temple.ini" && printf '[release]\n%b' "$2" >>"$1/temple.ini"; }
version_of() { grep -o '"version": *[0-9]*' "$1" | tail -n 1 | grep -o '[0-9]*'; }

# ---- both forms, then one
try keys keys "$work/content" --keys "$keys" --tuf
publish first
refuses "what is in both forms is signed elsewhere" publish "$work/content" "${at[@]}" --write-unsigned "$work/staged"
says 'metadata = tuf'
own "$work/content" 'metadata = tuf\n'
publish second
[ ! -e "$release/release.json" ] && [ ! -e "$release/timestamp.json" ] || fail "the earlier form is still there"
[ -e "$release/tuf/2.targets.json" ] || fail "there is no second release"
try "its own root" verify "$release"
try "the terminals' root" verify "$release" --trust "$keys/tuf/1.root.json"
refuses "the earlier root" verify "$release" --trust "$keys/root/1.json"
try inspect inspect "$release"
says '"second"\|second'
try undo publish "$work/content" "${at[@]}" --sequence 1
says 'release 3 '
try renew publish "$work/content" "${at[@]}" --renew
[ ! -e "$release/tuf/4.targets.json" ] || fail "a new timestamp made new targets"

# ---- other keys, none of them on disk as keys of gopura
for name in token online; do
	openssl ecparam -name prime256v1 -genkey -noout -out "$work/$name.pem" 2>/dev/null
	openssl pkey -in "$work/$name.pem" -pubout -out "$work/$name.pub"
done
openssl genpkey -algorithm RSA -pkeyopt rsa_keygen_bits:2048 -out "$work/rsa.pem" 2>/dev/null
openssl pkey -in "$work/rsa.pem" -pubout -out "$work/rsa.pub"
tests/e2e/tuf_sign.py "$keys" "$release" adopt "targets=$work/token.pub" "snapshot=$work/rsa.pub" "timestamp=$work/online.pub"
refuses "keys that the root does not name any more" publish "$work/content" "${at[@]}" --comment "old keys"
says 'by none of the keys that may sign'
rm "$keys"/*.key
cp "$work/rsa.pem" "$work/online.pem" "$keys"
cp "$work/token.pem" "$keys/two.pem"
chmod 600 "$keys"/*.pem
printf '#!/bin/sh\nexec openssl dgst -sha256 -sign %s\n' "$PWD/$work/token.pem" >"$keys/token.sh"
chmod 700 "$keys/token.sh"
printf '[keys]\ntargets = token.sh\nsnapshot = rsa.pem\ntimestamp = online.pem\n' >"$keys/signing.ini"
try "keys elsewhere" publish "$work/content" "${at[@]}" --comment fourth
try "keys elsewhere" verify "$release" --trust "$keys/tuf/1.root.json"
says 'release 4 '
before=$(sha256sum "$release"/tuf/*.json)
same() { [ "$before" = "$(sha256sum "$release"/tuf/*.json)" ] || fail "$1 changed what is published"; }
printf '#!/bin/sh\necho no token is plugged in >&2\nexit 1\n' >"$keys/token.sh"
refuses "a program that fails" publish "$work/content" "${at[@]}" --comment fifth
says 'no token is plugged in'
same "a program that fails"
sed -i 's/token.sh/rsa.pem/' "$keys/signing.ini"
refuses "a key of another role" publish "$work/content" "${at[@]}" --comment fifth
says 'rsa.pem: its signature is by none'
chmod 644 "$keys/two.pem"
sed -i 's/^targets = .*/targets = two.pem/' "$keys/signing.ini"
refuses "a key that others may read" publish "$work/content" "${at[@]}" --comment fifth
says 'chmod 600'
same "a wrong key"

# ---- in two steps
sed -i 's/^targets = .*/targets = none/' "$keys/signing.ini"
refuses "no signature" publish "$work/content" "${at[@]}" --comment fifth
says '0 signatures, fewer than its threshold of 1'
try "write" publish "$work/content" "${at[@]}" --comment fifth --write-unsigned "$work/staged"
same "writing unsigned"
refuses "what nobody signed" publish "$work/content" "${at[@]}" --add-signature "$work/staged"
openssl dgst -sha256 -sign "$work/online.pem" -out "$work/staged/5.targets.json.token.sig" "$work/staged/5.targets.json.bytes"
refuses "another's signature" publish "$work/content" "${at[@]}" --add-signature "$work/staged"
says '5.targets.json.token.sig: is no signature'
same "adding wrong signatures"
openssl dgst -sha256 -sign "$work/token.pem" -out "$work/staged/5.targets.json.token.sig" "$work/staged/5.targets.json.bytes"
try "add" publish "$work/content" "${at[@]}" --add-signature "$work/staged"
try "two steps" verify "$release" --trust "$keys/tuf/1.root.json"
says 'release 5 '
refuses "once more" publish "$work/content" "${at[@]}" --add-signature "$work/staged"
says 'something else was published'
if [ -d "$deps/tuf" ]; then # the same with the tools that other users of The Update Framework know
	try "write" publish "$work/content" "${at[@]}" --comment sixth --write-unsigned "$work/staged"
	PYTHONPATH=$deps python3 - "$work" "$work/staged/6.targets.json" <<'P'
import sys
from tuf.api.metadata import Metadata, Root
from securesystemslib.signer import CryptoSigner
from cryptography.hazmat.primitives.serialization import load_pem_private_key
work, path = sys.argv[1:]
signer = CryptoSigner(load_pem_private_key(open(f"{work}/token.pem", "rb").read(), None))
root = Metadata[Root].from_file(f"{work}/keys/tuf/2.root.json").signed
signer.public_key.keyid = root.roles["targets"].keyids[0]
targets = Metadata.from_file(path)
targets.sign(signer, append=True)
targets.to_file(path)
P
	try "add" publish "$work/content" "${at[@]}" --add-signature "$work/staged"
	try "python-tuf" verify "$release" --trust "$keys/tuf/1.root.json"
	says 'release 6 '
fi
