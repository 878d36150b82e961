"""visit_rows.py WORK: the visits that visit.sh played, as JSON, and their frame times as pictures.
See docs/figures.md."""
import json
import os
import sys

work = sys.argv[1]
VISITS = (("1", "none"), ("1", "core"), ("1", "heat"), ("5", "none"))
WIDTH, HEIGHT, LEFT, TOP, MOST_MS = 960, 300, 50, 30, 200
ORBIT, WALK = 2, 6  # legs of tests/bench/visit.txt


def plot(name, title):
    """Frame times as bars (of moving frames; rests are grey), and the level as a line."""
    frames = [json.loads(line) for line in open(f"{work}/{name}/frames.jsonl")]
    end = frames[-1]["at_ms"] + frames[-1]["spent_ms"]
    x = lambda ms: LEFT + (WIDTH - LEFT - 10) * ms / end
    y = lambda share: HEIGHT - 30 - (HEIGHT - TOP - 30) * share
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
           f'font-size="12"><rect width="{WIDTH}" height="{HEIGHT}" fill="white"/><text x="{LEFT}" y="18">{title}</text>']
    for ms in (0, 33.3, 50, 100, 150, 200):
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - 10}" y1="{y(ms / MOST_MS):.1f}" y2="{y(ms / MOST_MS):.1f}" '
                   f'stroke="{"#c00" if ms == 33.3 else "#ddd"}"/><text x="8" y="{y(ms / MOST_MS) + 4:.1f}">{ms:g} ms</text>')
    for second in range(0, int(end / 1000) + 1, 2):
        out.append(f'<text x="{x(second * 1000):.1f}" y="{HEIGHT - 10}">{second} s</text>')
    for f in frames:
        width = max(x(f["at_ms"] + max(f["spent_ms"], 16)) - x(f["at_ms"]) - 0.3, 0.4)
        top = y(min(f["spent_ms"] / MOST_MS, 1))
        out.append(f'<rect x="{x(f["at_ms"]):.1f}" y="{top:.1f}" width="{width:.1f}" '
                   f'height="{y(0) - top:.1f}" fill="{"#ccc" if f["rests"] else "#468"}"/>')
    points = " ".join(f'{x(f["at_ms"]):.1f},{y((f["level"] + 0.7) / 1.7):.1f}' for f in frames)
    out.append(f'<polyline points="{points}" fill="none" stroke="#e80" stroke-width="2"/></svg>')
    open(f"{work}/{name.replace('/', '-')}.svg", "w").write("\n".join(out) + "\n")


def row(size, load):
    found = json.load(open(f"{work}/{size}/{load}/visit.json"))
    plot(f"{size}/{load}", f"{size} million triangles, load: {load}. Bars: time of each frame (grey: at rest). "
         "Line: level, -0.7 to 1. Red: 30 frames a second")
    legs = {leg["leg"]: leg["median_ms"] for leg in found["legs"]}
    return {"million": int(size), "load": load, "orbit_ms": legs[ORBIT], "walk_ms": legs[WALK]} | found


print(json.dumps([row(*visit) for visit in VISITS if os.path.exists(f"{work}/{'/'.join(visit)}/visit.json")], indent=1))
