#!/bin/bash
# The tools that select a part in a view: time and error with a scripted hand, on carvings of the temple whose faces the
# generator knows, and on parts of real scans that a person has gone around once (regions-*.txt). build/bench/regions.json, and pictures in build/bench/regions/.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/regions
mkdir -p "$work"
make --no-print-directory -j"$(nproc)" build/gopura-content build/tests/bench/bench_regions >/dev/null
[ -f "$work/temple.ply" ] ||
	build/gopura-content temple --triangles 5000000 --seed 1 --regions "$work/faces" --out "$work/temple.ply" >/dev/null
# measure NAME SCAN UP <PARTS: build/bench/regions/NAME.json
measure() { build/tests/bench/bench_regions "$2" "$3" "$work" >"$work/$1.json"; }
for part in lion-16 lion-4 naga-3 naga-5 lintel-3 pediment-5 column-7 antefix-100 antefix-300 face-1 stairs-4 lotus-1; do
	echo "$part faces $work/faces/$part.faces"
done | measure temple "$work/temple.ply" z
scans=../shared/scans
rm -f "$work/nefertiti.json" "$work/gargoyle.json"
[ ! -d "$scans" ] || measure nefertiti "$scans/nefertiti/nefertiti-lowres.obj" y <tests/bench/regions-nefertiti.txt
[ ! -d "$scans" ] || measure gargoyle "$scans/gargoyle-vertex-colour/gargo.ply" y <tests/bench/regions-gargoyle.txt
python3 - <<'P'
import json
import os

tools, rows = {}, []
for name in ["temple", "nefertiti", "gargoyle"]:
    if os.path.exists(f"build/bench/regions/{name}.json"):
        rows += json.load(open(f"build/bench/regions/{name}.json"))["rows"]
json.dump({"rows": rows}, open("build/bench/regions.json", "w"), indent=1)
for row in rows:
    print(f"{row['part']}: {row['shown']} faces shown, superpixels {row['superpixels_ms']:.0f} ms")
    for tool in row["tools"]:
        runs = tool["runs"]
        mean = lambda key: sum(run[key] for run in runs) / len(runs)
        figures = [mean("hand_s") + mean("compute_ms") / 1000, 100 * mean("first_error"), 100 * mean("error"),
                   max(run["longest_ms"] for run in runs), mean("strokes")]
        tools.setdefault(tool["tool"], []).append(figures)
        print("  {:12} {:5.1f} s, {:5.1f} % wrong at first, {:5.1f} % in the end, {:4.0f} ms for a cut, {:.1f} strokes".format(
            tool["tool"], *figures))
for tool, all in tools.items():
    print("all  {:12} {:5.1f} s, {:5.1f} % wrong at first, {:5.1f} % in the end".format(
        tool, *[sum(figures[i] for figures in all) / len(all) for i in range(3)]))
P
