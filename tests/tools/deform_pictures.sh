#!/bin/bash
# Draws the pictures of docs/deform.md into DIR: deform_pictures.sh DIR. The demo temple is bent, as a bad capture would
# be, and bent back: by a lattice, and along a surface.
set -eu
cd "$(dirname "$0")/../.."
out=$(realpath "${1:?give the folder for the pictures}")
make --no-print-directory build/gopura-content >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/gopura-content temple --triangles 400000 --out "$folder/temple.ply" >/dev/null 2>&1

# lean SIGN: x moves by a square of the height; control points of z * z are k * k - 1/3.
lean() {
	awk -v s="$1" 'BEGIN {
		printf "{\"steps\": [{\"lattice\": [1, 1, 4], \"box\": {\"low\": [-30, -30, 0], \"high\": [30, 30, 26]}, \"moves\": ["
		for (k = -1; k <= 5; k++)
			printf("%s{\"points\": [\"all\", \"all\", %d], \"by\": [%.9f, 0, 0]}", (k > -1) ? ", " : "", k, s * 0.55 * (k * k - 1 / 3))
		print "]}]}"
	}'
}
# along WAY: an arch under the temple, 60 m across and 14 m high.
along() {
	echo "{\"steps\": [{\"surface\": {\"way\": \"$1\", \"order\": [3, 2], \"points\": [
		[[-30, -30, -14], [0, -30, 14], [30, -30, -14]], [[-30, 30, -14], [0, 30, 14], [30, 30, -14]]]}}]}"
}
echo "0 -78 34 0 0 6 33" >"$folder/views"
# picture NAME SCAN
picture() {
	mkdir -p "$folder/$1"
	cp "$2" "$folder/$1/scan.ply"
	printf '[model]\nscans = scan.ply\ncolours = #d8c7a8\n' >"$folder/$1/temple.ini"
	build/gopura-content render "$folder/$1" --views "$folder/views" --size 420x260 --supersample 3 --out "$folder/$1/out" >/dev/null
	mv "$folder/$1/out/view-0000.png" "$out/deform-$1.png"
}
# bent NAME JSON IN OUT
bent() {
	echo "$2" >"$folder/$1.json"
	echo "== $1"
	build/gopura-content deform --with "$folder/$1.json" --out "$4" "$3"
}
bent leaning "$(lean 1)" "$folder/temple.ply" "$folder/leaning.ply"
bent upright "$(lean -1)" "$folder/leaning.ply" "$folder/upright.ply"
bent warped "$(along onto)" "$folder/temple.ply" "$folder/warped.ply"
bent flat "$(along flat)" "$folder/warped.ply" "$folder/flat.ply"
for name in leaning upright warped flat; do
	picture "$name" "$folder/$name.ply"
done
