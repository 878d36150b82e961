#!/usr/bin/env python3
"""A year of a museum's terminal: gopura-kiosk, gopura-fetch and gopura-health live through it on a clock that is set
forward whenever nothing happens (tests/tools/virtual_clock.c), with nginx, visitors, nights, new releases and faults.

    museum_year.py WORK --days N [--start YYYY-MM-DD] [--visits N]     lives through it: WORK/year.csv
    museum_year.py WORK --hours N                                     hours of real time, without that clock: WORK/hours.csv
    museum_year.py check FILE.csv                                     what must stay flat stays flat
    museum_year.py plot FILE.csv FILE.svg

WORK has content, keys and release (tests/e2e/year.sh makes them). disk, a folder of WORK, is the terminal's card.
docs/life.md says what is measured and what the bounds are.
"""
import argparse, csv, datetime, json, mmap, os, pathlib, signal, socket, statistics, struct, subprocess, sys, time
import urllib.request

PROGRAMS = ("kiosk", "fetch", "health")
SECOND, HOUR, DAY = 10**9, 3600, 86400
OPENS, CLOSES = 9, 17
MINUTES, POLL_MINUTES = 5, 10  # of real hours: of a row, and between looks for new releases
SHARED_BYTES = 8 * (4 + 3 * 4)

# ---- what is to stay flat, and how it is judged

CARD_BYTES, CYCLES, AMPLIFICATION = 8e9, 1000, 4  # a card of 8 GB; erase cycles of cheap flash; what the card adds
MOST_WRITTEN = 50e6  # bytes a day
MOST_GROWTH_KB = 4096  # of the memory of a program in a third of a year
SAMPLE_GROWTH_KB = 16384  # in a few days, in which all is done for the first time
TEXTURES_KB = 200 * 1024  # of two releases, which the software renderer may keep for days after they have gone
MOST_STATE = 5e6  # SQLite writes the log of state.db back at 1000 pages, 4 MB
MORE_FDS = 2  # the connection to the server may be open or not


def series(rows, name):
    return [float(row[name]) for row in rows]


