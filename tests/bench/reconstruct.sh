#!/bin/bash
# The surface of many range images: time and memory. IMAGES=100 is the size that must stay within 2 GiB
# (TMPDIR: a disk with room); by default as many as take minutes. build/bench/reconstruct.json.
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/tools/range_wall >/dev/null
images=${IMAGES:-9} side=${SIDE:-1000}
folder=$(mktemp -d -p "${TMPDIR:-/var/tmp}")
trap 'rm -rf "$folder"' EXIT
mkdir -p build/bench
build/tests/tools/range_wall "$folder" "$images" "$side"
/usr/bin/env python3 - "$images" "$folder" build/bench/reconstruct.json <<'P'
import glob
import json
import re
import resource
import subprocess
import sys
import time

images, folder, out = int(sys.argv[1]), sys.argv[2], sys.argv[3]
began = time.monotonic()
said = subprocess.run(["build/gopura-content", "reconstruct", "--out", f"{folder}/wall-surface.out",
                       *sorted(glob.glob(f"{folder}/wall-*.ply"))], check=True, capture_output=True, text=True).stdout
used = resource.getrusage(resource.RUSAGE_CHILDREN)
row = {"images": images,
       "points": int(re.search(r" (\d+) points", said).group(1)),
       "triangles": int(re.search(r"surface: (\d+) triangles", said).group(1)),
       "border_edges": int(re.search(r"(\d+) border edges", said).group(1)),
       "parts": int(re.search(r"(\d+) parts", said).group(1)),
       "seconds": round(time.monotonic() - began, 1),
       "processor_s": round(used.ru_utime + used.ru_stime, 1),
       "resident_mb": round(used.ru_maxrss * 1024 / 1e6)}
with open(out, "w") as file:
    json.dump(row, file)
print(json.dumps(row))
P
