#!/bin/bash
# The signed statement of where an image comes from (image/provenance.sh): it is in the form of in-toto, SLSA and DSSE,
# and the check refuses another file, another key, and every change of the statement.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v jq >/dev/null || skip "jq is not installed"
work=build/e2e/provenance
rm -rf "$work"
mkdir -p "$work"
printf 'epoch\t2:1.0+b~rc1\tarm64\tepoch-src\t2:1.0\nplain\t3-1\tall\tplain\t3-1\n' >"$work/packages.txt"
echo '{}' >"$work/sbom.spdx.json"
echo image >"$work/gopura.img"
echo bundle >"$work/gopura.raucb"
export KEYS=$work/keys VERSION=v9 SEQUENCE=17 ARCH=arm64 MIRROR=http://mirror.example BUILDER=https://museum.example/builder
image/provenance.sh make "$work" gopura.img gopura.raucb >"$work/statement.json"
python3 - "$work" "$(git rev-parse HEAD)" <<'P' || fail "the statement"
import base64, hashlib, json, pathlib, sys

from cryptography.hazmat.primitives.serialization import load_pem_public_key

work, commit = pathlib.Path(sys.argv[1]), sys.argv[2]
envelope = json.loads((work / "statement.json").read_text())
payload, kind = base64.b64decode(envelope["payload"]), envelope["payloadType"].encode()
signed = b"DSSEv1 %d %s %d %s" % (len(kind), kind, len(payload), payload)
public = load_pem_public_key((work / "keys/provenance.pub").read_bytes())
public.verify(base64.b64decode(envelope["signatures"][0]["sig"]), signed)  # by another program than the one that signed
statement = json.loads(payload)
assert statement["_type"] == "https://in-toto.io/Statement/v1" and statement["predicateType"] == "https://slsa.dev/provenance/v1"
assert {one["name"]: one["digest"]["sha256"] for one in statement["subject"]} == {
    name: hashlib.sha256((work / name).read_bytes()).hexdigest() for name in ("gopura.img", "gopura.raucb")}
build = statement["predicate"]["buildDefinition"]
assert build["externalParameters"] == {"architecture": "arm64", "mirror": "http://mirror.example", "version": "v9", "sequence": "17", "data": "plain"}
assert build["resolvedDependencies"][0]["digest"]["gitCommit"] == commit
assert "pkg:deb/debian/epoch@2%3A1.0%2Bb~rc1?arch=arm64&distro=bookworm" in [one.get("uri") for one in build["resolvedDependencies"]]
assert statement["predicate"]["runDetails"]["builder"]["id"] == "https://museum.example/builder"
P
[ "$(stat -c %a "$work/keys/provenance.key")" = 600 ] || fail "others can read the key"
check() { image/provenance.sh check "$@" >"$work/out" 2>"$work/log"; }
check "$work/statement.json" "$work/keys/provenance.pub" "$work/gopura.img" "$work/gopura.raucb" || fail "the good one is refused: $(cat "$work/log")"
grep -q '^arm64 v9, sequence 17, of commit' "$work/out" || fail "not said what it is: $(cat "$work/out")"
refused() { # WHY WHAT STATEMENT PUBLIC FILE
	! check "$3" "$4" "$5" || fail "taken: $2"
	grep -q "$1" "$work/log" || fail "$2: not said why: $(cat "$work/log")"
}
mkdir "$work/other"
echo other >"$work/other/gopura.img"
refused 'does not name .*gopura.img with these bytes' "another file" "$work/statement.json" "$work/keys/provenance.pub" "$work/other/gopura.img"
KEYS=$work/others image/provenance.sh make "$work" gopura.img >"$work/others.json"
refused 'not signed by the key' "another key's" "$work/others.json" "$work/keys/provenance.pub" "$work/gopura.img"
jq -c '.payload |= (@base64d | sub("v9"; "v8") | @base64)' "$work/statement.json" >"$work/changed.json"
refused 'not signed by the key' "a changed statement" "$work/changed.json" "$work/keys/provenance.pub" "$work/gopura.img"
jq -c '.signatures = []' "$work/statement.json" >"$work/unsigned.json"
refused 'not signed by the key' "one without a signature" "$work/unsigned.json" "$work/keys/provenance.pub" "$work/gopura.img"
jq -c '.payloadType = "text/plain"' "$work/statement.json" >"$work/text.json"
refused 'no DSSE envelope' "another type" "$work/text.json" "$work/keys/provenance.pub" "$work/gopura.img"
head -c 100 "$work/statement.json" >"$work/short.json"
refused 'no DSSE envelope' "half a statement" "$work/short.json" "$work/keys/provenance.pub" "$work/gopura.img"
