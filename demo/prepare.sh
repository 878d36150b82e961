#!/bin/bash
# The demo temple and its signed release in build/demo/; what is there already stays, unless the
# temple's plan has changed since.
#
#   demo/prepare.sh [TRIANGLES]
set -eu
cd "$(dirname "$0")/.."
demo=build/demo content=build/demo/content
# build/demo/temple: the triangles asked for (0: the usual number), and the sum of the sources.
before=$(cat "$demo/temple" 2>/dev/null || echo 0)
asked=${1:-${before%% *}}
triangles=$asked
[ "$asked" != 0 ] || triangles=2000000
temple="$asked $(cat pipeline/temple*.[ch] format/stone.[ch] | cksum)"
mkdir -p "$content"
cp -ru demo/content/. "$content/"
if [ ! -f "$content/scan.ply" ] || [ "$before" != "$temple" ]; then
	echo "Making the temple: $triangles triangles ..."
	build/gopura-content temple --triangles "$triangles" --seed 1 --regions "$content/regions" \
		--out "$content/scan.ply.part"
	mv "$content/scan.ply.part" "$content/scan.ply"
	echo "$temple" >"$demo/temple"
fi
build/gopura-content build "$content" --out "$demo/release"
