#!/bin/bash
# make-release.sh WORK: publishes a small release of the demo's content as WORK/release.
set -eu
work=$1
demo/make-content.sh "$work/content" 60000
sed -i -e 's/^points *=.*/points = 4/' -e 's/^face_px *=.*/face_px = 256/' \
	-e 's/^publish_share *=.*/publish_share = 0.5/' "$work/content/temple.ini"
build/gopura-content build "$work/content" --out "$work/release" --keys "$work/keys"
