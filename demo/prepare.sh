#!/bin/bash
# The demo temple and its signed release in build/demo/; what is there already stays.
#
#   demo/prepare.sh [TRIANGLES]
set -eu
cd "$(dirname "$0")/.."
demo=build/demo content=build/demo/content
triangles=${1:-$(cat "$demo/triangles" 2>/dev/null || echo 2000000)}
mkdir -p "$content"
cp -ru demo/content/. "$content/"
if [ ! -f "$content/scan.ply" ] || [ "$(cat "$demo/triangles" 2>/dev/null)" != "$triangles" ]; then
	echo "Making the temple: $triangles triangles ..."
	build/gopura-content temple --triangles "$triangles" --seed 1 --out "$content/scan.ply.part"
	mv "$content/scan.ply.part" "$content/scan.ply"
	echo "$triangles" >"$demo/triangles"
fi
build/gopura-content build "$content" --out "$demo/release"
