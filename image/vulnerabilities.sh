#!/bin/bash
# vulnerabilities.sh PACKAGES TRACKER: prints the known vulnerabilities of an image's packages, by Debian's security
# tracker, a line each, with tabs between: CVE, urgency, source, its version in the image, the version that mends it (or
# "open"), how Debian treats it, title.
#
# PACKAGES as in sbom.sh. TRACKER is the file or address of the tracker's data:
# https://security-tracker.debian.org/tracker/data/json. Exit status: 0 none that an update would mend; 3 at least
# one: build the image anew; 1 the data cannot be read.
set -eu
[ $# = 2 ] || { sed -n '2,9s/^# //p' "$0" >&2; exit 2; }
packages=$1 tracker=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
case $tracker in
https://*)
	curl -sSfL --connect-timeout 20 --max-time 300 -o "$work/tracker.json" "$tracker" || { echo "vulnerabilities: $tracker cannot be fetched" >&2; exit 1; }
	tracker=$work/tracker.json
	;;
esac
[ -s "$packages" ] || { echo "vulnerabilities: $packages is no list of packages" >&2; exit 1; }
cut -f4,5 "$packages" | LC_ALL=C sort -u >"$work/sources"
jq -r --rawfile sources "$work/sources" '
	. as $tracker | $sources | split("\n")[] | select(. != "") | split("\t") as [$source, $version]
	| ($tracker[$source] // {}) | to_entries[] | .key as $cve | .value.description as $title
	| .value.releases.bookworm // empty
	| select(.status == "open" or (.status == "resolved" and (.fixed_version // "0") != "0"))
	| [$cve, .urgency // "not yet assigned", $source, $version,
		(if .status == "open" then "open" else .fixed_version end),
		(if .status == "resolved" then "update" elif .nodsa then "no update of its own: \(.nodsa)" else "none yet" end),
		($title // "" | gsub("[\t\n]"; " ") | .[0:100])] | @tsv' "$tracker" >"$work/found" ||
	{ echo "vulnerabilities: $tracker is not the data of Debian's security tracker (JSON)" >&2; exit 1; }
while IFS=$'\t' read -r cve urgency source version fixed how title; do
	[ "$fixed" = open ] || dpkg --compare-versions "$version" lt "$fixed" || continue
	printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$cve" "$urgency" "$source" "$version" "$fixed" "$how" "$title"
done <"$work/found" | LC_ALL=C sort -t "$(printf '\t')" -k5,5 -k3,3 -k1,1 >"$work/report"
cat "$work/report"
echo "vulnerabilities: $(wc -l <"$work/report") known, $(grep -c $'\tupdate\t' "$work/report" || true) of them mended by an update, in $(wc -l <"$work/sources") sources" >&2
! grep -q $'\tupdate\t' "$work/report" || exit 3
