#!/bin/bash
# By make bench-full. Our surface of range images beside Poisson reconstruction (CGAL's) at equal resolution: the Happy
# Buddha, and the top of a tower of the demo temple whose truth is known, with 0, 1 and 5 mm of noise. build/bench/poisson.json.
set -eu
cd "$(dirname "$0")/../.."
./deps.sh tests/bench/poisson-tools.txt
make --no-print-directory -j"$(nproc)" build/tests/bench/bench_poisson build/gopura-content >/dev/null
poisson=build/tests/bench/poisson
[ $poisson -nt tests/bench/poisson.cpp ] ||
	g++ -O2 -DNDEBUG -DCGAL_EIGEN3_ENABLED -I/usr/include/eigen3 -o $poisson tests/bench/poisson.cpp -lgmp -lmpfr
folder=$(mktemp -d -p "${TMPDIR:-/var/tmp}")
trap 'rm -rf "$folder"' EXIT
mkdir -p build/bench
build/gopura-content temple --triangles "${TRIANGLES:-2000000}" --out "$folder/temple.ply" >/dev/null
for noise in 0 0.001 0.005; do
	mkdir "$folder/tower-$noise"
	build/tests/bench/bench_poisson views "$folder/temple.ply" "$folder/tower-$noise" $noise
done
/usr/bin/env python3 - "$folder" ../shared/scans/happy-buddha-range/happyStandRight.conf build/bench/poisson.json <<'P'
import json
import os
import subprocess
import sys
import time

folder, buddha, out = sys.argv[1:]
bench = "build/tests/bench/bench_poisson"


def timed(command):
    """Seconds, seconds of processor and megabytes of a command; None if it failed."""
    log = f"{folder}/time"
    began = time.monotonic()
    failed = subprocess.run(["timeout", "1800", "/usr/bin/time", "-o", log, "-f", "%U %S %M", *command],
                            capture_output=True).returncode
    if failed:
        return None
    user, system, kilobytes = map(float, open(log).read().split()[-3:])
    return {"seconds": round(time.monotonic() - began, 1),
                                "processor_s": round(user + system, 1),
                                "resident_mb": round(kilobytes * 1024 / 1e6)}


def points_of(alignment, name, every=1):
    said = subprocess.run([bench, "points", alignment, f"{folder}/{name}.points", str(every)], check=True,
                          capture_output=True, text=True).stdout.split()
    return int(said[0]), float(said[1])


rows = []
cases = [(f"tower, {mm} mm of noise", f"{folder}/tower-{noise}/site.aln", 1.0, f"{folder}/truth.points", 1)
         for mm, noise in ((0, "0"), (1, "0.001"), (5, "0.005"))]
if os.path.exists(buddha):
    # judged by all of its points, made of every 16th by Poisson, which takes long
    points_of(buddha, "buddha")
    cases.append(("Happy Buddha", buddha, 1.0, f"{folder}/buddha.points", 16))
points_of(f"{folder}/tower-0/site.aln", "truth")
for name, alignment, metres, truth, every in cases:
    count, spacing = points_of(alignment, "scan", every)
    cell = str(1500 * spacing * metres)
    for what, command in (
            ("ours, closed", ["build/gopura-content", "reconstruct", alignment, "--unit", str(metres), "--cell", cell,
                              "--closed", "--out", f"{folder}/surface.ply"]),
            ("ours, open", ["build/gopura-content", "reconstruct", alignment, "--unit", str(metres), "--cell", cell,
                          "--out", f"{folder}/surface.ply"]),
            ("Poisson", ["build/tests/bench/poisson", f"{folder}/scan.points", str(spacing),
                         os.environ.get("RADIUS", "1"), f"{folder}/surface.off"])):
        row = {"scan": name, "what": what, "points": count, "spacing_mm": round(1000 * spacing * metres, 3)}
        used = timed(command)
        if used:
            row.update(used)
            said = subprocess.run([bench, "compare", command[-1], truth, str(metres),
                                   str(3 * spacing * metres)], check=True, capture_output=True, text=True).stdout
            row.update(json.loads("{" + said + "}"))
        else:
            row["failed"] = True
        print(json.dumps(row), file=sys.stderr)
        rows.append(row)
with open(out, "w") as file:
    json.dump(rows, file, indent=1)
P
