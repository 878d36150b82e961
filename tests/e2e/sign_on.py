"""A museum's sign-on for the tests, and a browser that comes through it.

    tests/e2e/sign_on.py stand-in PORT   answers /verify: 200 and Remote-User for the cookie museum=NAME, else 401
    tests/e2e/sign_on.py check PORT      what gopura-curator answers through nginx at that port

Standard library only."""

import base64
import http.client
import http.server
import json
import os
import ssl
import sys

HOST = "curator.museum.example"


class StandIn(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        name = dict(part.strip().partition("=")[::2] for part in self.headers.get("Cookie", "").split(";")).get("museum")
        self.send_response(200 if name else 401)
        if name:
            self.send_header("Remote-User", name)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_):
        pass


def ask(port, method, path, cookies, **headers):
    connection = http.client.HTTPSConnection("127.0.0.1", port, timeout=60, context=ssl._create_unverified_context())
    headers = {"Host": HOST, "Cookie": "; ".join(cookies), **{k.replace("_", "-"): v for k, v in headers.items()}}
    connection.request(method, path, None, headers)
    answer = connection.getresponse()
    body = answer.read() if answer.status != 101 else b""
    if answer.headers.get("content-type") == "application/json":
        body = json.loads(body)
    return answer.status, answer.headers, body


def check(port):
    assert ask(port, "GET", "/", [])[0] == 401, "nginx lets somebody in who has not signed on"
    # A browser cannot name itself: nginx replaces the header.
    assert ask(port, "GET", "/api/session", ["museum=rolf"], Remote_User="ana")[2]["name"] == "rolf"
    status, headers, body = ask(port, "GET", "/", ["museum=eve"])
    assert (status, headers["location"]) == (303, "/sign-in"), "eve has no account"
    assert ask(port, "GET", "/api/session", ["museum=eve"])[2]["role"] == "nobody"

    status, headers, body = ask(port, "GET", "/api/session", ["museum=ana"])
    assert status == 200 and body["role"] == "publisher" and body["sign_on"], body
    assert headers["set-cookie"].endswith("; Secure"), headers["set-cookie"]
    cookie, token = headers["set-cookie"].split(";")[0], body["token"]
    assert ask(port, "GET", "/", ["museum=ana"])[0] == 200
    assert ask(port, "GET", "/api/parts", ["museum=ana", cookie])[0] == 200
    # Passwords are of no use, and ana's cookie is of no use to rolf.
    assert ask(port, "POST", "/api/session", ["museum=ana"], Content_Type="application/json")[0] == 403
    body = ask(port, "GET", "/api/session", ["museum=rolf", cookie])[2]
    assert body["name"] == "rolf" and body["token"] != token, body
    assert ask(port, "DELETE", "/api/session", ["museum=rolf", cookie], X_Gopura_Token=token)[0] == 403

    upgrade = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec_WebSocket_Version": "13",
               "Sec_WebSocket_Key": base64.b64encode(os.urandom(16)).decode(), "Origin": f"https://{HOST}"}
    assert ask(port, "GET", f"/socket?token={token}", ["museum=ana", cookie], **upgrade)[0] == 101
    for cookies, origin in ((["museum=rolf", cookie], f"https://{HOST}"), (["museum=ana", cookie], "https://evil.example")):
        try:
            status = ask(port, "GET", f"/socket?token={token}", cookies, **{**upgrade, "Origin": origin})[0]
        except http.client.HTTPException:
            status = 0
        assert status != 101, (cookies, origin)
    assert ask(port, "DELETE", "/api/session", ["museum=ana", cookie], X_Gopura_Token=token)[0] == 200


if __name__ == "__main__":
    if sys.argv[1] == "stand-in":
        http.server.ThreadingHTTPServer(("127.0.0.1", int(sys.argv[2])), StandIn).serve_forever()
    check(int(sys.argv[2]))
