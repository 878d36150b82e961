#!/bin/bash
# Build throughput: the demo temple of 300 000 triangles from nothing to a signed release, on all
# cores, with its shares; hierarchy also in processor seconds. And rows of larger scans, from the file to
# the hierarchy (build_rows.py; 100 million by build_large.sh). build/bench/build.json.
#
#   TRIANGLES=N       of the temple (default 300000)
#   MILLIONS="1 10"   of triangles, a row each
set -eu
cd "$(dirname "$0")/../.."
make --no-print-directory build/gopura-content build/tests/bench/bench_loaded >/dev/null
work=build/bench/build-work
rm -rf "$work"
mkdir -p "$work"
trap 'rm -rf "$work"' EXIT
cp -r demo/content "$work/content"
# shellcheck disable=SC2086
rows=$(python3 tests/bench/build_rows.py build/bench/build-rows ${MILLIONS:-1 10})
python3 - "$work" "${TRIANGLES:-300000}" "$rows" >build/bench/build.json.new <<'P'
import json
import os
import re
import resource
import subprocess
import sys
import time

work, wanted, rows = sys.argv[1:]
content = "build/gopura-content"


def run(*arguments):
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run([content, *arguments], check=True, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done.stdout, time.monotonic() - began, cpu


scan, folder = f"{work}/content/scan.ply", f"{work}/content"
_, temple_s, _ = run("temple", "--triangles", wanted, "--seed", "1", "--regions", f"{folder}/regions",
                     "--out", scan)
said, import_s, _ = run("import", scan)
triangles = int(re.search(r", (\d+) triangles", said)[1])
_, hierarchy_s, hierarchy_cpu_s = run("hierarchy", folder)
said, sample_s, sample_cpu_s = run("sample", folder)
points = int(re.search(r"sampling: (\d+) points", said)[1])
_, publish_s, _ = run("build", folder, "--out", f"{work}/release")
size = sum(os.path.getsize(os.path.join(at, name)) for at, _, names in os.walk(f"{work}/release") for name in names)
print(json.dumps({
    "cores": os.cpu_count(), "load": os.getloadavg()[0], "triangles": triangles,
    "temple_s": round(temple_s, 2), "import_s": round(import_s, 2),
    "import_mtri_per_s": round(triangles / import_s / 1e6, 3),
    "hierarchy_s": round(hierarchy_s, 2), "hierarchy_cpu_s": round(hierarchy_cpu_s, 2),
    "hierarchy_mtri_per_s": round(triangles / hierarchy_s / 1e6, 4),
    "sampling_points": points, "sampling_s": round(sample_s, 2), "sampling_cpu_s": round(sample_cpu_s, 2),
    "sampling_faces_per_s": round(6 * points / sample_s, 2),
    "publish_s": round(publish_s, 2), "release_mb": round(size / 1e6, 2),
    "all_s": round(temple_s + hierarchy_s + sample_s + publish_s, 1),
    "rows": json.loads(rows),
}, indent=1))
P
mv build/bench/build.json.new build/bench/build.json
