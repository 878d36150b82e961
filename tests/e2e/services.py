"""What a browser asks the curator's services for, through nginx, where systemd has started them (services.sh).

Standard library only."""

import http.client
import json
import pathlib
import ssl
import time

from curator import Browser, circle

HOST = "curator.museum.example"
TLS = ssl._create_unverified_context()


class Client:
    def __init__(self, name):
        self.headers = {"Host": HOST}
        body = {"name": name, "password": f"password of {name}"}
        status, headers, answer = self.ask("POST", "/api/session", json.dumps(body), {"Content-Type": "application/json"})
        assert status == 200, answer
        self.cookie, self.token = headers["set-cookie"].split(";")[0], answer["token"]
        self.headers |= {"Cookie": self.cookie, "X-Gopura-Token": self.token}

    def ask(self, method, path, body=None, headers={}):
        connection = http.client.HTTPSConnection("127.0.0.1", 443, timeout=60, context=TLS)
        connection.request(method, path, body, {**self.headers, **headers})
        answer = connection.getresponse()
        data = answer.read()
        if answer.headers["content-type"] == "application/json":
            data = json.loads(data)
        return answer.status, answer.headers, data


def must(answer, status=200):
    assert answer[0] == status, answer
    return answer[2]


def main():
    until = time.monotonic() + 30
    while True:
        try:
            ana = Client("ana")
            break
        except (OSError, AssertionError):
            assert time.monotonic() < until
            time.sleep(0.2)
    petra = Client("petra")

    # A picture of the master, a part marked on it and saved.
    browser = Browser(443, host=HOST, origin=f"https://{HOST}", cookie=ana.cookie, token=ana.token, tls=TLS)
    hello = browser.text("hello")
    low, high = hello["low"], hello["high"]
    target = [(a + b) / 2 for a, b in zip(low, high)]
    browser.look([target[0] + 30, target[1] - 40, target[2] + 10], target)
    assert browser.picture()[:2] == b"\xff\xd8"
    browser.stroke("lasso", circle(100))
    assert browser.text("region")["triangles"] > 0
    browser.send("save", id="mark", title="Mark", language="en", new=True)
    assert browser.text("parts")["saved"] == "mark"

    # What comes from outside is decoded in a sandbox of its own.
    picture = next(pathlib.Path().glob("*.jpg")).read_bytes()
    octets = {"Content-Type": "application/octet-stream"}
    name = must(ana.ask("POST", "/api/pictures?name=view", picture, octets))["name"]
    assert must(ana.ask("GET", f"/api/picture?name={name}"))[:2] == b"\xff\xd8"
    html = f'<h1>Mark</h1><p>Some words.</p><img src="{name}" alt="A view">'
    must(ana.ask("PUT", "/api/pages/mark.en", json.dumps({"html": html}), {"If-None-Match": "*"}))
    must(ana.ask("PUT", "/api/spoken/mark.en", pathlib.Path("spoken.opus").read_bytes(), {"If-None-Match": "*", **octets}))
    for kind in ("near", "card", "page"):
        preview = must(ana.ask("POST", "/api/preview", json.dumps({"part": "mark", "language": "en", "kind": kind})))
        assert preview[:2] == b"\xff\xd8", kind

    # A release by the other service.
    must(petra.ask("POST", "/api/publish", json.dumps({"comment": "Marked"})), 202)
    while (state := must(petra.ask("GET", "/api/publish?log=1")))["step"] in ("waiting", "running"):
        assert time.monotonic() < until + 120, state
        time.sleep(0.2)
    assert state["step"] == "done" and len(state["releases"]) == 2, state
    print("the services do what a browser asks for")


main()
