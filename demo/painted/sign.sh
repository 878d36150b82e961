#!/bin/sh
# Paints the board beside the eastern gate: demo/content/scenes/sign.png. Needs pango-view and the fonts of packages.txt.
set -eu
cd "$(dirname "$0")"
pango-view --no-display --markup --align=center --background='#5a1f14' --margin=40 --dpi=96 -q \
	-o ../content/scenes/sign.png sign.pango
