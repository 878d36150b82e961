"""growth_rows.py WORK SIZE...: what growth.sh measured, as JSON; sizes that were not are left out. See docs/figures.md."""
import json
import os
import re
import sys

work, sizes = sys.argv[1], sys.argv[2:]
FPS = 30  # of bench_motion's visit


def lines(path):
    return [json.loads(line) for line in open(path)]


def mean(values):
    return sum(values) / len(values)


def folder_bytes(path):
    return sum(os.path.getsize(os.path.join(at, name)) for at, _, names in os.walk(path) for name in names)


def visit(frames):
    """What came in the visit, and in each second of it after the first rest, which begins with nothing."""
    came = [0] + [frame["bytes"] for frame in frames]
    start = next(i for i, frame in enumerate(frames) if not frame["rests"])
    later = [came[min(i + FPS, len(frames))] - came[i] for i in range(start, len(frames), FPS)]
    return {
        "visit_kb": round(came[-1] / 1000), "visit_kb_per_s": round(came[-1] / 1000 * FPS / len(frames)),
        "visit_first_kb": round(came[start] / 1000),
        "visit_later_kb_per_s": round((came[-1] - came[start]) / 1000 * FPS / (len(frames) - start)),
        "visit_later_most_kb_per_s": round(max(later) / 1000),
    }


def row(size):
    at = f"{work}/{size}"
    said = open(f"{at}/inspect").read()
    published, source = map(int, re.search(r"triangles +(\d+) published of (\d+)", said).groups())
    views, rest = lines(f"{at}/views/views.jsonl"), json.load(open(f"{at}/rest.json"))
    out = {
        "source_triangles": source, "published_triangles": published, "published_share": round(published / source, 4),
        "release_mb": round(folder_bytes(f"{at}/release") / 1e6, 1),
        "views": len(views), "all_settled": all(view["settled"] for view in views),
        "kb_per_view": round(mean([view["bytes"] for view in views]) / 1000, 1),
        "first_view_kb": round(views[0]["bytes"] / 1000),
        "psnr_db": round(mean([view["psnr"] for view in views]), 2),
        "psnr_worst_db": min(view["psnr"] for view in views),
        "triangles_drawn": round(mean([view["triangles"] for view in views])),
        "triangles_drawn_most": max(view["triangles"] for view in views),
        "settled_ms": sorted(view["settled_ms"] for view in views)[len(views) // 2],
    }
    for frame in json.load(open(f"{at}/frame.json"))["sizes"]:
        height = frame["size"].split("x")[1]
        out |= {f"{key}_{height}p": frame[key] for key in (
            "plain_ms", "lumigraph_ms", "lumigraph_per_plain", "plain_cpu_ms", "lumigraph_cpu_ms", "triangles")}
    out |= {"pss_kiosk_mb": round(rest["kiosk_kb"]["all"] / 1024, 1),
            "pss_fetch_mb": round(rest["fetch_kb"]["all"] / 1024, 1)}
    return out | visit(lines(f"{at}/visit/frames.jsonl"))


def growth(row, before):
    """A row over another: 1 is flat."""
    keys = ("release_mb", "kb_per_view", "first_view_kb", "triangles_drawn", "plain_ms_720p", "lumigraph_ms_720p",
            "plain_cpu_ms_720p", "lumigraph_cpu_ms_720p", "plain_ms_1080p", "lumigraph_ms_1080p", "plain_cpu_ms_1080p",
            "lumigraph_cpu_ms_1080p", "pss_kiosk_mb", "visit_kb_per_s", "visit_later_kb_per_s")
    return {key: round(row[key] / before[key], 2) for key in keys}


def measured(size):
    return all(os.path.exists(f"{work}/{size}/{name}") for name in ("rest.json", "frame.json", "views/views.jsonl", "visit/frames.jsonl"))


rows = {size: row(size) for size in sizes if measured(size)}
print(json.dumps({"rows": rows, "over_6": {size: growth(rows[size], rows["6"]) for size in rows if "6" in rows}}, indent=1))
