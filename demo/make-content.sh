#!/bin/bash
# Makes the demo's content with a procedural temple as its scan. An existing temple is kept unless it has another number
# of triangles or its plan has changed.
#
#   demo/make-content.sh FOLDER TRIANGLES
set -eu
cd "$(dirname "$0")/.."
content=$1 triangles=$2
mkdir -p "$content"
cp -ru demo/content/. "$content/"
temple="$triangles $(cat pipeline/temple/temple*.[ch] pipeline/material/material.[ch] | cksum)"
# Records what the scan was made from. The file is beside the folder, because the folder holds only content.
made=${content%/}.scan
if [ ! -f "$content/scan.ply" ] || [ "$(cat "$made" 2>/dev/null)" != "$temple" ]; then
	echo "Making the temple: $triangles triangles ..."
	build/gopura-content temple --triangles "$triangles" --seed 1 --regions "$content/regions" \
		--out "$content/scan.ply.part"
	mv "$content/scan.ply.part" "$content/scan.ply"
	echo "$temple" >"$made"
fi
