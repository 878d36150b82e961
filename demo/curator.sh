#!/bin/bash
# make curator: serves the demo temple to a curator's browser. Ctrl-C ends it.
#
#   demo/curator.sh [TRIANGLES]
#   FOLDER=build/demo PORT=8780 demo/curator.sh     a folder whose content is there already is taken as it is
#
# The content is that of make demo, in build/demo/content; without a number of triangles an existing temple keeps its
# size, and a new one has a million. Only its hierarchy is made, which takes a minute, not a release. The account
# "demo" gets a new password each time, which is printed with the address.
set -eu
cd "$(dirname "$0")/.."
folder=${FOLDER:-build/demo}
content=$folder/content
if [ -z "${FOLDER:-}" ]; then
	triangles=${1:-$(cat build/demo/triangles 2>/dev/null || echo 1000000)}
	demo/make-content.sh "$content" "$triangles"
	echo "$triangles" >build/demo/triangles
fi
build/gopura-content hierarchy "$content"
password=$(od -An -N9 -tx1 /dev/urandom | tr -d ' \n' | sed 's/....../&-/g; s/-$//')
if build/gopura-curator user list "$content" | grep -q ' demo$'; then
	build/gopura-curator user password "$content" demo <<<"$password"
else
	build/gopura-curator user add "$content" demo --role publisher <<<"$password"
fi
echo "Sign in as demo with the password $password"
# Where make demo has made a release, the page publishes the next one.
release=()
if [ -f "$folder/release/release.json" ]; then
	release=(--release "$folder/release")
	build/gopura-curator publisher "$content" --out "$folder/release" --keys "$folder/keys" &
	trap 'kill $! 2>/dev/null; wait' EXIT
fi
build/gopura-curator "$content" --port "${PORT:-8780}" "${release[@]}"
