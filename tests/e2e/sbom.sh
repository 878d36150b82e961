#!/bin/bash
# What an image is made of (image/sbom.sh), and which known vulnerabilities it has (image/vulnerabilities.sh), from the
# packages of this machine and a small file in the form of Debian's security tracker.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v jq >/dev/null || skip "jq is not installed"
work=build/e2e/sbom
rm -rf "$work"
mkdir -p "$work"
form=$(sed -n "s/^package_form='\(.*\)'/\1/p" image/build.sh | sed 's/\\\$/$/g')
dpkg-query -W -f "$form" >"$work/packages.txt"
printf 'epoch\t2:1.0+b~rc1\tamd64\tepoch-src\t2:1.0+b~rc1\nopen\t1.0-1\tall\topen\t1.0-1\nnew\t3.0\tall\tnew\t3.0\n' >>"$work/packages.txt"
export SOURCE_DATE_EPOCH=1700000000
image/sbom.sh "$work/packages.txt" v9 >"$work/sbom.json"
shuf "$work/packages.txt" >"$work/shuffled.txt"
image/sbom.sh "$work/shuffled.txt" v9 | cmp - "$work/sbom.json" || fail "the order of the packages changes the bytes"
python3 - "$work" <<'P' || fail "the SPDX document"
import json
import pathlib
import re
import sys

work = pathlib.Path(sys.argv[1])
document = json.loads((work / "sbom.json").read_text())
lines = [line.split("\t") for line in (work / "packages.txt").read_text().splitlines()]
assert document["spdxVersion"] == "SPDX-2.3" and document["creationInfo"]["created"] == "2023-11-14T22:13:20Z"
packages = {one["SPDXID"]: one for one in document["packages"]}
assert len(packages) == len(document["packages"]) == len(lines) + 2
assert all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", one) for one in packages)
for needed in ("name", "SPDXID", "downloadLocation", "licenseConcluded", "licenseDeclared", "copyrightText"):
    assert all(needed in one for one in packages.values()), needed
assert {(one["name"], one["versionInfo"]) for one in packages.values()} >= {(line[0], line[1]) for line in lines}
contained = {one["relatedSpdxElement"] for one in document["relationships"] if one["relationshipType"] == "CONTAINS"}
assert contained | {"SPDXRef-image"} == set(packages)
purls = {one["name"]: one["externalRefs"][0]["referenceLocator"] for one in packages.values() if "externalRefs" in one}
assert purls["epoch"] == "pkg:deb/debian/epoch@2%3A1.0%2Bb~rc1?arch=amd64&distro=bookworm", purls["epoch"]
P
printf 'name only\n' >"$work/wrong.txt"
! image/sbom.sh "$work/wrong.txt" v9 >/dev/null 2>"$work/log" || fail "a wrong list was taken"
grep -q 'wrong.txt:1: not five fields' "$work/log" || fail "not said which line: $(cat "$work/log")"

# ---- vulnerabilities: open, mended by an update, mended already, of another package, of another Debian
cat >"$work/tracker.json" <<'J'
{"open": {"CVE-2026-1": {"description": "Reads past the end", "releases": {"bookworm": {"status": "open", "urgency": "medium", "nodsa": "Minor issue"}}},
          "CVE-2026-2": {"releases": {"trixie": {"status": "open"}}}},
 "epoch-src": {"CVE-2026-3": {"releases": {"bookworm": {"status": "resolved", "fixed_version": "2:1.0", "urgency": "high"}}},
               "CVE-2026-4": {"releases": {"bookworm": {"status": "resolved", "fixed_version": "0"}}}},
 "new": {"CVE-2026-5": {"releases": {"bookworm": {"status": "resolved", "fixed_version": "2.9-1"}}}},
 "elsewhere": {"CVE-2026-6": {"releases": {"bookworm": {"status": "open"}}}}}
J
report() { # STATUS LINE...: what is printed, and the status that says whether an update mends something
	local expected=$1 status=0
	shift
	image/vulnerabilities.sh "$work/packages.txt" "$work/tracker.json" >"$work/report" 2>"$work/log" || status=$?
	[ "$status" = "$expected" ] || fail "it ends with $status, not $expected: $(cat "$work/log")"
	printf '%b\n' "$@" | cmp - "$work/report" || fail "the report: $(cat "$work/report")"
}
open='CVE-2026-1\tmedium\topen\t1.0-1\topen\tno update of its own: Minor issue\tReads past the end'
report 0 "$open" # 2:1.0+b~rc1 is newer than 2:1.0
sed -i 's/"2:1.0"/"2:1.1"/' "$work/tracker.json"
report 3 'CVE-2026-3\thigh\tepoch-src\t2:1.0+b~rc1\t2:1.1\tupdate\t' "$open"
echo '<html>' >"$work/tracker.json"
! image/vulnerabilities.sh "$work/packages.txt" "$work/tracker.json" >/dev/null 2>"$work/log" || fail "a page of HTML was taken"
grep -q 'tracker.json is not the data' "$work/log" || fail "not said what is wrong: $(cat "$work/log")"
