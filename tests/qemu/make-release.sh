#!/bin/bash
# make-release.sh WORK: publishes a small release of the demo's content as WORK/release.
set -eu
work=$1
demo/make-content.sh "$work/content" 60000
sed -i -e 's/^points *=.*/points = 4/' -e 's/^face_px *=.*/face_px = 256/' \
	-e 's/^publish_share *=.*/publish_share = 0.5/' "$work/content/temple.ini"
# Plain materials: with wood and mirrors an emulated kiosk missed its watchdog once, on a busy machine. These tests are
# about the appliance.
python3 - "$work/content/scenes.json" <<'P'
import json, sys

content = json.load(open(sys.argv[1]))
for scene in content["scenes"]:
    scene.pop("materials", None)
json.dump(content, open(sys.argv[1], "w"), ensure_ascii=False)
P
build/gopura-content build "$work/content" --out "$work/release" --keys "$work/keys"
