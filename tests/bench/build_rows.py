#!/usr/bin/env python3
"""build_rows.py FOLDER MILLIONS...: from a scan file to the hierarchy, a row of figures for each size.

The demo temple with colours per vertex; its PLY is made first and not counted. The peak is the largest sum of
the proportional set sizes (Pss) of the program's processes, read ten times a second.
Prints JSON: triangles, import_s, hierarchy_s, cpu_s (both steps, all processes), mtri_per_s, peak_mib, and what
views of tests/bench/path.txt need of the whole (bench_loaded). What is in FOLDER goes afterwards.
"""
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import time

CONTENT = "build/gopura-content"


def family(pid):
    """The process and its descendants."""
    found, at = [pid], 0
    while at < len(found):
        try:
            with open(f"/proc/{found[at]}/task/{found[at]}/children", encoding="ascii") as file:
                found += [int(child) for child in file.read().split()]
        except OSError:
            pass
        at += 1
    return found


def pss_kib(pid):
    try:
        with open(f"/proc/{pid}/smaps_rollup", encoding="ascii") as file:
            return int(re.search(r"^Pss:\s+(\d+) kB", file.read(), re.M)[1])
    except (OSError, TypeError):
        return 0


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def row(folder, millions):
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    scan = f"{folder}/scan.ply"
    subprocess.run([CONTENT, "temple", "--triangles", str(int(millions * 1e6)), "--out", scan], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(f"{folder}/temple.ini", "w", encoding="ascii") as file:
        file.write("[model]\nscans = scan.ply\n")
    began, before, peak = time.monotonic(), cpu_s(), 0
    with open(f"{folder}/said", "w+", encoding="utf-8") as said:
        process = subprocess.Popen([CONTENT, "hierarchy", folder], stdout=said, stderr=subprocess.DEVNULL)
        while process.poll() is None:
            peak = max(peak, sum(pss_kib(pid) for pid in family(process.pid)))
            time.sleep(0.1)
        all_s, used_s = time.monotonic() - began, cpu_s() - before
        said.seek(0)
        text = said.read()
    if process.returncode != 0:
        sys.exit(f"the hierarchy of {millions} million triangles failed")
    hierarchy_s = float(re.search(r"a vertex; ([0-9.]+) s", text)[1])
    triangles = int(re.search(r"level  0: +(\d+) triangles", text)[1])
    loaded = json.loads(subprocess.run(["build/tests/bench/bench_loaded", f"{folder}/.work/master",
                                        "tests/bench/path.txt"], check=True, stdout=subprocess.PIPE).stdout)
    shutil.rmtree(folder)
    return {"triangles": triangles, "import_s": round(all_s - hierarchy_s, 1), "hierarchy_s": hierarchy_s,
            "cpu_s": round(used_s, 1), "load": round(os.getloadavg()[0], 1),
            "mtri_per_s": round(triangles / all_s / 1e6, 3), "peak_mib": round(peak / 1024), **loaded}


print(json.dumps([row(sys.argv[1], float(millions)) for millions in sys.argv[2:]]))
