#!/bin/bash
# Prints the path of axe-core's script, which judges whether pages can be used by everyone. It is fetched once with npm, in
# this version and with this hash, into build/axe; AXE=FILE names another copy. Exits with 77 where it cannot be had.
set -eu
cd "$(dirname "$0")/../.."
version=4.14.1
hash=sha512-FHfa+lmNjQZfJz1q8wKqIDwC6DExcHt/pkjNQb09a3NPjCKg2rhu5qb2S4r76ASyFNNtuFooJpZe37OgudVGtQ==
[ -z "${AXE:-}" ] || { echo "$AXE"; exit 0; }
script=build/axe/$version/axe.min.js
if [ ! -f "$script" ]; then
	command -v npm >/dev/null || { echo "npm is not installed" >&2; exit 77; }
	work=$(mktemp -d)
	trap 'rm -rf "$work"' EXIT
	(cd "$work" && timeout 60 npm pack --silent --ignore-scripts "axe-core@$version") >/dev/null 2>&1 || { echo "axe-core cannot be fetched" >&2; exit 77; }
	found=sha512-$(openssl dgst -sha512 -binary "$work/axe-core-$version.tgz" | base64 -w 0)
	[ "$found" = "$hash" ] || { echo "axe-core $version has the hash $found" >&2; exit 1; }
	tar -xzf "$work/axe-core-$version.tgz" -C "$work" package/axe.min.js
	mkdir -p "${script%/*}"
	mv "$work/package/axe.min.js" "$script"
fi
echo "$script"
