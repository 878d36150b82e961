"""A curator who publishes, and what is killed meanwhile.

    tests/e2e/publish.py WORK KILLS SEED

WORK has content, release and keys, and the accounts ana and petra. Standard library only."""

import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import sys
import time

from curator_http import Client


# As systemd/gopura-curator.service and gopura-publisher.service: two users who share a group. No such users need exist.
WEB, PUBLISHER = {"user": 61001, "group": 61001, "extra_groups": [61003], "umask": 0o007}, \
    {"user": 61002, "group": 61003, "extra_groups": [], "umask": 0o007}


def share(work):
    """Gives each user what is his, as root; returns whether that could be done."""
    folders = [work.absolute(), *work.absolute().parents]
    if os.geteuid() != 0 or any(not folder.stat().st_mode & 1 for folder in folders):
        return False
    subprocess.run(["chown", "-R", "61002:61003", work / "content", work / "release", work / "keys"], check=True)
    subprocess.run(["chown", "-R", "61001:61003", work / "content/.curator"], check=True)
    subprocess.run(["chmod", "-R", "g+rwX", work / "content"], check=True)
    subprocess.run(["find", work / "content", "-type", "d", "-exec", "chmod", "2770", "{}", "+"], check=True)
    subprocess.run(["chmod", "2711", work / "content/.curator"], check=True)
    subprocess.run(["chmod", "600", work / "content/.curator/accounts.json"], check=True)
    return True


class Desk:
    """The web process and the publisher of a content folder, as two users where that can be done."""

    def __init__(self, work):
        self.work, self.port, self.web, self.publisher = work, 0, None, None
        self.are_two = share(work)
        self.start_web()
        self.start_publisher()

    def start_web(self):
        with open(self.work / "web.log", "wb") as log:
            self.web = subprocess.Popen(["build/gopura-curator", self.work / "content", "--port", "0", "--release",
                                         self.work / "release"], stdout=log, stderr=log,
                                        **(WEB if self.are_two else {}))
        until = time.monotonic() + 60
        while not (found := re.search(rb"http://127.0.0.1:(\d+)/", (self.work / "web.log").read_bytes())):
            assert self.web.poll() is None and time.monotonic() < until, "the web process does not start"
            time.sleep(0.05)
        self.port = int(found.group(1))

    def start_publisher(self):
        with open(self.work / "publisher.log", "ab") as log:
            self.publisher = subprocess.Popen(["build/gopura-curator", "publisher", self.work / "content", "--out",
                                               self.work / "release", "--keys", self.work / "keys", "--jobs", "2"],
                                              stdout=log, stderr=log, **(PUBLISHER if self.are_two else {}))

    def sign_in(self, name):
        client = Client(self.port)
        status, answer, _ = client.sign_in(name)
        assert status == 200, answer
        return client

    def kill(self, who):
        """Kills the web process, the publisher, or gopura-content, and starts it again where nobody else does."""
        if who == "content":
            mine = [int(entry) for entry in os.listdir("/proc") if entry.isdigit() and parent_of(entry) == self.publisher.pid]
            for process in mine:
                os.kill(process, signal.SIGKILL)
            return bool(mine)
        process = getattr(self, who)
        process.kill()
        process.wait()
        return True

    def restart(self, who):
        if who == "web":
            self.start_web()
        elif who == "publisher":
            self.start_publisher()

    def stop(self):
        for process in (self.web, self.publisher):
            process.terminate()
            assert process.wait(timeout=60) == 0, "it did not end well"

    def leave_nothing(self):
        """Also after a failure."""
        for process in (self.web, self.publisher):
            if process and process.poll() is None:
                process.kill()


def parent_of(process):
    try:
        return int(pathlib.Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[1])
    except (FileNotFoundError, ProcessLookupError):
        return 0


def settled(client, seconds=120):
    """Waits until nothing is pending, and returns the state."""
    until = time.monotonic() + seconds
    while True:
        state = client.ask("GET", "/api/publish?log=1")[2]
        if state["step"] in ("idle", "done", "failed"):
            return state
        assert time.monotonic() < until, state
        time.sleep(0.05)


def publish(client, comment, **more):
    status, _, answer = client.ask("POST", "/api/publish", json.dumps({"comment": comment, **more}))
    assert status == 202, answer


def check_users(desk, work):
    """The page's process can neither read the keys nor change the release, and the publisher reads no password."""
    if not desk.are_two:
        print("not root, or its folders are closed to others: one user for both")
        return
    key, accounts = work / "keys/release.key", work / "content/.curator/accounts.json"
    for path, who in ((key, WEB), (accounts, PUBLISHER)):
        assert subprocess.run(["cat", path], capture_output=True, **who).returncode != 0, f"{path} is open to {who}"
    assert subprocess.run(["touch", work / "release/release.json"], capture_output=True, **WEB).returncode != 0


