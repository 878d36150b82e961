"""lines.py WORK RELEASE PORT LINE ...: what a visitor waits for over each line, as lines.sh tells. Prints JSON."""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

work, release, port, *lines = sys.argv[1:]
MOST_S, QUIET_S = 150, 1.2  # the kiosk waits so long after the last byte before it calls a view settled
GOALS_DB = (25, 30)


def play(kbit, rtt_ms, loss, swing_s, wait_ms):
    """Runs a kiosk until its view has settled, or for so long; the moments are of both clocks."""
    at = f"{work}/line"
    shutil.rmtree(at, ignore_errors=True)
    os.makedirs(at)
    with open(f"{at}/fetch", "w") as file:
        file.write(f'#!/bin/sh\nexec build/gopura-fetch --verbose --wait-ms {wait_ms} "$@"\n')
    os.chmod(f"{at}/fetch", 0o755)
    began = time.time(), time.monotonic()
    with open(f"{at}/log", "w") as log:
        kiosk = subprocess.Popen(
            ["build/tests/tools/line", "--kbit", kbit, "--rtt-ms", rtt_ms, "--loss", loss, "--swing", swing_s, "--log", f"{at}/bytes",
             "build/gopura-kiosk", "--display", "headless", "--size", "960x540", "--views", f"{work}/view.txt", "--film",
             "--capture", f"{at}/film", "--release", f"https://10.77.0.1:{port}/", "--ca", f"{work}/server/ca.pem",
             "--trust", f"{release}/root/1.json", "--state", f"{at}/state", "--fetch", f"{at}/fetch", "--log", "debug"],
            stderr=log, start_new_session=True)
        try:
            if kiosk.wait(MOST_S + 30):
                sys.exit(f"the kiosk failed: {at}/log")
        except subprocess.TimeoutExpired:  # on a slow line there is always a byte more to come
            os.killpg(kiosk.pid, signal.SIGKILL)
            kiosk.wait()
            os.remove(max((f"{at}/film/{name}" for name in os.listdir(f"{at}/film")), key=os.path.getmtime))  # half written
    return at, began


def judge(at):
    """Pictures in the order of time, with their decibels."""
    names = sorted(os.listdir(f"{at}/film"), key=lambda name: os.path.getmtime(f"{at}/film/{name}"))
    names = [name for name in names if name.endswith(".png")]
    if not names:
        sys.exit(f"there is no picture: {at}/log says why")
    for folder in ("one", "other"):
        os.mkdir(f"{at}/{folder}")
    for i, name in enumerate(names):
        os.symlink(os.path.abspath(f"{work}/truth/view-0000.png"), f"{at}/one/view-{i:04}.png")
        os.symlink(os.path.abspath(f"{at}/film/{name}"), f"{at}/other/view-{i:04}.png")
    rows = subprocess.run(["build/tests/tools/compare_pictures", f"{at}/one", f"{at}/other", ground], stdout=subprocess.PIPE, text=True, check=True)
    db = [row["psnr_db"] for row in map(json.loads, rows.stdout.splitlines()) if "view" in row]
    return [(os.path.getmtime(f"{at}/film/{name}"), value) for name, value in zip(names, db, strict=True)]


def waits(at):
    """Milliseconds from asking for a range to its end, of what the picture lacks, of each byte."""
    found = re.findall(r"(\d+) bytes of a pack, priority (\d+), after (\d+) ms", open(f"{at}/log").read())
    each = sorted((int(ms), int(size)) for size, priority, ms in found if int(priority) >= PICTURE)
    total, sums = sum(size for _, size in each), 0
    out = {}
    for ms, size in each:
        sums += size
        for share in (0.5, 0.9):
            if sums >= share * total:
                out.setdefault(f"wait_ms_{share:.0%}".replace("%", ""), ms)
    return out


inspected = subprocess.run(["build/gopura-content", "inspect", release], stdout=subprocess.PIPE, text=True, check=True).stdout
ground = re.search(r"background +(#\w{6})", inspected)[1]
PICTURE = int(re.search(r"MESSAGE_PRIORITY_PICTURE\s*=\s*(\w+)", open("format/message.h").read())[1], 0)
rows = []
for text in lines:
    kbit, rtt_ms, loss, swing_s, wait_ms = (text.split(":") + ["0", "0", "500"][max(0, len(text.split(":")) - 2):])[:5]
    at, began = play(kbit, rtt_ms, loss, swing_s, wait_ms)
    pictures = judge(at)
    came = [(float(when) - began[1], int(down)) for when, down, _ in map(str.split, open(f"{at}/bytes"))]
    is_settled = os.path.exists(f"{at}/film/views.jsonl") and json.loads(open(f"{at}/film/views.jsonl").readline())["settled"]
    row = {"line": f"{kbit} kbit/s, {rtt_ms} ms" + f", {loss} % lost" * (loss != "0") + f", halves every {swing_s} s" * (swing_s != "0"),
           "wait_ms": int(wait_ms), "first_packet_ms": round(1000 * came[0][0]),
           "first_picture_ms": round(1000 * (pictures[0][0] - began[0]))}
    for goal in GOALS_DB:
        first = next((when - began[0] for when, db in pictures if db >= goal), None)
        row[f"db{goal}_ms"] = first and round(1000 * first)
        row[f"bytes_db{goal}"] = first and max(down for when, down in came if when <= first)
    row["settled_ms"] = round(1000 * (pictures[-1][0] - began[0] - QUIET_S)) if is_settled else None
    row |= {"bytes": came[-1][1], "db": round(pictures[-1][1], 2), "pictures": len(pictures), "load": round(os.getloadavg()[0], 1)} | waits(at)
    if loss == swing_s == "0" and wait_ms == "500":
        virtual = subprocess.run(["build/tests/bench/bench_first", release, f"{work}/view.txt", f"{work}/truth", "--size", "960x540",
                                  "--kbit", kbit, "--rtt", rtt_ms, "--most", str(MOST_S)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True)
        row["virtual"] = {key: None if value == -1 else value for key, value in json.loads(virtual.stdout).items()}
    print(row, file=sys.stderr)
    rows.append(row)
print(json.dumps({"cores": os.cpu_count(), "rows": rows}, indent=1))
