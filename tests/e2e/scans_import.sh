#!/bin/bash
# Real scans are read completely: triangles (those of the file minus the degenerate ones), pictures, colours; and
# nothing is lost in the cache file.
set -u
cd "$(dirname "$0")/../.."
scans=../shared/scans
[ -d "$scans" ] || { echo "$scans is absent"; exit 77; }
make --no-print-directory -j"$(nproc)" build/gopura-content >/dev/null || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0

# expect TRIANGLES_IN_FILE PICTURES COLOURS BORDERS FILE
expect() {
	local all=$1 pictures=$2 colours=$3 borders=$4 file=$scans/$5 report kept dropped open
	report=$(timeout 60 build/gopura-content import --out "$folder/mesh" "$file" 2>&1) ||
		{ echo "FAIL $file: $report"; bad=1; return; }
	kept=$(sed -nE '1s/.*, ([0-9]+) triangles,.*/\1/p' <<<"$report")
	dropped=$(sed -nE 's/^  ([0-9]+) degenerate face.*/\1/p' <<<"$report")
	open=$(sed -nE 's/^  ([0-9]+) border edge.*/\1/p' <<<"$report")
	[ $((kept + ${dropped:-0})) = "$all" ] || { echo "FAIL $file: $kept + ${dropped:-0} triangles, not $all"; bad=1; }
	[ "${open:-0}" = "$borders" ] || { echo "FAIL $file: ${open:-0} border edges, not $borders"; bad=1; }
	case $pictures in 0) ;; *) grep -qE "colours: $pictures pictures?\$" <<<"$report" || { echo "FAIL $file: not $pictures pictures"; bad=1; } ;; esac
	[ -z "$colours" ] || grep -q "colours: $colours" <<<"$report" || { echo "FAIL $file: colours: not $colours"; bad=1; }
	! grep -q warning <<<"$report" || { echo "FAIL $file: $report"; bad=1; }
	[ "$(stat -c %s "$folder/mesh")" -gt $((kept * 18)) ] || { echo "FAIL $file: nothing in the cache"; bad=1; }
	echo "$(head -n 1 <<<"$report")"
}

expect 597703 1 '' 4 venus-cc0-textured/decoded/venus.obj
expect 532502 25 '' 528 bust-zeus-head/koepfchenzeus.obj
expect 179999 9 '' 273 bust-sphinx-head/koepfchensphinx.obj
expect 99970 0 none 0 lucy-100k/lucy.ply
expect 69451 0 none 223 stanford-bunny/reconstruction/bun_zipper.ply
expect 50000 0 "the scan's own" 0 gargoyle-vertex-colour/gargo.ply
expect 70000 0 none 0 nefertiti/nefertiti-lowres.obj

# Scenes of VRML97 from archives; what is left out of them is a warning.
# expect_scene TRIANGLES FILE
expect_scene() {
	local report
	report=$(timeout 60 build/gopura-content import --up y "$scans/vrml97/$2" 2>&1) ||
		{ echo "FAIL $2: $report"; bad=1; return; }
	grep -q ": VRML, $1 triangles," <<<"$report" || { echo "FAIL $2: not $1 triangles: $report"; bad=1; }
}
expect_scene 6762 HelloWorld.wrl
expect_scene 3732 Wuson.wrl
expect_scene 85266 grasshop.wrl
expect_scene 2000 MotionCaptureROM.WRL

# Venus has 377 faces that show their inside; lighting and culling would make holes of them.
build/gopura-content import "$scans/venus-cc0-textured/decoded/venus.obj" | grep -q "  377 faces showing the wrong side, turned" || { echo "FAIL venus: faces not turned"; bad=1; }

# A single range image has no surface, and the message says so.
said=$(build/gopura-content import "$scans/happy-buddha-range/happyStandRight_0.ply" 2>&1) && bad=1
grep -q 'range image' <<<"$said" || { echo "FAIL range image: $said"; bad=1; }
exit $bad