def set_title(work, title):
    path = work / "content" / "parts.json"
    parts = json.loads(path.read_text())
    parts["parts"][0]["title"]["en"] = title
    path.write_text(json.dumps(parts))


def check_changes(work, ana):
    status, _, changes = ana.ask("GET", "/api/changes")
    assert status == 200 and changes["release"] == 1 and changes["bytes"] == 0 and not changes["errors"], changes
    set_title(work, "The tower")
    (work / "content/pages/tower.en.html").write_text("<p>Another text.</p><img src='pictures/none.png'>")
    changes = ana.ask("GET", "/api/changes")[2]
    assert any("none.png" in error and "tower.en.html:1" in error for error in changes["errors"]), changes
    assert changes["undescribed"] == [{"file": "pages/tower.en.html", "line": 1, "picture": "pictures/none.png"}]
    (work / "content/pages/tower.en.html").write_text("<p>Another text.</p>")
    changes = ana.ask("GET", "/api/changes")[2]
    assert not changes["errors"] and changes["model"] == "same" and changes["bytes"] > 0
    assert changes["cards"] == [{"key": "tower.en", "title": "The tower", "change": "changed"}], changes
    assert changes["pages"][0]["change"] == "changed" and not changes["parts"], changes


def check_wishes(ana, petra):
    """Only publishers publish, and only what can be published."""
    assert ana.ask("POST", "/api/publish", '{"comment": ""}')[0] == 403
    for body in ("{}", '{"comment": 5}', '{"comment": "two\\nlines"}', '{"comment": "' + "x" * 200 + '"}',
                 '{"comment": "", "sequence": 0}', '{"comment": "", "sequence": "1"}',
                 '{"comment": "", "content": 5}'):
        assert petra.ask("POST", "/api/publish", body)[0] == 422, body
    assert petra.ask("GET", "/api/publish")[2]["step"] == "idle"


def check_seen(work, ana, petra):
    """What somebody has saved since the changes were looked at is not published unseen."""
    ask = lambda content: petra.ask("POST", "/api/publish", json.dumps({"comment": "", "content": content}))
    page, looks = work / "content/pages/tower.en.html", lambda: ana.ask("GET", "/api/changes")[2]
    seen, text = looks(), page.read_text()
    assert looks()["content"] == seen["content"]
    page.write_text(text.replace("Another", "Anothe~"))  # as long, in a page that had been changed before
    status, _, answer = ask(seen["content"])
    assert status == 409 and answer["changes"] == looks() and answer["message"], answer
    assert answer["changes"]["pages"] == seen["pages"] and answer["changes"]["content"] != seen["content"], answer
    page.write_text("<p><a href='part:nothing'>There</a></p>")
    status, _, answer = ask(answer["changes"]["content"])
    assert status == 409 and answer["changes"]["errors"] and "content" not in answer["changes"], answer
    page.write_text(text)
    assert looks() == seen and petra.ask("GET", "/api/publish")[2]["step"] == "idle"


def check_releases(work, petra):
    publish(petra, "--out is no option here", content=petra.ask("GET", "/api/changes")[2]["content"])
    assert petra.ask("POST", "/api/publish", '{"comment": ""}')[0] == 409
    state = settled(petra)
    assert state["step"] == "done" and (state["before"], state["after"]) == (1, 2), state
    newest, first = state["releases"]
    assert newest["comment"] == "--out is no option here" and newest["by"] == "petra" and newest["at"] > 0
    assert first["comment"] == "by hand,?in two lines", first
    assert newest["current"] and not first["current"] and first["sequence"] == 1
    assert "release 2" in state["log"]
    assert petra.ask("GET", "/api/changes")[2]["bytes"] == 0
    publish(petra, "back to the first", sequence=1)
    state = settled(petra)
    assert state["after"] == 3 and [one["current"] for one in state["releases"]] == [True, False, True], state
    publish(petra, "", sequence=77)
    state = settled(petra)
    assert state["step"] == "failed" and "no release 77" in state["message"], state
    (work / "content/pages/tower.en.html").write_text("<p><a href='part:nothing'>There</a></p>")
    publish(petra, "with a dead link")
    state = settled(petra)
    assert state["step"] == "failed" and state["before"] == state["after"], state
    assert "no part has that id" in state["message"], state
    (work / "content/pages/tower.en.html").write_text("<p>Another text.</p>")


