#!/bin/bash
# make-release.sh WORK: a small release of the demo's content, WORK/release.
set -eu
work=$1
content=$work/content
mkdir -p "$content"
cp -ru demo/content/. "$content/"
sed -i -e 's/^points *=.*/points = 4/' -e 's/^face_px *=.*/face_px = 256/' \
	-e 's/^publish_share *=.*/publish_share = 0.5/' "$content/temple.ini"
plan=$(cat pipeline/temple*.[ch] format/stone.[ch] | cksum)
if [ "$plan" != "$(cat "$work/plan" 2>/dev/null)" ]; then
	build/gopura-content temple --triangles 60000 --seed 1 --regions "$content/regions" --out "$content/scan.ply"
	echo "$plan" >"$work/plan"
fi
build/gopura-content build "$content" --out "$work/release"
