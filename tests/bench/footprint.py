"""footprint.py WORK: measures gopura-kiosk and its fetcher and prints JSON. See docs/figures.md.

footprint.py WORK RELEASE BOARD: of that release, with that board's profile, only what both take at rest.
"""
import atexit
import glob
import json
import os
import re
import subprocess
import sys
import time

WORK = sys.argv[1]
REST_ONLY = len(sys.argv) > 2
RELEASE, BOARD = sys.argv[2:] if REST_ONLY else ("build/demo/release", f"{WORK}/board.ini")
MESA = re.compile(r"/(libgallium|libLLVM|libEGL|libGLES|libGL|libglapi|libgbm|swrast_dri|kms_swrast|dri/|libdrm|"
                  r"libz3|libstdc\+\+|libedit|libelf|libsensors|libvulkan|libX|libxcb|libxshm|libwayland)")
TICKS = os.sysconf("SC_CLK_TCK")


def kiosk(*more):
    """Without Mesa's cache of compiled shaders, whose bytes on the disk are not ours."""
    process = subprocess.Popen(
        ["build/gopura-kiosk", "--display", "headless", "--size", "1920x1080", "--release", RELEASE,
         "--trust", f"{RELEASE}/root/1.json", "--state", f"{WORK}/state", "--board", BOARD, "--idle-s", "3600", *more],
        stderr=open(f"{WORK}/kiosk.log", "a"), env=dict(os.environ, MESA_SHADER_CACHE_DISABLE="true"))
    atexit.register(process.kill)  # does nothing once it was waited for
    return process


def fetcher_of(pid):
    for _ in range(100):
        children = open(f"/proc/{pid}/task/{pid}/children").read().split()
        if children:
            return int(children[0])
        time.sleep(0.05)
    sys.exit("the kiosk has no fetcher")


def cpu_ticks(pid):
    fields = open(f"/proc/{pid}/stat").read().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def rest(pids):
    """Until both have done next to nothing for three seconds."""
    quiet, until = 0, time.monotonic() + 400
    while quiet < 3:
        before = sum(map(cpu_ticks, pids))
        time.sleep(1)
        quiet = quiet + 1 if sum(map(cpu_ticks, pids)) - before <= 1 else 0
        if time.monotonic() > until:
            sys.exit("the kiosk does not come to rest")


def memory_kb(pid):
    """PSS: all, of Mesa's files, of our program and other libraries, and of no file."""
    sums, where = {"all": 0, "mesa_files": 0, "other_files": 0, "anonymous": 0}, "anonymous"
    for line in open(f"/proc/{pid}/smaps"):
        head = re.match(r"[0-9a-f]+-[0-9a-f]+ \S+ \S+ \S+ \S+\s*(.*)", line)
        if head:
            name = head[1]
            where = "mesa_files" if MESA.search(name) else "other_files" if name.startswith("/") else "anonymous"
            if name.startswith(("/memfd:", "/dev/zero", "/SYSV")):
                where = "anonymous"
        elif line.startswith("Pss:"):
            kb = int(line.split()[1])
            sums["all"] += kb
            sums[where] += kb
    return sums


def switches(pid):
    return sum(int(re.search(r"^voluntary_ctxt_switches:\s*(\d+)", open(path).read(), re.M)[1])
               for path in glob.glob(f"/proc/{pid}/task/*/status"))


def written(pid):
    return int(re.search(r"^write_bytes: (\d+)", open(f"/proc/{pid}/io").read(), re.M)[1])


def libraries(program):
    said = subprocess.run(["ldd", program], check=True, text=True, capture_output=True).stdout
    return {os.path.realpath(path) for path in re.findall(r"(/\S+) \(0x", said)}


def megabytes(files):
    return round(sum(os.path.getsize(f) for f in files) / 1e6, 1)


def mapped(pid):
    names = {line.split(maxsplit=5)[5].strip() for line in open(f"/proc/{pid}/maps") if len(line.split()) > 5}
    return {os.path.realpath(n) for n in names if re.search(r"\.so(\.|$)", n) and os.path.exists(n)}