def check_damage(work, petra):
    """A file that is damaged is replaced, and nothing is published that nobody has asked for."""
    def damage(name):
        path = work / "content/.curator/publish" / name
        path.with_suffix(".test").write_text("{")
        path.with_suffix(".test").rename(path)
    ask = lambda: petra.ask("GET", "/api/publish")
    before = ask()[2]["releases"]
    damage("request.json")
    status, _, state = ask()
    assert status == 200 and state["releases"] == before, state
    publish(petra, "after a damaged request", sequence=2)
    state = settled(petra)
    assert state["step"] == "done" and len(state["releases"]) == len(before) + 1, state
    damage("state.json")
    until = time.monotonic() + 30
    while (after := ask()[2])["step"] != "failed":
        assert time.monotonic() < until, after
        time.sleep(0.05)
    assert "ask again" in after["message"] and after["releases"] == state["releases"], after
    damage("releases.json")
    assert ask()[0] == 200
    publish(petra, "after damaged releases", sequence=1)
    state = settled(petra)
    assert state["step"] == "done" and len(state["releases"]) == len(before) + 2, state


def check_renewal(desk, work, petra):
    """Once a day what is published is signed anew, and nothing else: not what a curator has changed since."""
    before, log = petra.ask("GET", "/api/publish?log=1")[2], work / "content/.curator/publish/renewal.log"
    assert "nothing changed" in log.read_text(), "the first publisher has not signed anew"
    stamp = (work / "release/timestamp.json").stat().st_mtime
    set_title(work, "Not finished")
    desk.publisher.terminate()
    assert desk.publisher.wait(timeout=60) == 0, "the publisher did not end well"
    os.utime(log, (time.time() - 90000,) * 2)
    desk.start_publisher()
    until = time.monotonic() + 60
    while (work / "release/timestamp.json").stat().st_mtime == stamp:
        assert time.monotonic() < until, "the timestamp of yesterday is not signed anew"
        time.sleep(0.1)
    after = petra.ask("GET", "/api/publish?log=1")[2]
    assert (after["releases"], after["log"]) == (before["releases"], before["log"]), after


def check_page(desk, work):
    """The same in a browser, where there is one."""
    if not shutil.which("chromium"):
        print("chromium is not installed: the page is not looked at")
        return
    set_title(work, "The tower in a browser")
    subprocess.run([sys.executable, "tests/e2e/curator_page.py", str(desk.port), work / "page", "petra"], check=True)


def is_whole(work):
    verified = subprocess.run(["build/gopura-content", "verify", work / "release"], capture_output=True, text=True)
    return verified.returncode == 0, verified.stderr


def check_kills(desk, work, kills, seed):
    """Each round publishes, or goes back, and something is killed after a random time."""
    random.seed(seed)
    took = 1.0
    for n in range(kills):
        petra = desk.sign_in("petra")
        before = petra.ask("GET", "/api/publish")[2]["releases"][0]["sequence"]
        back = n % 4 == 3
        if not back:
            set_title(work, f"Title {n}")
        began = time.monotonic()
        publish(petra, f"round {n}", **({"sequence": 1} if back else {}))
        who = ("publisher", "web", "content")[n % 3]
        time.sleep(random.uniform(0, took * 1.2))
        was_killed = desk.kill(who)
        time.sleep(0.1)
        whole, why = is_whole(work)
        assert whole, f"round {n}: after the kill of {who} the release is not whole: {why}"
        desk.restart(who)
        if who == "web":
            petra = desk.sign_in("petra")
        state = settled(petra)
        assert is_whole(work)[0], f"round {n}: the release is not whole in the end"
        after = state["releases"][0]["sequence"]
        if who == "content" and was_killed and state["step"] == "failed":
            assert after in (before, before + 1), state
            continue
        assert state["step"] == "done", f"round {n}, {who}: {state}"
        assert after == before + 1, f"round {n}, {who}: release {before}, then {after}"
        assert state["releases"][0]["comment"] == f"round {n}" and state["releases"][0]["by"] == "petra", state
        if not was_killed:
            took = time.monotonic() - began
    print(f"{kills} kills: each time a whole release")


def check(desk, work, kills, seed):
    ana, petra = desk.sign_in("ana"), desk.sign_in("petra")
    until = time.monotonic() + 30
    while not (state := ana.ask("GET", "/api/publish")[2])["publisher"] or not state["releases"]:
        assert time.monotonic() < until, "the publisher is not seen"
        time.sleep(0.1)
    second = subprocess.run(["build/gopura-curator", "publisher", work / "content", "--out", work / "release"],
                            capture_output=True, text=True)
    assert second.returncode == 1 and "runs already" in second.stderr, second
    check_users(desk, work)
    check_changes(work, ana)
    check_wishes(ana, petra)
    check_seen(work, ana, petra)
    check_releases(work, petra)
    check_damage(work, petra)
    check_renewal(desk, work, petra)
    check_page(desk, work)
    check_kills(desk, work, kills, seed)
    desk.stop()
    renewals = (work / "publisher.log").read_text().count("signed anew")
    assert renewals == 2, f"signed anew {renewals} times, not twice"


def main(work, kills, seed):
    desk = Desk(work)
    try:
        check(desk, work, kills, seed)
    finally:
        desk.leave_nothing()


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
