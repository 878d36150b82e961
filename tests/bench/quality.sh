#!/bin/bash
# Rules for the quality of tiles at equal bytes and at equal SSIM: a temple of 300 000 triangles, and Nefertiti where the
# scans are at hand. Some minutes; build/bench/quality.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/bench/bench_quality >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cp -r demo/content "$folder/temple"
build/gopura-content temple --triangles 300000 --seed 1 --regions "$folder/temple/regions" \
	--out "$folder/temple/scan.ply" >/dev/null 2>&1
scan=../shared/scans/nefertiti/nefertiti-lowres.obj
if [ -f "$scan" ]; then
	mkdir "$folder/nefertiti"
	cp "$scan" "$folder/nefertiti/scan.obj"
	printf '%s\n' '[model]' 'scans = scan.obj' 'up = y' 'unit = mm' >"$folder/nefertiti/temple.ini"
fi
mkdir -p build/bench
comma='{'
for name in temple nefertiti; do
	[ -d "$folder/$name" ] || continue
	printf '%s"%s": ' "$comma" "$name"
	build/tests/bench/bench_quality "$folder/$name"
	comma=', '
done >"$folder/quality.json"
echo '}' >>"$folder/quality.json"
mv "$folder/quality.json" build/bench/quality.json
