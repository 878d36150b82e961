"""quality_rows.py WORK SCAN...: what quality_pictures.sh built and drew, as JSON: for each scan and rule the releases, by
bytes, and how many bytes a rule saves against uniform quality with the same SSIM, and with the same PSNR."""
import json
import math
import os
import sys

work, scans = sys.argv[1], sys.argv[2:]


def release(folder):
    whole = [json.loads(line) for line in open(f"{folder}/pictures.jsonl")][-1]
    return {"bytes": int(open(f"{folder}/bytes").read()), "psnr_db": whole["psnr_db"], "ssim": whole["ssim"]}


def bytes_for(uniform, key, value):
    """Bytes of uniform quality with that value, between two releases; None outside of them."""
    for less, more in zip(uniform, uniform[1:]):
        if less[key] <= value <= more[key]:
            share = (value - less[key]) / (more[key] - less[key])
            return math.exp(math.log(less["bytes"]) * (1 - share) + math.log(more["bytes"]) * share)
    return None


def saved(uniform, mine):
    out = {}
    for key in ("ssim", "psnr_db"):
        alike = bytes_for(uniform, key, mine[key])
        out[f"saved_at_{key}"] = round(1 - mine["bytes"] / alike, 3) if alike else None
    return out


def row(scan):
    rules = {}
    for name in sorted(os.listdir(f"{work}/{scan}/runs"), key=lambda name: int(name.split("-")[1])):
        rules.setdefault(name.split("-")[0], []).append(release(f"{work}/{scan}/runs/{name}"))
    for rule, releases in rules.items():
        for one in releases:
            if rule != "uniform":
                one.update(saved(rules["uniform"], one))
    return {"tiles": json.load(open(f"{work}/{scan}/tiles.json")), **rules}


print(json.dumps({scan: row(scan) for scan in scans}, indent=1))
