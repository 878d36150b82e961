#!/bin/bash
# From exec to the first picture of the demo temple: with nginx and an empty cache, and from the
# cache alone with no server. Median of five each. build/bench/start.json.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib-server.sh
work=build/bench/start
rm -rf "$work"
mkdir -p "$work"
trap stop_server EXIT
demo/prepare.sh >/dev/null
start_server build/demo/release "$work/server"
python3 - "$work" "$server_url" "$server_ca" >build/bench/start.json.new <<'P'
import json
import re
import shutil
import subprocess
import sys
import time

work, url, ca = sys.argv[1:]


def start(size, release):
    began = time.monotonic()
    kiosk = subprocess.Popen(
        ["build/gopura-kiosk", "--display", "headless", "--size", size, "--release", release, "--ca", ca,
         "--trust", "build/demo/release/root/1.json", "--state", f"{work}/state"],
        stderr=subprocess.PIPE, text=True)
    for line in kiosk.stderr:
        if re.search(r"first picture after \d+ ms", line):
            break
    else:
        sys.exit("the kiosk ended before its first picture")
    took = (time.monotonic() - began) * 1000
    time.sleep(4 if release == url else 0)  # the cache gets what the first view needs
    kiosk.terminate()
    kiosk.stderr.read()
    kiosk.wait()
    return took


rows = []
for size in ("1280x720", "1920x1080"):
    cold, warm = [], []
    for _ in range(5):
        shutil.rmtree(f"{work}/state", ignore_errors=True)
        cold.append(start(size, url))
        warm.append(start(size, "https://localhost:9/"))
    middle = lambda values: round(sorted(values)[len(values) // 2])
    rows.append({"size": size, "cold_ms": middle(cold), "cold_most_ms": round(max(cold)),
                 "warm_ms": middle(warm), "warm_most_ms": round(max(warm))})
print(json.dumps({"rows": rows}, indent=1))
P
mv build/bench/start.json.new build/bench/start.json
