"""A browser for gopura-curator: opens its WebSocket by hand and checks what it answers.

    tests/e2e/curator.py PORT FOLDER check     signs in as ana, an editor, and checks everything that docs/curator.md promises
    tests/e2e/curator.py PORT FOLDER measure COUNT   times COUNT curators at once, from an input to its picture

Standard library only."""

import base64
import http.client
import json
import math
import os
import socket
import statistics
import struct
import sys
import threading
import time

WIDTH, HEIGHT = 1280, 720
SMOOTH = "smooth"  # what a picture is that has smooth edges


sign_ins = {}


def sign_in(port, name="ana"):
    """Returns the cookie and the token of an account, whose password the test has chosen."""
    if (port, name) not in sign_ins:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        connection.request("POST", "/api/session", json.dumps({"name": name, "password": f"password of {name}"}),
                           {"Content-Type": "application/json"})
        answer = connection.getresponse()
        body = json.loads(answer.read())
        assert answer.status == 200, body
        sign_ins[port, name] = answer.headers["set-cookie"].split(";")[0], body["token"]
    return sign_ins[port, name]


class Browser:
    """A connection. Texts are kept until they are asked for; pictures are told to have arrived at once."""

    def __init__(self, port, origin=None, host=None, width=WIDTH, height=HEIGHT, name="ana", cookie=None, token=None,
                 tls=None):
        self.port, self.width, self.height = port, width, height
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=120)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        if tls:
            self.socket = tls.wrap_socket(self.socket)
        self.data, self.texts, self.view = b"", [], 0
        host = host or f"127.0.0.1:{port}"
        if cookie is None or token is None:
            own = sign_in(port, name)
            cookie, token = own[0] if cookie is None else cookie, own[1] if token is None else token
        key = base64.b64encode(os.urandom(16)).decode()
        lines = [f"GET /socket?token={token} HTTP/1.1", f"Host: {host}", f"Cookie: theme=dark; {cookie}", "Upgrade: websocket", "Connection: Upgrade",
                 f"Sec-WebSocket-Key: {key}", "Sec-WebSocket-Version: 13"]
        if origin:
            lines.append(f"Origin: {origin}")
        self.socket.sendall("\r\n".join(lines + ["", ""]).encode())
        while b"\r\n\r\n" not in self.data:
            self.more()
        head, self.data = self.data.split(b"\r\n\r\n", 1)
        if b" 101 " not in head.split(b"\r\n")[0]:
            raise ConnectionError(head.split(b"\r\n")[0].decode())

    def more(self):
        piece = self.socket.recv(1 << 16)
        if not piece:
            raise ConnectionError("closed")
        self.data += piece

    def take(self, size):
        while len(self.data) < size:
            self.more()
        piece, self.data = self.data[:size], self.data[size:]
        return piece

    def send_raw(self, payload, opcode=1):
        head = struct.pack("!B", 0x80 | opcode)
        if len(payload) < 126:
            head += struct.pack("!B", 0x80 | len(payload))
        elif len(payload) < 1 << 16:
            head += struct.pack("!BH", 0x80 | 126, len(payload))
        else:
            head += struct.pack("!BQ", 0x80 | 127, len(payload))
        mask = os.urandom(4)
        long_mask = (mask * (len(payload) // 4 + 1))[:len(payload)]
        masked = (int.from_bytes(payload, "big") ^ int.from_bytes(long_mask, "big")).to_bytes(len(payload), "big")
        self.socket.sendall(head + mask + masked)

    def send(self, kind, **values):
        self.send_raw(json.dumps({"type": kind, **values}).encode())

    def receive(self):
        """Returns ("text", object) or ("picture", view, sharp, jpeg); sharp may be SMOOTH."""
        whole = b""
        while True:
            first, second = self.take(2)
            size = second & 127
            if size == 126:
                size = struct.unpack("!H", self.take(2))[0]
            elif size == 127:
                size = struct.unpack("!Q", self.take(8))[0]
            payload, opcode = self.take(size), first & 15
            if opcode == 8:
                raise ConnectionError(payload[2:].decode() or "closed")
            if opcode == 9:
                self.send_raw(payload, 10)
                continue
            if opcode in (1, 2):
                kind = opcode
            whole += payload
            if first & 0x80:
                break
        if kind == 1:
            return ("text", json.loads(whole))
        self.send("got")
        view, flags = struct.unpack("<II", whole[:8])
        return ("picture", view, SMOOTH if flags & 2 else bool(flags & 1), whole[8:])

    def text(self, kind):
        """Returns the next text of that kind; pictures and other texts before it are dropped."""
        while True:
            got = self.receive()
            if got[0] == "text" and got[1]["type"] == kind:
                return got[1]
            if got[0] == "text" and got[1]["type"] == "error":
                raise AssertionError(got[1]["message"])

    def look(self, eye, target, moving=False):
        self.view += 1
        self.send("camera", view=self.view, eye=eye, target=target, fov=40, width=self.width, height=self.height,
                  moving=moving)

    def picture(self, sharp=True):
        """Returns the next picture of the newest camera."""
        while True:
            got = self.receive()
            if got[0] == "text" and got[1]["type"] == "error":
                raise AssertionError(got[1]["message"])
            if got[0] == "picture" and got[1] == self.view and got[2] == sharp:
                return got[3]

    def stroke(self, tool, points, **values):
        self.send("stroke", view=self.view, tool=tool, width=12, points=[c for p in points for c in p], **values)

    def ask(self, kind, **values):
        """Sends it and returns the state of the region after it."""
        self.send(kind, **values)
        return self.text("region")


def jpeg_size(data):
    """Walks the segments of a JPEG and returns its width and height."""
    assert data[:2] == b"\xff\xd8" and data[-2:] == b"\xff\xd9", "not a whole JPEG"
    at = 2
    while True:
        marker, size = struct.unpack("!xBH", data[at:at + 4])
        if marker in (0xc0, 0xc1, 0xc2):
            height, width = struct.unpack("!HH", data[at + 5:at + 9])
            return width, height
        at += 2 + size


def circle(radius, middle=(WIDTH / 2, HEIGHT / 2), count=60):
    return [(middle[0] + radius * math.cos(2 * math.pi * i / count),
             middle[1] + radius * math.sin(2 * math.pi * i / count)) for i in range(count)]


def start(port, **options):
    browser = Browser(port, **options)
    hello = browser.text("hello")
    parts = browser.text("parts")["parts"]
    region = browser.text("region")
    assert region["triangles"] == 0 and region["undo"] == 0 and region["redo"] == 0, region
    return browser, hello, parts


def refusal(browser):
    """Returns the next error; pictures and other texts before it are dropped."""
    while True:
        got = browser.receive()
        if got[0] == "text" and got[1]["type"] == "error":
            return got[1]


def error_of(browser):
    return refusal(browser)["message"]


def refused(port, **options):
    try:
        Browser(port, **options)
    except ConnectionError:
        return
    raise AssertionError(f"a socket was opened for {options}")


def check_malformed(browser):
    view = browser.view
    good = {"type": "stroke", "view": view, "tool": "lasso", "width": 12, "points": [1, 1, 9, 1, 9, 9]}
    for text in ("", "no JSON", "[]", "7", "{}", '{"type": 5}', '{"type": "unknown"}', "{" * 1000, '{"type": "undo"'):
        browser.send_raw(text.encode())
        assert error_of(browser)
    for change in ({"points": [1]}, {"points": [1, 2, 3]}, {"points": "many"}, {"points": [1, "2"]}, {"points": []},
                   {"points": [1, 1e9]}, {"points": [0] * 50002}, {"tool": "axe"}, {"tool": 1}, {"width": -1},
                   {"width": None}, {"take": 1}, {"through": "yes"}, {"view": -1}, {"view": 1e99}):
        browser.send_raw(json.dumps({**good, **change}).encode())
        assert error_of(browser)
    browser.send_raw(json.dumps(good).replace("9", "NaN").encode())
    assert error_of(browser)
    browser.send_raw(json.dumps(good).replace("9", "1e999").encode())
    assert error_of(browser)
    camera = {"type": "camera", "view": 1, "eye": [0, 0, 0], "target": [1, 0, 0], "fov": 40, "width": 640,
              "height": 360}
    for change in ({"eye": [0, 0]}, {"eye": [0, 0, 1e99]}, {"eye": [1, 0, 0]}, {"fov": 0}, {"width": 1e6},
                   {"height": 0}, {"width": "640"}, {"moving": 2}):
        browser.send_raw(json.dumps({**camera, **change}).encode())
        assert error_of(browser)
    for part in ("../x", "", "A", "x" * 65, 5, "a/b"):
        browser.send("save", id=part, title="x")
        assert error_of(browser)
    browser.send("save", id="x", title="two\nlines")
    assert error_of(browser)
    browser.send("stroke", view=view + 7, tool="lasso", width=12, points=good["points"])
    assert "changed" in error_of(browser)
    browser.stroke("lasso", [(5, 5)])
    assert "nothing" in error_of(browser)
    browser.send("open", id="no-such-part")
    assert "no-such-part" in error_of(browser)


def check_tools(browser):
    """Marks the middle of the sharp picture with each tool, and goes back and forth."""
    browser.stroke("lasso", circle(150))
    seen = browser.text("region")
    assert seen["triangles"] > 100 and seen["undo"] == 1, seen
    assert jpeg_size(browser.picture()) == (WIDTH, HEIGHT)
    browser.stroke("lasso", circle(150), through=True)
    through = browser.text("region")
    assert through["triangles"] > seen["triangles"], (seen, through)
    browser.stroke("lasso", circle(60), take=True, through=True)
    less = browser.text("region")
    assert less["triangles"] < through["triangles"], (through, less)
    for wanted in (through, seen):
        assert browser.ask("undo")["triangles"] == wanted["triangles"]
    state = browser.ask("undo")
    assert state["triangles"] == 0 and state["undo"] == 0 and state["redo"] == 3, state
    assert browser.ask("undo")["triangles"] == 0
    for wanted in (seen, through, less):
        state = browser.ask("redo")
        assert state["triangles"] == wanted["triangles"]
    assert state["redo"] == 0 and browser.ask("redo")["triangles"] == less["triangles"]
    grown = browser.ask("grow")
    assert grown["triangles"] > less["triangles"]
    assert browser.ask("shrink")["triangles"] < grown["triangles"]
    smooth = browser.ask("smooth")  # a step of its own
    assert abs(smooth["triangles"] - less["triangles"]) < less["triangles"] / 4, (less, smooth)
    assert browser.ask("undo")["undo"] == smooth["undo"] - 1
    assert browser.ask("empty")["triangles"] == 0
    browser.stroke("heavy", circle(150))
    assert browser.text("region")["triangles"] > 100
    assert browser.ask("undo")["triangles"] == 0
    browser.stroke("part", [(600, 360), (680, 360)])
    state = browser.text("region")
    assert state["marks"] and state["triangles"] == 0, state
    browser.stroke("rest", circle(340))
    assert browser.text("region")["triangles"] == 0
    state = browser.ask("apply", view=browser.view)
    assert state["triangles"] > 100 and not state["marks"], state
    assert browser.ask("undo")["triangles"] == 0
    browser.send("pick", view=browser.view, points=[WIDTH / 2, HEIGHT / 2])
    assert len(browser.text("point")["at"]) == 3
    browser.send("pick", view=browser.view, points=[0.5, 0.5])
    assert "at" not in browser.text("point")


def check_smooth(browser, eye, target):
    """A while after the sharp picture the same one comes with smooth edges, and again after a change of the region."""
    browser.look(eye, target)
    sharp = browser.picture()
    smooth = browser.picture(SMOOTH)
    assert jpeg_size(smooth) == jpeg_size(sharp) and smooth != sharp
    assert len(smooth) < len(sharp), (len(smooth), len(sharp))  # it has fewer steps to encode
    browser.stroke("lasso", circle(120))
    browser.text("region")
    browser.picture()
    assert browser.picture(SMOOTH) != smooth
    browser.ask("undo")
    browser.picture()


def check_parts(browser, port, folder):
    before = json.load(open(f"{folder}/parts.json", encoding="utf-8"))
    browser.send("save", id="the-middle", title="The middle", new=True)
    assert "nothing is marked" in error_of(browser)
    browser.stroke("lasso", circle(120))
    marked = browser.text("region")["triangles"]
    browser.send("save", id="the-middle", new=True)
    assert "title" in error_of(browser)
    title = "The \"middle\" \u17a2"
    browser.send("save", id="the-middle", title=title, new=True)
    saved = browser.text("parts")
    assert saved["saved"] == "the-middle"
    assert {"id": "the-middle", "title": title, "titles": {"en": title}, "faces": True} in saved["parts"]
    after = json.load(open(f"{folder}/parts.json", encoding="utf-8"))
    assert after["parts"].pop() == {"id": "the-middle", "page": False, "region": {"kind": "faces",
                                    "file": "regions/the-middle.faces"}, "title": {"en": "The \"middle\" \u17a2"}}
    assert after == before, "something else in parts.json has changed"
    other, _, parts = start(port)
    assert any(part["id"] == "the-middle" for part in parts)
    assert other.ask("open", id="the-middle")["triangles"] == marked
    shape = next(part["id"] for part in parts if not part["faces"])
    assert other.ask("open", id=shape)["triangles"] == 0, "a shape has faces marked"
    # Saved again under the same id: the region is replaced, the title stays.
    assert other.ask("open", id="the-middle")["triangles"] == marked
    more = other.ask("grow")["triangles"]
    other.send("save", id="the-middle")
    other.text("parts")
    assert browser.ask("open", id="the-middle")["triangles"] == more
    last = json.load(open(f"{folder}/parts.json", encoding="utf-8"))
    assert last["parts"][-1]["title"] == {"en": "The \"middle\" \u17a2"} and len(last["parts"]) == len(after["parts"]) + 1


def come(port, eye, target):
    """A browser with a sharp picture."""
    browser = start(port)[0]
    browser.look(eye, target)
    browser.picture()
    return browser


def mark_new(browser, radius):
    """Begins a new part and marks the middle. Returns the number of triangles."""
    assert browser.ask("empty")["opened"] == ""
    browser.stroke("lasso", circle(radius))
    return browser.text("region")["triangles"]


def saved(browser, **values):
    browser.send("save", **values)
    return browser.text("parts")["saved"]


def check_conflicts(port, folder, eye, target):
    """Of two who mark, neither overwrites the other's without knowing it."""
    a, b = come(port, eye, target), come(port, eye, target)
    # Two new parts that want one id, as those do whose titles have no Latin letters.
    sizes = mark_new(a, 60), mark_new(b, 90)
    ids = saved(a, id="part", title="\u1791", new=True), saved(b, id="part", title="\u1794", new=True)
    assert ids == ("part", "part-2"), ids
    assert tuple(b.ask("open", id=part)["triangles"] for part in ids) == sizes
    # The same part, which both have opened.
    for browser in (a, b):
        assert browser.ask("open", id="part")["opened"] == "part"
    a.ask("grow")
    theirs = b.ask("grow"), b.ask("grow")
    assert saved(b, id="part") == "part"
    a.send("save", id="part")
    error = refusal(a)
    assert (error["of"], error["conflict"]) == ("save", "changed"), error
    assert saved(a, id="part", title="Mine", new=True) == "part-3"  # nothing that a marked is lost
    assert a.ask("open", id="part")["triangles"] == theirs[1]["triangles"]
    b.ask("shrink")
    assert saved(b, id="part") == "part"
    mine = a.ask("grow")["triangles"]
    a.send("save", id="part")
    assert refusal(a)["conflict"] == "changed"
    assert saved(a, id="part", replace=True) == "part"
    assert b.ask("open", id="part")["triangles"] == mine
    # A title that somebody has written meanwhile.
    assert saved(b, id="part", title="Gate", **{"from": "\u1791"}) == "part"
    a.ask("open", id="part")
    a.send("save", id="part", title="Door", **{"from": "\u1791"})
    error = refusal(a)
    assert error["conflict"] == "changed" and "Gate" in error["message"], error
    # A part that somebody removes meanwhile.
    cookie, token = sign_in(port)
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("DELETE", "/api/parts/part", headers={"Cookie": cookie, "X-Gopura-Token": token})
    assert connection.getresponse().status == 200
    a.send("save", id="part", title="Door", **{"from": "Gate"})
    error = refusal(a)
    assert error["conflict"] == "removed" and "new part" in error["message"], error
    parts = json.load(open(f"{folder}/parts.json", encoding="utf-8"))["parts"]
    assert all(part["id"] != "part" for part in parts) and not os.path.exists(f"{folder}/regions/part.faces")
    b.send("open", id="part")
    error = refusal(b)
    assert error["of"] == "open" and "removed" in error["message"], error
    # A region is of the part that was opened last; what cannot be opened changes nothing of that.
    for browser in (a, b):
        browser.ask("open", id="part-2")
    a.send("open", id="no-such-part")
    error_of(a)
    a.send("save", id="part-3")
    assert "part-3" in error_of(a)
    assert a.ask("undo")["triangles"] == sizes[1], "undoing leads to what another part has"
    assert saved(a, id="part-2") == "part-2"


def check_ninth(port):
    """Whoever finds no room is told so, and comes in when there is some."""
    browsers = []
    try:
        for _ in range(9):
            browsers.append(start(port)[0])
        assert False, "nine browsers show the model"
    except ConnectionError as error:
        assert "close one" in str(error), error
    for browser in browsers:
        browser.socket.close()
    while True:
        try:
            start(port)[0].socket.close()
            return
        except ConnectionError:
            time.sleep(0.1)


def check_two(port, eye, target):
    """Neither of two browsers that move at once waits for the other to stop."""
    browsers = [start(port)[0] for _ in range(2)]
    counts = [0, 0]
    for step in range(10):
        for browser in browsers:
            browser.look([eye[0] + 0.1 * step, eye[1], eye[2]], target, moving=True)
        for n, browser in enumerate(browsers):
            assert jpeg_size(browser.picture(sharp=False)) == (WIDTH / 2, HEIGHT / 2)
            counts[n] += 1
    assert counts == [10, 10]
    # Many cameras at once: the newest wins, and no picture of most others is drawn.
    for step in range(200):
        browsers[0].look([eye[0] - 0.01 * step, eye[1], eye[2]], target, moving=True)
    browsers[0].look(eye, target)
    pictures = 0
    while True:
        got = browsers[0].receive()
        pictures += got[0] == "picture"
        if got[0] == "picture" and got[1] == browsers[0].view:
            break
    assert pictures < 150, f"{pictures} pictures of 201 cameras"


def check_reader(port, eye, target):
    """Whoever may look marks for himself, and saves nothing."""
    reader = start(port, name="rolf")[0]
    reader.look(eye, target)
    reader.picture()
    reader.stroke("lasso", circle(120))
    assert reader.text("region")["triangles"] > 0
    reader.send("save", id="of-a-reader", title="No", new=True)
    assert "reader" in error_of(reader)


def check_end(port):
    """Who has signed out has no socket any more, neither the old one nor a new one."""
    rolf = start(port, name="rolf")[0]
    cookie, token = sign_ins.pop((port, "rolf"))
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request("DELETE", "/api/session", headers={"Cookie": cookie, "X-Gopura-Token": token})
    assert connection.getresponse().status == 200
    try:
        while True:
            rolf.receive()
    except ConnectionError:
        pass
    refused(port, cookie=cookie, token=token)


def check(port, folder):
    for host, origin in ((None, "http://evil.example"), (f"evil.example:{port}", None),
                         (None, f"http://127.0.0.1:{port + 1}"), (None, "null")):
        refused(port, host=host, origin=origin)
    for cookie, token in (("", ""), ("", None), (None, ""), (None, "0" * 64), ("gopura-curator=1", None)):
        refused(port, cookie=cookie, token=token)
    Browser(port, origin=f"http://localhost:{port}", host=f"localhost:{port}")
    browser, hello, parts = start(port, origin=f"http://127.0.0.1:{port}")
    assert hello["triangles"] > 1000 and parts, hello
    eye, target = hello["eye"], hello["target"]
    browser.look(eye, target, moving=True)
    assert jpeg_size(browser.picture(sharp=False)) == (WIDTH / 2, HEIGHT / 2)
    browser.look(eye, target)
    assert jpeg_size(browser.picture()) == (WIDTH, HEIGHT)
    check_malformed(browser)
    check_smooth(browser, eye, target)
    check_tools(browser)
    check_parts(browser, port, folder)
    check_conflicts(port, folder, eye, target)
    check_two(port, eye, target)
    check_reader(port, eye, target)
    check_end(port)
    # A message beyond the limit ends its own connection only.
    rude = Browser(port)
    try:
        rude.send_raw(b"x" * (1 << 20))
        while True:
            rude.receive()
    except (ConnectionError, BrokenPipeError):
        pass
    assert browser.ask("empty")["triangles"] == 0
    check_ninth(port)
    print("all is as promised")


def orbit(eye, target, angle):
    x, y = eye[0] - target[0], eye[1] - target[1]
    return [target[0] + x * math.cos(angle) - y * math.sin(angle),
            target[1] + x * math.sin(angle) + y * math.cos(angle), eye[2]]


def work(port, number, seconds, row):
    """A curator who drags for a second and lets go, again and again; each input follows the picture before it. Then one
    lasso and one heavy lasso."""
    browser, hello, _ = start(port)
    eye, target = hello["eye"], hello["target"]
    moving, sharp, tools = [], [], []
    angle, end = number, time.monotonic() + seconds
    browser.look(orbit(eye, target, angle), target)
    browser.picture()  # what comes first is decoded
    while time.monotonic() < end:
        let_go = time.monotonic() + 1
        while time.monotonic() < let_go:
            angle += 0.02
            begun = time.monotonic()
            browser.look(orbit(eye, target, angle), target, moving=True)
            browser.picture(sharp=False)
            moving.append(1000 * (time.monotonic() - begun))
        begun = time.monotonic()
        browser.look(orbit(eye, target, angle), target)
        browser.picture()
        sharp.append(1000 * (time.monotonic() - begun))
    for tool in ("lasso", "heavy"):
        begun = time.monotonic()
        browser.stroke(tool, circle(150))
        browser.text("region")
        tools.append(1000 * (time.monotonic() - begun))
    row[number] = {"triangles": hello["triangles"], "moving": moving, "sharp": sharp, "tools": tools}


def measure(port, count, seconds=20):
    """Prints a row of JSON: milliseconds from input to picture of so many curators at once, a figure for each."""
    row = [None] * count
    threads = [threading.Thread(target=work, args=(port, number, seconds, row)) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print(json.dumps({
        "curators": count, "triangles": row[0]["triangles"],
        "moving_ms": [round(statistics.median(one["moving"])) for one in row],
        "moving_worst_ms": [round(max(one["moving"])) for one in row],
        "sharp_ms": [round(statistics.median(one["sharp"])) for one in row],
        "sharp_worst_ms": [round(max(one["sharp"])) for one in row],
        "pictures": [len(one["moving"]) + len(one["sharp"]) for one in row],
        "lasso_ms": [round(one["tools"][0]) for one in row],
        "heavy_ms": [round(one["tools"][1]) for one in row]}))


if __name__ == "__main__":
    if sys.argv[3] == "measure":
        measure(int(sys.argv[1]), int(sys.argv[4]))
    else:
        check(int(sys.argv[1]), sys.argv[2])
