#!/bin/bash
# How fast scans become meshes: processor seconds of the whole import, the median of three runs,
# so that what else the machine does counts little.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content >/dev/null
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
build/gopura-content temple --triangles 2000000 --out "$folder/temple.ply" >/dev/null 2>&1

# The same as text, by the words of the format alone.
python3 - "$folder/temple.ply" "$folder/ascii.ply" <<'END'
import struct, sys
data = open(sys.argv[1], 'rb').read()
end = data.index(b'end_header\n') + 11
types = {'float': 'f', 'uchar': 'B', 'int': 'i', 'uint': 'I', 'double': 'd', 'ushort': 'H', 'char': 'b', 'short': 'h'}
out = open(sys.argv[2], 'w')
out.write(data[:end].decode().replace('binary_little_endian', 'ascii'))
elements, at = [], end
for line in data[:end].decode().splitlines():
    word = line.split()
    if word[0] == 'element': elements.append((int(word[2]), []))
    if word[0] == 'property': elements[-1][1].append(word[1:-1])
for count, properties in elements:
    if properties[0][0] != 'list':
        record = struct.Struct('<' + ''.join(types[p[0]] for p in properties))
        for values in record.iter_unpack(data[at:at + count * record.size]):
            out.write(' '.join('%.7g' % v for v in values) + '\n')
        at += count * record.size
    else:
        record = struct.Struct('<' + types[properties[0][1]] + '3' + types[properties[0][2]])
        for values in record.iter_unpack(data[at:at + count * record.size]):
            out.write('%d %d %d %d\n' % values)
        at += count * record.size
END

# measure FILE: a JSON object.
measure() {
	python3 - "$1" <<'END'
import json, os, re, resource, subprocess, sys
runs = []
for _ in range(3):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    report = subprocess.run(['build/gopura-content', 'import', sys.argv[1]], check=True, capture_output=True, text=True).stdout
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    runs.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
triangles = int(re.search(r', (\d+) triangles', report).group(1))
seconds = sorted(runs)[1]
print(json.dumps({'triangles': triangles, 'file_mb': round(os.path.getsize(sys.argv[1]) / 1e6, 1), 'cpu_s': round(seconds, 3),
                  'mtri_per_cpu_s': round(triangles / seconds / 1e6, 2), 'peak_mb': round(after.ru_maxrss / 1024)}))
END
}

{
	printf '{"ply_binary": %s,\n "ply_ascii": %s' "$(measure "$folder/temple.ply")" "$(measure "$folder/ascii.ply")"
	venus=../shared/scans/venus-cc0-textured/decoded/venus.obj
	[ ! -f "$venus" ] || printf ',\n "obj_with_picture": %s' "$(measure "$venus")"
	printf '}\n'
} >"$folder/import.json"
mkdir -p build/bench
mv "$folder/import.json" build/bench/import.json