def at_rest():
    process = kiosk()
    pids = (process.pid, fetcher_of(process.pid))
    time.sleep(5)
    rest(pids)
    before = [switches(pid) for pid in pids]
    time.sleep(10)
    wakes = [(switches(pid) - b) / 10 for pid, b in zip(pids, before)]
    rows = [dict(memory_kb(pid), wakeups_per_s=w) for pid, w in zip(pids, wakes)]
    loaded = mapped(process.pid)
    process.terminate()
    process.wait()
    return rows, loaded


def visit():
    """Bytes both gave to the disk in a replayed visit, and its seconds. The kernel adds what a process
    wrote to its parent's account when it is waited for: the fetcher's to the kiosk's, that to ours."""
    before, began = written("self"), time.monotonic()
    kiosk("--touch-replay", "demo/visit.touch", "--quit-after-replay").wait()
    return written("self") - before, time.monotonic() - began


def roam(minutes):
    """PSS of both, MB: after one visit, after so many minutes of them in one process, and at rest then."""
    lines = [line for line in open("demo/visit.touch") if line[0].isdigit()]
    visit_ms = 30000
    with open(f"{WORK}/roam.touch", "w") as out:
        for k in range(max(1, minutes * 60000 // visit_ms)):
            for line in lines:
                ms, rest_of_it = line.split(maxsplit=1)
                out.write(f"{int(ms) + k * visit_ms} {rest_of_it}")
    process = kiosk("--touch-replay", f"{WORK}/roam.touch")
    pids = (process.pid, fetcher_of(process.pid))
    sums = []
    for seconds in (visit_ms / 1000 + 5, (minutes * 60 - visit_ms / 1000)):
        time.sleep(seconds)
        sums.append(round(sum(memory_kb(pid)["all"] for pid in pids) / 1024, 1))
    rest(pids)
    sums.append(round(sum(memory_kb(pid)["all"] for pid in pids) / 1024, 1))
    process.terminate()
    process.wait()
    return sums


if REST_ONLY:
    kiosk_rest, fetch_rest = at_rest()[0]
    print(json.dumps({"kiosk_kb": kiosk_rest, "fetch_kb": fetch_rest}))
    sys.exit()

with open(BOARD, "w") as board:
    board.write("[render]\ntexture_mib = 32\n")
first, _ = visit()
for _ in range(3):  # the same visit meets the same tiles not quite exactly: timing differs
    later, later_s = visit()
(kiosk_rest, fetch_rest), loaded = at_rest()
after_one, after_all, resting = roam(int(os.environ.get("MINUTES", "4")))
closure = libraries("build/gopura-kiosk") | libraries("build/gopura-fetch")
print(json.dumps({
    "size": "1920x1080",
    "kiosk_kb": kiosk_rest, "fetch_kb": fetch_rest,
    "pss_mb": round((kiosk_rest["all"] + fetch_rest["all"]) / 1024, 1),
    "pss_without_mesa_files_mb": round(
        (kiosk_rest["all"] + fetch_rest["all"] - kiosk_rest["mesa_files"] - fetch_rest["mesa_files"]) / 1024, 1),
    "roaming_pss_mb": {"after_one_visit": after_one, "after_all": after_all, "at_rest_after": resting},
    "wakeups_per_s": round(kiosk_rest["wakeups_per_s"] + fetch_rest["wakeups_per_s"], 2),
    "stripped_kb": {p: round(os.path.getsize(f"{WORK}/gopura-{p}") / 1000) for p in ("kiosk", "fetch", "content")},
    "libraries": len(closure), "libraries_mb": megabytes(closure),
    "libraries_and_drivers_mb": megabytes(closure | loaded),
    "drivers_mb": megabytes(loaded - closure),
    "written_first_visit_kb": round(first / 1000), "written_fourth_visit_kb": round(later / 1000),
    "written_per_visitor_hour_kb": round(later / 1000 * 3600 / later_s),
}, indent=1))