def check(path):
    rows = list(csv.DictReader(open(path)))
    warm = rows[max(1, len(rows) // 10) :]  # the first days fill caches
    most_growth_kb = MOST_GROWTH_KB if len(rows) >= 60 else SAMPLE_GROWTH_KB
    bad = []

    def judge(what, value, most, unit):
        good = value <= most
        print(f"  {'ok  ' if good else 'BAD '} {what}: {value:.2f} {unit}, at most {most:.2f}")
        if not good:
            bad.append(what)

    for program in PROGRAMS:
        for what in ("heap", "memory"):
            values = series(warm, f"{program}_{what}_kb")
            third = max(1, len(values) // 3)
            most = max(values[:third]) + most_growth_kb + (TEXTURES_KB if (program, what) == ("kiosk", "memory") else 0)
            judge(f"{program}: {what}, least of the last third", min(values[-third:]) / 1024, most / 1024, "MB")
        for what in ("fds", "threads"):
            values = series(warm, f"{program}_{what}")
            most = statistics.median(values[:third]) + (MORE_FDS if what == "fds" else 0)
            judge(f"{program}: {what} in the last third", statistics.median(values[-third:]), most, "")
        judge(f"{program}: starts", max(series(rows, f"{program}_starts")), 1, "")
    judge("cache.db", max(series(rows, "cache_bytes")) / 1e6, max(series(rows, "cache_budget_bytes")) / 1e6, "MB")
    judge("other files of the state", max(series(rows, "state_bytes")) / 1e6, MOST_STATE / 1e6, "MB")
    is_year = "day" in rows[0]
    written = [size * (1 if is_year else 24 * 60 / MINUTES) for size in series(warm, "written_bytes")]
    judge("written in a day, mean", statistics.fmean(written) / 1e6, MOST_WRITTEN / 1e6, "MB")
    if is_year:
        judge("written in a day, most", max(written) / 1e6, MOST_WRITTEN / 1e6, "MB")
    last = rows[-1]
    # one that was published on the last day may be on its way
    judge("releases not followed", float(rows[-2]["published"]) - float(last["shown"]), 0, "")
    judge("offline at the end", 1 - float(last["online"]), 0, "")
    wear = CARD_BYTES * CYCLES / (statistics.fmean(written) * AMPLIFICATION * 365)
    print(f"  a card of 8 GB lasts {wear:.0f} years at {CYCLES} cycles, if it writes {AMPLIFICATION} times what it is told")
    return bad


# ---- the picture

PANELS = (
    ("memory of its own, MB", [(f"{p}_memory_kb", p, 1 / 1024) for p in PROGRAMS]),
    ("open files", [(f"{p}_fds", p, 1) for p in PROGRAMS]),
    ("threads", [(f"{p}_threads", p, 1) for p in PROGRAMS]),
    ("cache.db and state, MB", [("cache_bytes", "cache.db", 1e-6), ("state_bytes", "state", 1e-6)]),
    ("written since the last, MB", [("written_bytes", "", 1e-6)]),
)
COLOURS, WIDTH, HIGH, LEFT = ("#246", "#c60", "#3a3"), 960, 130, 60


def plot(path, to):
    rows = list(csv.DictReader(open(path)))
    n, total = len(rows), HIGH * len(PANELS) + 90
    x = lambda day: LEFT + (WIDTH - LEFT - 90) * day / max(1, n - 1)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {total}" font-family="sans-serif" '
           f'font-size="11"><rect width="{WIDTH}" height="{total}" fill="white"/>']
    for day, row in enumerate(rows):
        if row["event"]:
            out.append(f'<line x1="{x(day):.1f}" x2="{x(day):.1f}" y1="60" y2="{total - 20}" stroke="#ddd"/>'
                       f'<text x="{x(day):.1f}" y="58" transform="rotate(-25 {x(day):.1f} 58)" fill="#777">'
                       f'{row["event"].split(";")[0]}</text>')
        date = row["date"]
        if date.endswith(("-01", ":00")) or n < 40 and "day" in row:
            shown = date if "minute" in row else date[2 : 7 if n >= 40 else 10]
            out.append(f'<text x="{x(day):.1f}" y="{total - 6}" text-anchor="middle">{shown}</text>')
    for i, (title, lines) in enumerate(PANELS):
        top, bottom = 70 + i * HIGH + 18, 70 + (i + 1) * HIGH - 8
        most = max(max(series(rows, name)) * scale for name, _, scale in lines) or 1
        y = lambda value: bottom - (bottom - top) * value / (most * 1.05)
        out.append(f'<text x="{LEFT}" y="{top - 5}" font-weight="bold">{title}</text>'
                   f'<line x1="{LEFT}" x2="{WIDTH - 90}" y1="{bottom}" y2="{bottom}" stroke="#999"/>')
        for value in (0, most / 2, most):
            out.append(f'<text x="{LEFT - 6}" y="{y(value) + 4:.1f}" text-anchor="end">{value:.3g}</text>')
        for (name, label, scale), colour in zip(lines, COLOURS):
            values = [value * scale for value in series(rows, name)]
            points = " ".join(f"{x(day):.1f},{y(value):.1f}" for day, value in enumerate(values))
            out.append(f'<polyline points="{points}" fill="none" stroke="{colour}"/>'
                       f'<text x="{WIDTH - 84}" y="{y(values[-1]) + 4:.1f}" fill="{colour}">{label}</text>')
    pathlib.Path(to).write_text("\n".join(out) + "\n</svg>\n")


# ---- the clock that all programs share

class Clock:
    """Virtual times are seconds since the year began; the wall clock shows them from its first day on."""

    def __init__(self, path, start_s):
        path.write_bytes(bytes(SHARED_BYTES))
        file = open(path, "r+b")
        self.map = mmap.mmap(file.fileno(), SHARED_BYTES)
        self.wrong_s, self.moves, self.trims, self.ahead_ns, self.start_s = 0, 0, 0, 0, start_s
        self.began_ns, self.wall_ahead_ns = time.monotonic_ns(), int((start_s - time.time()) * SECOND)
        self.put()

    def put(self):
        self.moves += 1
        wall = self.wall_ahead_ns + self.ahead_ns + self.wrong_s * SECOND
        self.map[:32] = struct.pack("<qqQQ", self.ahead_ns, wall, self.moves, self.trims)

    def now_s(self):
        return (time.monotonic_ns() - self.began_ns + self.ahead_ns) / SECOND

    def date(self):
        return datetime.datetime.fromtimestamp(self.start_s + self.now_s(), datetime.timezone.utc)

    def go_to(self, at_s, step_s, pause_s):
        """Moves on in steps, each followed by a pause of real time in which the programs do what is due."""
        while (left := at_s - self.now_s()) > 0:
            self.ahead_ns += int(min(step_s, left) * SECOND)
            self.put()
            time.sleep(pause_s)

    def set_wrong(self, wrong_s):
        self.wrong_s = wrong_s
        self.put()

    def trim(self):
        """Has the programs give back what malloc has free, so that what is measured is what they hold."""
        self.trims += 1
        self.put()
        time.sleep(0.1)

    def written(self, _):
        """Bytes, bytes of whole pages of 4 KiB, syncs: of all programs of the terminal."""
        numbers = struct.unpack("<16Q", self.map[:])[4:13]
        return {"told_bytes": sum(numbers[0::3]), "written_bytes": 4096 * sum(numbers[1::3]), "syncs": sum(numbers[2::3])}


class RealClock:
    """The same for hours of real time, without moves; what the programs write, the kernel counts."""

    def __init__(self):
        self.began_s = time.monotonic()

    def now_s(self):
        return time.monotonic() - self.began_s

    def go_to(self, at_s, *_):
        time.sleep(max(0, at_s - self.now_s()))

    def trim(self):
        pass

    def written(self, pids):
        counts = [dict(line.split(": ") for line in pathlib.Path(f"/proc/{pid}/io").read_text().splitlines()) for pid in pids]
        return {"written_bytes": sum(int(count["write_bytes"]) for count in counts)}


# ---- the museum

class Museum:
    name, hours, poll_s = "year.csv", f"Mo-Su {OPENS:02}:00-{CLOSES:02}:00", HOUR

    def __init__(self, work, start, days, visits):
        self.work, self.begins, self.days, self.visits = work, start, days, visits
        self.disk, self.children, self.server, self.published, self.row = work / "disk", {}, None, 0, {}
        self.set_clock()

    def set_clock(self):
        start, work = self.begins, self.work
        self.clock = Clock(work / "clock", datetime.datetime.combine(start, datetime.time(), datetime.timezone.utc).timestamp())
        here = pathlib.Path("build/tests/tools/virtual_clock.so").resolve()
        self.env = dict(os.environ, LD_PRELOAD=str(here), GOPURA_CLOCK=str((work / "clock").resolve()), TZ="UTC")

    def virtual(self, *command, **more):
        """Runs a command on the virtual clock to its end."""
        done = subprocess.run(command, env=self.env, capture_output=True, text=True, **more)
        if done.returncode != 0:
            sys.exit(f"FAILED: {' '.join(map(str, command))}\n{done.stdout}{done.stderr}")

    # -- the server

    def start_server(self):
        (self.work / "server/url").unlink(missing_ok=True)
        self.server = subprocess.Popen(["server/serve.sh", str(self.work / "release"), str(self.port()), str(self.work / "server")],
                                       stdout=open(self.work / "server.log", "a"), stderr=subprocess.STDOUT)
        for _ in range(200):
            if (self.work / "server/url").exists():
                return
            time.sleep(0.1)
        sys.exit("FAILED: nginx did not start: " + (self.work / "server.log").read_text())

    def port(self):
        if not hasattr(self, "its_port"):
            with socket.socket() as s:
                s.bind(("127.0.0.1", 0))
                self.its_port = s.getsockname()[1]
        return self.its_port

    def stop_server(self):
        if self.server:
            self.server.terminate()
            self.server.wait()
        self.server = None

    def certify(self, days):
        """A certificate that is valid for so many days from now on, by the virtual clock."""
        tls = self.work / "server/tls"
        self.virtual("openssl", "req", "-new", "-key", "server.key", "-subj", "/CN=localhost", "-out", "request.pem", cwd=tls)
        self.virtual("openssl", "x509", "-req", "-in", "request.pem", "-CA", "../ca.pem", "-CAkey", "ca.key", "-sha256",
                     "-CAcreateserial", "-days", str(days), "-extfile", "extensions", "-out", "server.pem", cwd=tls)
        self.stop_server()
        self.start_server()

    # -- the publisher

    def publish(self, title):
        parts = self.work / "content/parts.json"
        content = json.loads(parts.read_text())
        content["parts"][0]["title"]["en"] = title
        parts.write_text(json.dumps(content))
        self.gopura("build", "--comment", title)
        self.published += 1

    def gopura(self, command, *more):
        self.virtual("build/gopura-content", command, str(self.work / "content"), "--out", str(self.work / "release"),
                     "--keys", str(self.work / "keys"), *more)

    # -- the terminal

    def start(self, program, *arguments):
        log = open(self.work / f"{program}.log", "a")
        self.children[program] = subprocess.Popen([f"build/gopura-{program}", *arguments], env=self.env, stderr=log, stdout=log)
        self.starts = getattr(self, "starts", {})
        self.starts[program] = self.starts.get(program, 0) + 1

    def start_terminal(self):
        (self.work / "visits.touch").write_text(self.touches())
        self.start("fetch", "--release", f"https://127.0.0.1:{self.port()}/", "--ca", str(self.work / "server/ca.pem"), "--cache",
                   str(self.disk / "cache.db"), "--socket", str(self.work / "socket"), "--metrics", str(self.work / "fetch"),
                   "--poll-s", str(self.poll_s))
        self.start("kiosk", "--display", "headless", "--size", "480x320", "--socket", str(self.work / "socket"), "--trust",
                   str(self.work / "release/tuf/1.root.json"), "--state", str(self.disk), "--metrics", str(self.work / "kiosk"),
                   "--touch-replay", str(self.work / "visits.touch"), "--hours", self.hours,
                   "--visits", str(self.work / "visits.csv"))
        with socket.socket() as s:
            s.bind(("127.0.0.1", 0))
            self.health_port = s.getsockname()[1]
        self.start("health", "--listen", f"127.0.0.1:{self.health_port}", "--kiosk", str(self.work / "kiosk"), "--fetch",
                   str(self.work / "fetch"), "--data", str(self.disk), "--visits", str(self.work / "visits.csv"))

    def visit_times(self, day):
        return [day * DAY + (OPENS + (CLOSES - OPENS) * (i + 0.5) / self.visits) * HOUR for i in range(self.visits)]

    def touches(self):
        """A tap, a drag that turns, a tap where a card may be, for each visit of the year."""
        out = ["# made by museum_year.py"]
        for day in range(self.days):
            for at in self.visit_times(day):
                ms = int((at - self.clock.now_s()) * 1000)
                if ms < 10000:
                    continue
                out += [f"{ms} down 0 240 160", f"{ms + 80} up 0 240 160", f"{ms + 6000} down 0 200 160"]
                out += [f"{ms + 6000 + 50 * i} move 0 {200 + 8 * i} 160" for i in range(1, 10)]
                out += [f"{ms + 6600} up 0 280 160", f"{ms + 12000} down 0 240 120", f"{ms + 12080} up 0 240 120"]
        return "\n".join(out) + "\n"

    def metrics(self):
        try:
            text = urllib.request.urlopen(f"http://127.0.0.1:{self.health_port}/metrics", timeout=20).read().decode()
        except OSError:
            return {}
        return dict(line.rsplit(" ", 1) for line in text.splitlines() if line and line[0] != "#")

    # -- a day

    def sample(self, label, event):
        self.clock.trim()
        metrics = self.metrics()
        row = label | {"event": event, "published": self.published}
        for program, child in self.children.items():
            if child.poll() is not None:
                sys.exit(f"FAILED: gopura-{program} ended on {row['date']}:\n"
                         + "".join((self.work / f"{program}.log").open().readlines()[-15:]))
            proc = pathlib.Path(f"/proc/{child.pid}")
            memory = dict(line.split(":", 1) for line in (proc / "smaps_rollup").read_text().splitlines()[1:])
            status = dict(line.split(":", 1) for line in (proc / "status").read_text().splitlines())
            row |= {f"{program}_memory_kb": int(memory["Pss_Anon"].split()[0]) + int(memory["Pss_Shmem"].split()[0]),
                    f"{program}_heap_kb": self.heap_kb(proc), f"{program}_rss_kb": int(memory["Rss"].split()[0]),
                    f"{program}_fds": len(list((proc / "fd").iterdir())), f"{program}_threads": int(status["Threads"]),
                    f"{program}_starts": self.starts[program]}
        files = {file.name: file.stat().st_size for file in self.disk.iterdir()}
        cache = sum(size for name, size in files.items() if name.startswith("cache.db"))
        before, self.before = self.before, self.written()
        row |= {"cache_bytes": cache, "state_bytes": sum(files.values()) - cache - files.get("filler", 0)}
        row |= {name: now - before[name] for name, now in self.before.items()}
        for name, metric in (("shown", "kiosk_release_sequence"), ("online", "fetch_online"), ("refusals", "kiosk_refusals_total"),
                             ("frames", "kiosk_frames_total"), ("cache_budget_bytes", "fetch_cache_budget_bytes")):
            row[name] = metrics.get(f"gopura_{metric}", self.row.get(name, 0))
        self.row = row
        if not self.table:
            self.table = csv.DictWriter(self.file, row.keys())
            self.table.writeheader()
        self.table.writerow(row)
        self.file.flush()

    def written(self):
        return self.clock.written([child.pid for child in self.children.values()])

    @staticmethod
    def heap_kb(proc):
        """What malloc holds of pieces below 1 MB: without textures, which the driver keeps for a while."""
        size, inside = 0, False
        for line in (proc / "smaps").read_text().splitlines():
            name, *rest = line.split()
            if "-" in name and not name.endswith(":"):
                inside = rest[-1] == "[heap]"
            elif inside and name == "Pss_Anon:" or inside and name == "Anonymous:":
                size = max(size, int(rest[0]))
        return size

    def wait_for_rest(self):
        """Until the picture has settled and the kiosk draws no more, when it gives memory back; most visits come to it."""
        frames = None
        for _ in range(30):
            before, frames = frames, self.metrics().get("gopura_kiosk_frames_total")
            if frames == before:
                return
            time.sleep(0.1)

    def visit(self, at_s):
        self.clock.go_to(at_s - 1, 3600, 0.05)
        self.clock.go_to(at_s + 20, 1, 0.02)
        self.wait_for_rest()
        self.clock.go_to(at_s + 200, 20, 0.03)

    def live_day(self, day):
        for at_s in self.visit_times(day):
            self.visit(at_s)
        self.clock.go_to((day + 1) * DAY, 3600, 0.05)

    def fill_disk(self):
        with open(self.disk / "filler", "wb", buffering=0) as file:
            try:
                while file.write(bytes(4096)) > 0:
                    pass
            except OSError:
                pass

    def events(self):
        """What happens at the beginning of which day. A short sample has the faults that need no month."""
        n = self.days
        if n < 60:
            return {1: [("line drops", self.stop_server), ("disk is full", self.fill_disk)],
                    2: [("line is back", self.start_server), ("disk is free", (self.disk / "filler").unlink),
                        ("clock in 2099", lambda: self.clock.set_wrong(71 * 365 * DAY))],
                    3: [("clock is right", lambda: self.clock.set_wrong(0))]}
        return {n * 1 // 12: [("line drops for 3 days", self.stop_server)], n * 1 // 12 + 3: [("", self.start_server)],
                n * 2 // 12: [("disk is full for 2 days", self.fill_disk)], n * 2 // 12 + 2: [("", (self.disk / "filler").unlink)],
                n * 3 // 12: [("certificate expired", lambda: None)], n * 3 // 12 + 4: [("", lambda: self.certify(3000))],
                n * 5 // 12: [("clock in 2099 for a day", lambda: self.clock.set_wrong(71 * 365 * DAY))],
                n * 5 // 12 + 1: [("", lambda: self.clock.set_wrong(0))],
                n * 6 // 12: [("clock a week slow", lambda: self.clock.set_wrong(-7 * DAY))],
                n * 6 // 12 + 5: [("", lambda: self.clock.set_wrong(0))],
                n * 8 // 12: [("timestamp expired", lambda: None)]}

    def publisher_is_away(self, day):
        """Long enough for the timestamp, which is valid for 30 days, to expire, and to be signed again."""
        return self.days >= 60 and self.days * 8 // 12 - 31 < day < self.days * 8 // 12 + 4

    def wait_until_followed(self):
        """On a busy machine the programs may be slower than the days: some minutes more, at a pace that all can keep."""
        for _ in range(60):
            now = self.metrics()
            if now.get("gopura_fetch_online") == "1" and float(now.get("gopura_kiosk_release_sequence", 0)) >= self.published:
                return
            self.clock.go_to(self.clock.now_s() + 30, 10, 0.2)

    def live(self):
        self.begin(self.days * 3 // 12 if self.days >= 60 else 3000)
        events = self.events()
        for day in range(self.days):
            names = []
            for name, act in events.get(day, []):
                act()
                names.append(name)
            if day % 7 == 3 and not self.publisher_is_away(day):
                self.publish(f"What is new on day {day}")
            self.live_day(day)
            if day == self.days - 1:
                self.wait_until_followed()
            date = (self.begins + datetime.timedelta(day)).isoformat()
            self.sample({"day": day, "date": date}, ";".join(name for name in names if name))

    def begin(self, certified_days):
        """The first release, its server, the terminal, two minutes, and the table."""
        self.disk.mkdir(exist_ok=True)
        self.publish("The first release")
        self.start_server()
        self.certify(certified_days)
        self.start_terminal()
        self.clock.go_to(120, 2, 0.1)
        self.file, self.table, self.before = open(self.work / self.name, "w", newline=""), None, self.written()

    def end(self):
        for child in reversed(self.children.values()):
            child.terminate()
        # gopura-health, which has nothing to put away, is ended by the signal itself
        bad = [name for name, child in self.children.items() if child.wait() not in (0, -15 if name == "health" else 0)]
        self.stop_server()
        (self.disk / "filler").unlink(missing_ok=True)
        return bad


class Hours(Museum):
    """Hours of real time with the programs as they are on a terminal: open all the time, a visitor in every second row, and a
    release in every twelfth."""

    name, hours, poll_s = "hours.csv", "00:00-24:00", POLL_MINUTES * 60

    def __init__(self, work, hours):
        self.rows = hours * 60 // MINUTES
        super().__init__(work, None, 1, 0)

    def set_clock(self):
        self.clock, self.env = RealClock(), dict(os.environ, TZ="UTC")

    def visit_times(self, _):
        return [row * MINUTES * 60 for row in range(1, self.rows, 2)]

    def live(self):
        self.begin(3000)
        began_s = self.clock.now_s()
        for row in range(self.rows):
            names = []
            if row % 12 == 5:
                names = [f"release {self.published + 1}"]
                self.publish(f"What is new in row {row}")
            self.clock.go_to(began_s + (row + 1) * MINUTES * 60)
            self.sample({"minute": (row + 1) * MINUTES, "date": f"{row * MINUTES // 60}:{row * MINUTES % 60:02}"}, ";".join(names))


def main():
    if sys.argv[1] == "check":
        bad = check(sys.argv[2])
        sys.exit(f"FAILED: not flat: {', '.join(bad)}" if bad else 0)
    if sys.argv[1] == "plot":
        return plot(*sys.argv[2:4])
    options = argparse.ArgumentParser()
    options.add_argument("work", type=pathlib.Path)
    options.add_argument("--days", type=int, default=366)
    options.add_argument("--hours", type=int)
    options.add_argument("--start", type=datetime.date.fromisoformat, default=datetime.date(2027, 11, 15))
    options.add_argument("--visits", type=int, default=2)
    given = options.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("FAILED: told to end"))  # and ends what it has started
    work = given.work.resolve()
    museum = Hours(work, given.hours) if given.hours else Museum(work, given.start, given.days, given.visits)
    try:
        museum.live()
    finally:
        bad = museum.end()
    if bad:
        sys.exit(f"FAILED: ended badly: {', '.join(bad)}")


main()
