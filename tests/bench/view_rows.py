"""view_rows.py WORK ROW...: what view.sh drew, as JSON. See docs/figures.md."""
import json
import os
import sys

work, names = sys.argv[1], sys.argv[2:]
MODES = ("lumigraph", "polygons", "corners")


def lines(path):
    return [json.loads(line) for line in open(path)]


def mean(values):
    return sum(values) / len(values)


def kb(views):
    return round(sum(v["bytes_fetched"] for v in views) / 1000 / len(views), 1)


def parts(name, count):
    """Each class of views and where it lies in the path: as many of each, where VIEWS thinned them."""
    sizes = [part.split("=") for part in open(f"{work}/{name}/classes").read().split()]
    whole, at = sum(int(size) for _, size in sizes), 0
    for kind, size in sizes:
        yield kind, slice(at * count // whole, (at + int(size)) * count // whole)
        at += int(size)


def row(name):
    views = {m: lines(f"{work}/{name}/{m}/views.jsonl") for m in MODES}
    scores = {m: lines(f"{work}/{name}/{m}.jsonl") for m in MODES}  # the last line is the whole
    mine, whole = views["lumigraph"], scores["lumigraph"][-1]
    out = {
        "name": name, "views": len(mine), "kb_per_view": kb(mine), "first_view_kb": kb(mine[:1]),
        "psnr_db": whole["psnr_db"], "psnr_worst5_db": whole["psnr_worst5_db"], "ssim": whole["ssim"],
        "image_share": round(mean([v["image_share"] for v in mine]), 3),
        "settled_ms": sorted(v["settled_ms"] for v in mine)[len(mine) // 2],
        "all_settled": all(v["settled"] for m in MODES for v in views[m]),
    }
    for mode in MODES[1:]:
        other = scores[mode][-1]
        out |= {f"{mode}_psnr_db": other["psnr_db"], f"{mode}_psnr_worst5_db": other["psnr_worst5_db"],
                f"{mode}_ssim": other["ssim"], f"{mode}_kb_per_view": kb(views[mode])}
    for kind, part in parts(name, len(mine)):
        if mine[part]:
            out[kind] = {"image_share": round(mean([v["image_share"] for v in mine[part]]), 3)} | {
                f"{m}_psnr_db": round(mean([v["psnr_db"] for v in scores[m][:-1][part]]), 2) for m in MODES}
    return out


def first_picture():
    """Of the 5 M temple: bytes after which the first view has 30 dB; None where it was not drawn, or never had them."""
    try:
        found = json.load(open(f"{work}/first-30db"))["bytes_db30"]
    except FileNotFoundError:
        return None
    return found if found > 0 else None


def other(bench, *keys):
    """A figure of another benchmark, where it was run."""
    try:
        value = json.load(open(f"build/bench/{bench}.json"))
    except FileNotFoundError:
        return None
    for key in keys:
        value = value[key]
    return value


def frame(size, key):
    for of in other("frame", "sizes") or []:
        if of["size"] == size:
            return of[key]
    return None


def visit(million, key):
    """A figure of an undisturbed visit of benchmark visit, where it was played."""
    for of in other("visit") or []:
        if of["million"] == million and of["load"] == "none":
            return of[key]
    return None


print(json.dumps({
    "rows": [row(name) for name in names if os.path.exists(f"{work}/{name}/lumigraph.jsonl")],
    "first_picture_bytes_30db": first_picture(),
    "frame_ratio_720p": frame("1280x720", "lumigraph_per_plain"),
    "frame_ratio_1080p": frame("1920x1080", "lumigraph_per_plain"),
    "frame_ms_1080p_full": frame("1920x1080", "lumigraph_ms"),
    "frame_ms_1080p": {"orbit": visit(1, "orbit_ms"), "walk": visit(1, "walk_ms"), "5 M": visit(5, "frame_median_ms")},
    "frame_p99_over_median": visit(1, "frame_p99_over_median"),
    "moving_psnr_db": visit(1, "moving_psnr_db"),
    "cell_cross_changed_pct": frame("1280x720", "crossing_changed_pct"),
    "work_p99_over_median": other("motion", "work_p99_over_median"),
    "pss_mib": other("footprint", "pss_mb"),
    "first_picture_ms_warm": other("start", "rows", 0, "warm_ms"),
}, indent=1))
