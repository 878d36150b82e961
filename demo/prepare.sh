#!/bin/bash
# Makes the demo temple and its signed release in build/demo/. Without a number of triangles an existing temple keeps
# its size; a new one has 2 million.
#
#   demo/prepare.sh [TRIANGLES]
set -eu
cd "$(dirname "$0")/.."
demo=build/demo
triangles=${1:-$(cat "$demo/triangles" 2>/dev/null || echo 2000000)}
demo/make-content.sh "$demo/content" "$triangles"
echo "$triangles" >"$demo/triangles"
build/gopura-content build "$demo/content" --out "$demo/release" --keys "$demo/keys"
