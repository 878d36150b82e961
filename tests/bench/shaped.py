"""shaped.py WORK RELEASE PORT CA: a visit of kiosk and fetcher over a line, as shaped.sh tells. Prints JSON."""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

work, release, port, ca = sys.argv[1:]
MBIT, RTT_MS, FPS = 10, 40, 30  # the stage asks for 64 KB ahead a frame: fewer frames would not fill the line
SETTLE_MOST_S = 90

# What the fingers do: from, to (milliseconds), and of each finger from where to where, of 1280 x 720.
FINGERS = (
    (4000, 7000, ((760, 420, 500, 400),)),  # an orbit
    (8500, 10500, ((600, 330, 420, 330), (680, 330, 860, 330))),  # nearer
    (12000, 14500, ((560, 300, 760, 310), (720, 300, 920, 310))),  # along
    (15500, 15800, ((400, 400, 760, 400),)),  # a fling
)
STEP_MS = 25


def write_touches(path):
    lines = []
    for start, end, fingers in FINGERS:
        steps = (end - start) // STEP_MS
        for finger, (x0, y0, x1, y1) in enumerate(fingers):
            lines.append((start, 0, f"down {finger} {x0} {y0}"))
            for i in range(1, steps + 1):
                x, y = x0 + (x1 - x0) * i / steps, y0 + (y1 - y0) * i / steps
                lines.append((start + i * STEP_MS, 1, f"move {finger} {x:.0f} {y:.0f}"))
            # Fingers that rest before they leave fling nothing.
            lines.append((end + (120 if end - start > 1000 else 5), 2, f"up {finger} {x1} {y1}"))
    with open(path, "w") as file:
        file.write("size 1280 720\n" + "".join(f"{ms} {what}\n" for ms, _, what in sorted(lines)))
    return max(lines)[0] / 1000


class Kiosk:
    """Runs one, and keeps its log with the times at which its lines came."""

    def __init__(self, url):
        shutil.rmtree(f"{work}/state", ignore_errors=True)
        self.began = time.monotonic()
        self.lines = []
        self.process = subprocess.Popen(
            ["build/gopura-kiosk", "--display", "headless", "--size", "1280x720", "--idle-s", "3600", "--release", url, "--ca", ca,
             "--trust", f"{release}/root/1.json", "--state", f"{work}/state", "--touch-replay", f"{work}/visit.touch",
             "--log", "debug"], stderr=subprocess.PIPE, text=True)
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stderr:
            self.lines.append((time.monotonic() - self.began, line.rstrip()))

    def said(self, words):
        return [at for at, line in self.lines if words in line]

    def settle(self, after_s):
        """When the picture settled after the visit, and stayed so for three seconds."""
        while time.monotonic() - self.began < after_s + SETTLE_MOST_S:
            time.sleep(0.2)
            settled, moved = self.said("the picture has settled"), self.said("looks at")
            now = time.monotonic() - self.began
            if settled and settled[-1] > max(after_s, moved[-1]) and now - settled[-1] > 3:
                return settled[-1]
        sys.exit("the picture does not settle")

    def end(self):
        self.process.terminate()
        status = self.process.wait()
        with open(f"{work}/kiosk.log", "w") as file:
            file.writelines(f"{at:.3f} {line}\n" for at, line in self.lines)
        return status


def eye_path(kiosk, until_s, path):
    """The way that the eye went, for bench_motion: from the first picture on, a line for each tenth of a second."""
    began = kiosk.said("first picture after")[0]
    places = [(at, re.findall(r"-?\d+\.\d+", line)) for at, line in kiosk.lines if "looks at" in line]
    with open(path, "w") as file:
        print(0, *places[0][1], "start", file=file)
        at = began
        for then, place in places[1:]:
            if then - at > 0.5:  # it rested, then went on within the tenth of a second before it said so
                print(f"{then - at - 0.1:.3f} rest", file=file)
                at = then - 0.1
            print(f"{then - at:.3f}", *place, "on", file=file)
            at = then
        print(f"{until_s - at:.3f} rest", file=file)


def came(line_log, began):
    return [(float(at) - began, int(down)) for at, down, _ in map(str.split, open(line_log))]


def by(samples, at):
    return max((down for when, down in samples if when <= at), default=0)


last_touch_s = write_touches(f"{work}/visit.touch")
line = subprocess.Popen([sys.executable, "tests/tools/shape.py", port, "--mbit", str(MBIT), "--rtt-ms", str(RTT_MS),
                         "--log", f"{work}/line.log"], stdout=subprocess.PIPE, text=True)
try:
    kiosk = Kiosk(f"https://localhost:{line.stdout.readline().strip()}/")
    settled_s = kiosk.settle(last_touch_s)
    status = kiosk.end()
finally:
    line.send_signal(signal.SIGINT)
    line.wait()
samples, stopped_s = came(f"{work}/line.log", kiosk.began), kiosk.said("looks at")[-1]
first_rest_s = next((at for at in kiosk.said("the picture has settled")), settled_s)
eye_path(kiosk, settled_s, f"{work}/path.txt")
subprocess.run(["build/tests/bench/bench_motion", release, f"{work}/path.txt", f"{work}/virtual", "--fault", "none",
                "--link", str(MBIT), "--latency", str(RTT_MS), "--fps", str(FPS)], check=True)
virtual = json.load(open(f"{work}/virtual/motion.json"))
bad = [text for _, text in kiosk.lines if text.startswith(("error", "warn"))]
total = by(samples, settled_s)
shutil.rmtree(f"{work}/state")
print(json.dumps({
    "mbit": MBIT, "rtt_ms": RTT_MS, "load": round(os.getloadavg()[0], 1), "cores": os.cpu_count(),
    "received_kb": round(total / 1000), "seconds": round(settled_s, 1), "kb_per_s": round(total / 1000 / settled_s),
    "line_most_kb_per_s": round(max(by(samples, at + 1) - by(samples, at) for at in range(int(settled_s))) / 1000),
    "first_picture_ms": round(kiosk.said("first picture after")[0] * 1000),
    "first_settled_ms": round(first_rest_s * 1000),
    "kb_when_eye_stopped": round(by(samples, stopped_s) / 1000),
    "settled_after_stop_ms": round((settled_s - stopped_s) * 1000),
    "virtual_clock_kb": virtual["kb"], "received_over_virtual": round(total / 1000 / virtual["kb"], 3),
    "complaints": bad, "exit_status": status,
}, indent=1))
