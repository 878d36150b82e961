"""stream.py WORK RELEASE PORT CA: a kiosk over a slow line. Leaves in WORK/between the pictures that were taken while the
streaming mesh was on the panel; fails if there are none, or if it came late."""
import os
import shutil
import signal
import subprocess
import sys
import threading
import time

work, release, port, ca = sys.argv[1:]
MOST_S, EVERY_MS, FIRST_BYTES_MOST = 60, 150, 60000
with open(f"{work}/shots.txt", "w") as shots:
    shots.writelines(f"{i * EVERY_MS} shot-{i:03}\n" for i in range(1, 190))
line = subprocess.Popen([sys.executable, "tests/tools/shape.py", port, "--mbit", "0.2", "--rtt-ms", "60", "--log", f"{work}/line.log"],
                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
url = f"https://localhost:{line.stdout.readline().strip()}/"
kiosk = subprocess.Popen(
    ["build/gopura-kiosk", "--display", "headless", "--size", "480x270", "--idle-s", "3600", "--release", url, "--ca", ca,
     "--trust", f"{release}/root/1.json", "--state", f"{work}/state", "--shots", f"{work}/shots.txt", "--capture", f"{work}/shots",
     "--log", "debug"], stderr=subprocess.PIPE, text=True)
said = {}


def read():
    with open(f"{work}/kiosk.log", "w") as log:
        for text in kiosk.stderr:
            log.write(text)
            log.flush()
            for words in ("first picture after", "patches have taken the place of the streaming mesh"):
                if words in text:
                    said.setdefault(words.split()[0], (time.time(), time.monotonic()))


reader = threading.Thread(target=read)
reader.start()
began = time.monotonic()
while "patches" not in said and time.monotonic() - began < MOST_S and kiosk.poll() is None:
    time.sleep(0.05)
kiosk.terminate()
kiosk.wait()
reader.join()
line.send_signal(signal.SIGINT)
line.wait()
if len(said) < 2:
    sys.exit(f"within {MOST_S} s there was only {list(said)}")
(first, first_at), (patches, _) = said["first"], said["patches"]
came = max((int(down) for at, down, _ in map(str.split, open(f"{work}/line.log")) if float(at) <= first_at), default=0)
os.mkdir(f"{work}/between")
for name in sorted(os.listdir(f"{work}/shots")):
    # A picture of a moment after the line was logged, written whole before the other one was.
    if first + 0.2 < os.path.getmtime(f"{work}/shots/{name}") < patches:
        shutil.copy(f"{work}/shots/{name}", f"{work}/between/{name}")
count = len(os.listdir(f"{work}/between"))
print(f"on the panel for {patches - first:.1f} s after {came / 1000:.0f} KB, {count} pictures of it")
if not count or came > FIRST_BYTES_MOST:
    sys.exit("the streaming mesh came late, or was on the panel for no picture")
