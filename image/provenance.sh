#!/bin/bash
# provenance.sh make FOLDER FILE...: prints a signed statement of where the files in FOLDER come from: an in-toto
# statement with SLSA provenance in a DSSE envelope, signed with provenance.key (ed25519) of KEYS, which is created if
# missing. FOLDER has packages.txt and sbom.spdx.json too; ARCH, MIRROR, SEQUENCE, VERSION and KEYS are as in build.sh,
# BUILDER is the URI of who builds.
#
# provenance.sh check STATEMENT PUBLIC FILE...: whether that key signed it and it names each FILE with these bytes.
# Exit status 0, or 1 with the reason.
set -eu
usage() { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
fail() { echo "provenance: $*" >&2; exit 1; }
what=${1:-}
[ $# -ge 3 ] || usage
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
type=application/vnd.in-toto+json
# to_sign FILE: what DSSE signs: its type and the payload, with their lengths
to_sign() { printf 'DSSEv1 %d %s %d ' ${#type} "$type" "$(stat -c %s "$1")"; cat "$1"; }
sha256() { sha256sum <"$1" | cut -d' ' -f1; }
# key_id PUBLIC: the hash of the public key in DER
key_id() { openssl pkey -pubin -in "$1" -outform DER | sha256sum | cut -d' ' -f1; }

make_statement() {
	local folder=$1 keys=${KEYS:-build/image-keys} file modified=false
	shift
	for file in "$@"; do
		printf '%s\t%s\n' "$file" "$(sha256 "$folder/$file")"
	done >"$work/subjects"
	[ -z "$(git status --porcelain --untracked-files=no)" ] || modified=true
	jq -n -c --rawfile subjects "$work/subjects" --rawfile packages "$folder/packages.txt" \
		--arg builder "${BUILDER:-https://gopura.example/builder/unnamed}" --arg arch "${ARCH:-amd64}" \
		--arg mirror "${MIRROR:-http://deb.debian.org}" --arg version "$VERSION" --arg sequence "$SEQUENCE" \
		--arg data "${DATA:-plain}" \
		--arg commit "$(git rev-parse HEAD)" --argjson modified "$modified" --arg list "$(sha256 "$folder/packages.txt")" \
		--arg sbom "$(sha256 "$folder/sbom.spdx.json")" '
		def table: split("\n")[] | select(. != "") | split("\t");
		{
			_type: "https://in-toto.io/Statement/v1",
			subject: [$subjects | table | {name: .[0], digest: {sha256: .[1]}}],
			predicateType: "https://slsa.dev/provenance/v1",
			predicate: {
				buildDefinition: {
					buildType: "https://gopura.example/image/v1",
					externalParameters: {architecture: $arch, mirror: $mirror, version: $version, sequence: $sequence, data: $data},
					resolvedDependencies: ([
						{name: "source", digest: {gitCommit: $commit}, annotations: {modified: $modified}},
						{name: "packages.txt", digest: {sha256: $list}}
					] + ([$packages | table | {uri: "pkg:deb/debian/\(.[0])@\(.[1] | @uri)?arch=\(.[2])&distro=bookworm"}] | sort | unique))
				},
				runDetails: {builder: {id: $builder}, byproducts: [{name: "sbom.spdx.json", digest: {sha256: $sbom}}]}
			}
		}' >"$work/payload"
	if [ ! -f "$keys/provenance.key" ]; then
		mkdir -p "$keys"
		(umask 077 && openssl genpkey -algorithm ed25519 -out "$keys/provenance.key")
		openssl pkey -in "$keys/provenance.key" -pubout -out "$keys/provenance.pub"
	fi
	to_sign "$work/payload" >"$work/signed"
	openssl pkeyutl -sign -rawin -inkey "$keys/provenance.key" -in "$work/signed" -out "$work/signature"
	jq -n -c --arg type "$type" --arg payload "$(base64 -w 0 "$work/payload")" --arg id "$(key_id "$keys/provenance.pub")" \
		--arg signature "$(base64 -w 0 "$work/signature")" \
		'{payloadType: $type, payload: $payload, signatures: [{keyid: $id, sig: $signature}]}'
}

check_statement() {
	local statement=$1 public=$2 file name hash signature
	shift 2
	jq -e --arg type "$type" '.payloadType == $type' "$statement" >/dev/null 2>&1 || fail "$statement is no DSSE envelope of an in-toto statement"
	jq -r .payload "$statement" | base64 -d >"$work/payload" 2>/dev/null || true
	to_sign "$work/payload" >"$work/signed"
	# Keys differ in name only: whichever signature is by this key counts.
	jq -r '.signatures[].sig' "$statement" >"$work/signatures"
	while read -r signature; do
		base64 -d <<<"$signature" >"$work/signature" 2>/dev/null || continue
		! openssl pkeyutl -verify -rawin -pubin -inkey "$public" -in "$work/signed" -sigfile "$work/signature" >/dev/null 2>&1 || {
			for file in "$@"; do
				name=$(basename "$file") hash=$(sha256 "$file")
				jq -e --arg name "$name" --arg hash "$hash" 'any(.subject[]; .name == $name and .digest.sha256 == $hash)' "$work/payload" >/dev/null ||
					fail "$statement does not name $file with these bytes (sha256 $hash)"
			done
			jq -r '.predicate.buildDefinition | .externalParameters as $p | .resolvedDependencies[0] as $s
				| "\($p.architecture) \($p.version), sequence \($p.sequence), of commit \($s.digest.gitCommit)"
				+ (if $s.annotations.modified then " with changes that are not in it" else "" end)' "$work/payload"
			return
		}
	done <"$work/signatures"
	fail "$statement is not signed by the key $public"
}

case $what in
make) make_statement "$@" ;;
check) check_statement "$@" ;;
*) usage ;;
esac
