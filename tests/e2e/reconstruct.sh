#!/bin/bash
# The Happy Buddha from its 15 range images: open, watertight, and with so many triangles as asked; the result is
# imported without a fault. Damaged
# files are refused with file, place and cure.
set -u
cd "$(dirname "$0")/../.."
scans=../shared/scans/happy-buddha-range
[ -d "$scans" ] || { echo "$scans is absent"; exit 77; }
make --no-print-directory -j"$(nproc)" build/gopura-content >/dev/null || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0
fail() { bad=1; echo "FAIL $*"; }

# reconstruct NAME OPTIONS...: its report is in $report
reconstruct() {
	local name=$1
	shift
	report=$(timeout 120 build/gopura-content reconstruct --out "$folder/$name.ply" "$@" 2>&1) || fail "$name: $report"
	echo "$name: $(grep '^surface' <<<"$report")"
	echo "    $(tail -n 1 <<<"$report")"
}
number() { sed -nE "s/.*[^0-9]([0-9]+) $1.*/\\1/p" <<<"$report"; } # the number before a word

reconstruct open "$scans/happyStandRight.conf" --cell 1
[ "$(number triangles)" -gt 120000 ] || fail "open: too few triangles"
[ "$(number 'border edges')" -gt 0 ] || fail "open: it has no border"
reconstruct closed "$scans/happyStandRight.conf" --cell 1 --closed
[ "$(number 'border edges') $(number 'crowded edges')" = '0 0' ] || fail "closed: not watertight"
[ "$(number parts)" = 1 ] || fail "closed: not one part"
imported=$(build/gopura-content import "$folder/closed.ply") || fail "import refuses it"
grep -q ' triangles' <<<"$imported" || fail "import: $imported"
! grep -qE 'border|degenerate|wrong side|more faces' <<<"$imported" || fail "import finds faults: $imported"
grep -qE 'box -0.04[0-9] 0.04[0-9] -0.04[0-9] to 0.03[0-9] 0.25[0-9] 0.03[0-9] m' <<<"$imported" || fail "box: $imported"

for budget in 100 20001; do
	reconstruct "budget-$budget" "$scans/happyStandRight.conf" --cell 1 --closed --budget-triangles $budget
	[ "$(number 'border edges') $(number 'crowded edges')" = '0 0' ] || fail "budget $budget: not watertight"
	made=$(sed -nE 's/^surface: ([0-9]+) triangles.*/\1/p' <<<"$report")
	[ "$made" -le $budget ] && [ $((100 * made)) -ge $((98 * budget)) ] || fail "budget $budget: $made triangles"
done
build/gopura-content import "$folder/budget-20001.ply" >/dev/null || fail "import refuses the budget's mesh"

# refused OPTIONS...: the message is in $said
refused() {
	said=$(build/gopura-content reconstruct --out "$folder/none.ply" "$@" 2>&1) && fail "not refused: $*"
	[ ! -e "$folder/none.ply" ] || fail "a file was written: $*"
	echo "    $said" | tail -n 1
}
head -c 2000000 "$scans/happyStandRight_0.ply" >"$folder/cut.ply"
refused "$folder/cut.ply"
grep -q "$folder/cut.ply.*copy it again" <<<"$said" || fail "cut: $said"
sed 's/num_cols 371/num_cols 400/' "$scans/happyStandRight_0.ply" >"$folder/cells.ply"
refused "$folder/cells.ply"
grep -q "$folder/cells.ply: its range_grid has 244860 cells" <<<"$said" || fail "cells: $said"
sed '40s/-/x/' "$scans/happyStandRight_0.ply" >"$folder/word.ply"
refused "$folder/word.ply"
grep -q "$folder/word.ply:40: vertex .* is not a number" <<<"$said" || fail "word: $said"
refused "$scans/happyStandRight_0.ply" --budget-triangles 100
grep -q 'needs --closed' <<<"$said" || fail "open budget: $said"
refused "$scans/happyStandRight_0.ply" --cell 0.000001
grep -q 'correct the unit' <<<"$said" || fail "tiny cubes: $said"
exit $bad
