#!/bin/bash
# sbom.sh PACKAGES VERSION: prints what a terminal's image is made of, as SPDX 2.3 in JSON.
#
# PACKAGES has a line for each package, with tabs between: name, version, architecture, source, version of the source
# (build/image/packages.txt). VERSION is that of the programs of this tree. The time is SOURCE_DATE_EPOCH, so the same
# image gives the same bytes.
set -eu
[ $# = 2 ] || { sed -n '2,6s/^# //p' "$0" >&2; exit 2; }
packages=$1 version=$2
[ -r "$packages" ] || { echo "sbom: $packages cannot be read" >&2; exit 1; }
awk -F'\t' 'NF != 5 || $1 == "" || $2 == "" {
	print FILENAME ":" FNR ": not five fields: name, version, architecture, source, its version" > "/dev/stderr"; wrong = 1
}
END { exit wrong || NR == 0 }' "$packages" || { echo "sbom: $packages is no list of packages" >&2; exit 1; }
LC_ALL=C sort -u "$packages" | jq -R -s --arg version "$version" \
	--arg created "$(date -u -d "@${SOURCE_DATE_EPOCH:-$(date +%s)}" +%Y-%m-%dT%H:%M:%SZ)" \
	--arg hash "$({ echo "$version"; LC_ALL=C sort -u "$packages"; } | sha256sum | cut -c1-32)" '
	def id: "SPDXRef-" + gsub("[^A-Za-z0-9.-]"; "-");
	[split("\n")[] | select(. != "") | split("\t")
		| {name: .[0], version: .[1], arch: .[2], source: .[3], of: .[4]}
		| .id = ("\(.name)-\(.arch)" | id)] as $packages
	| {
		spdxVersion: "SPDX-2.3", dataLicense: "CC0-1.0", SPDXID: "SPDXRef-DOCUMENT",
		name: "gopura-appliance-\($version)",
		documentNamespace: "https://gopura.example/spdx/\($hash)",
		creationInfo: {created: $created, creators: ["Tool: gopura-image-sbom"]},
		documentDescribes: ["SPDXRef-image"],
		packages: ([
			{SPDXID: "SPDXRef-image", name: "gopura-appliance", versionInfo: $version, primaryPackagePurpose: "OPERATING-SYSTEM"},
			{SPDXID: "SPDXRef-gopura", name: "gopura", versionInfo: $version, licenseDeclared: "MIT", primaryPackagePurpose: "APPLICATION"}
		] + [$packages[] | {
			SPDXID: .id, name, versionInfo: .version, supplier: "Organization: Debian",
			sourceInfo: "built from \(.source) \(.of)",
			externalRefs: [{
				referenceCategory: "PACKAGE-MANAGER", referenceType: "purl",
				referenceLocator: "pkg:deb/debian/\(.name)@\(.version | @uri)?arch=\(.arch)&distro=bookworm"
			}]
		}] | map({downloadLocation: "NOASSERTION", filesAnalyzed: false, licenseConcluded: "NOASSERTION",
			licenseDeclared: "NOASSERTION", copyrightText: "NOASSERTION"} + .)),
		relationships: ([{spdxElementId: "SPDXRef-DOCUMENT", relationshipType: "DESCRIBES", relatedSpdxElement: "SPDXRef-image"},
			{spdxElementId: "SPDXRef-image", relationshipType: "CONTAINS", relatedSpdxElement: "SPDXRef-gopura"}]
			+ [$packages[] | {spdxElementId: "SPDXRef-image", relationshipType: "CONTAINS", relatedSpdxElement: .id}])
	}'
