"""What gopura-curator answers over HTTP: files, errors, limits, and who may do what.

    tests/e2e/curator_http.py PORT FOLDER

The folder has the accounts rolf, ana and petra, whose passwords are "password of NAME". Standard library only."""

import gzip
import http.client
import json
import socket
import subprocess
import sys
import time


class Client:
    """One connection that is kept. Answers are (status, headers, body); a body of JSON is parsed."""

    def __init__(self, port):
        self.port = port
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        self.cookie = self.token = None

    def ask(self, method, path, body=None, **headers):
        headers = {k.replace("_", "-"): v for k, v in headers.items()}
        if self.cookie:
            headers.setdefault("Cookie", self.cookie)
        if self.token:
            headers.setdefault("X-Gopura-Token", self.token)
        try:
            self.connection.request(method, path, body, headers)
            response = self.connection.getresponse()
        except (http.client.RemoteDisconnected, BrokenPipeError, ConnectionResetError):
            # The server closes a connection that was idle for 30 s, as any does; a browser opens another.
            self.connection.close()
            self.connection.request(method, path, body, headers)
            response = self.connection.getresponse()
        data = response.read()
        if response.headers["content-type"] == "application/json":
            data = json.loads(data)
        return response.status, response.headers, data

    def sign_in(self, name, password=None):
        """Returns status and body; a cookie and a token are kept."""
        body = json.dumps({"name": name, "password": password or f"password of {name}"})
        status, headers, answer = self.ask("POST", "/api/session", body, Content_Type="application/json")
        if status == 200:
            self.cookie, self.token = headers["set-cookie"].split(";")[0], answer["token"]
        return status, answer, headers


def signed_in(port, name):
    client = Client(port)
    status, answer, _ = client.sign_in(name)
    assert status == 200, answer
    return client


def check_files(client):
    status, headers, page = client.ask("GET", "/")
    assert status == 200 and b"curator.js" in page
    assert headers["content-security-policy"].startswith("default-src 'none'; script-src 'self'")
    assert headers["x-content-type-options"] == "nosniff"
    status, _, body = client.ask("GET", "/", If_None_Match=headers["etag"])
    assert (status, body) == (304, b"")
    status, zipped, body = client.ask("GET", "/", Accept_Encoding="gzip, br")
    assert zipped["content-encoding"] == "gzip" and gzip.decompress(body) == page and len(body) < len(page)
    assert zipped["etag"] != headers["etag"]
    status, _, body = client.ask("GET", "/", Accept_Encoding="gzip, br", If_None_Match=zipped["etag"])
    assert status == 304


def check_errors(client):
    status, headers, body = client.ask("GET", "/temple.ini")
    assert status == 404 and body["message"], body
    for path in ("/../temple.ini", "/api/../../temple.ini", "/%2e%2e/temple.ini", "//temple.ini", "/api/parts/"):
        assert client.ask("GET", path)[0] in (403, 404), path
    status, headers, body = client.ask("DELETE", "/api/parts")
    assert status == 405 and headers["allow"] == "GET" and "GET" in body["message"]
    assert client.ask("POST", "/api/nothing", b"x" * 1000)[0] == 404
    assert client.ask("GET", "/api/parts")[0] == 200, "the connection is not as before"
    assert client.ask("GET", "/api/parts", Host="evil.example")[0] == 403
    assert client.ask("GET", "/api/parts", Origin="http://evil.example")[0] == 403
    assert client.ask("GET", "/api/parts?a=" + "b" * 2000)[0] == 414


def raw(port, text):
    """Sends bytes of its own, and returns the first line of what comes back."""
    with socket.create_connection(("127.0.0.1", port), timeout=60) as connection:
        connection.sendall(text)
        try:
            return connection.recv(4096).split(b"\r\n")[0]
        except ConnectionResetError:
            return b""


def check_lengths(port):
    """A body's length must be known, and is limited before it comes."""
    head = f"PUT /api/parts HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
    for length in ("Content-Length: 999999999999", "Content-Length: -5", "Content-Length: 12a",
                   "Transfer-Encoding: chunked", "X-Nothing: 1"):
        line = raw(port, f"{head}{length}\r\n\r\n".encode())
        assert line == b"" or line.split()[1] in (b"400", b"405", b"411", b"413"), (length, line)


def check_parts(client):
    status, headers, parts = client.ask("GET", "/api/parts")
    assert status == 200 and all(part["id"] for part in parts), parts
    assert headers["cache-control"] == "no-store"
    assert client.ask("GET", "/api/parts", If_None_Match=headers["etag"])[0] == 304


def check_sign_in(port):
    stranger = Client(port)
    status, headers, _ = stranger.ask("GET", "/")
    assert (status, headers["location"]) == (303, "/sign-in")
    status, headers, page = stranger.ask("GET", "/sign-in")
    assert status == 200 and b"Password" in page
    for path in ("/curator.js", "/curator.css", "/sign_in.js"):
        assert stranger.ask("GET", path)[0] == 200
    assert stranger.ask("GET", "/api/parts")[0] == 401
    status, _, body = stranger.ask("GET", "/api/session")
    assert status == 200 and body["role"] == "nobody" and not body["token"]
    # The same words whether there is such an account or not.
    wrong = stranger.sign_in("ana", "not her password")
    assert wrong[:2] == (401, {"message": "name or password is wrong"})
    assert stranger.sign_in("nobody-here", "not her password")[:2] == wrong[:2]
    assert stranger.sign_in("", "x")[:2] == wrong[:2]
    assert stranger.ask("POST", "/api/session", '{"name": "ana", "password": "password of ana"}',
                        Content_Type="text/plain")[0] == 415
    for body in ("{", "", None):
        assert stranger.ask("POST", "/api/session", body, Content_Type="application/json")[0] == 400, body
    assert stranger.ask("POST", "/api/session", "x" * 5000, Content_Type="application/json")[0] == 413
    ana = Client(port)
    status, answer, headers = ana.sign_in("ana")
    assert status == 200 and answer["role"] == "editor" and len(answer["token"]) == 64
    cookie = headers["set-cookie"]
    assert "; HttpOnly; SameSite=Strict" in cookie and "Secure" not in cookie and len(ana.cookie) > 64
    assert ana.ask("GET", "/api/session")[2]["name"] == "ana"
    return ana


def check_tokens(ana):
    """A change needs the page's token; and signing out ends the session for whoever has the cookie."""
    for token in ("", "0" * 64, ana.token[:-1], ana.token + "0"):
        assert ana.ask("DELETE", "/api/session", X_Gopura_Token=token)[0] == 403, token
    assert ana.ask("GET", "/api/session")[2]["name"] == "ana"
    assert ana.ask("DELETE", "/api/session", Origin="http://evil.example")[0] == 403
    status, headers, _ = ana.ask("DELETE", "/api/session")
    assert status == 200 and "Max-Age=0" in headers["set-cookie"]
    assert ana.ask("GET", "/api/parts")[0] == 401


def check_guessing(port):
    """After some failures even the right password must wait; other accounts need not, yet."""
    client = Client(port)
    statuses = []
    # The wait doubles with each failure, so on a machine of any speed it is soon longer than an attempt takes.
    while 429 not in statuses and len(statuses) < 15:
        statuses.append(client.sign_in("petra", f"guess number {len(statuses)}")[0])
    assert statuses[:5] == [401] * 5 and statuses[-1] == 429, statuses
    status, answer, headers = client.sign_in("petra")
    assert status == 429 and int(headers["retry-after"]) >= 1 and "try again" in answer["message"]
    assert client.sign_in("rolf")[0] == 200
    deadline = time.monotonic() + 60
    while status == 429 and time.monotonic() < deadline:
        time.sleep(int(headers["retry-after"]))
        status, answer, headers = client.sign_in("petra")
    assert status == 200, answer


def check_requests(port):
    """Too many requests of one session are refused; after a while they are not."""
    rolf = signed_in(port, "rolf")
    statuses = [rolf.ask("GET", "/api/session")[0] for _ in range(600)]
    assert statuses[0] == 200 and 429 in statuses
    deadline = time.monotonic() + 60
    while rolf.ask("GET", "/api/session")[0] == 429:
        assert time.monotonic() < deadline
        time.sleep(0.3)


def check_changes(port, folder):
    """What the command does to accounts holds at once, in a running program."""
    def user(*arguments, password=None):
        subprocess.run(["build/gopura-curator", "user", *arguments], input=password, text=True, check=True)
    ana = signed_in(port, "ana")
    user("role", folder, "ana", "--role", "reader")
    assert ana.ask("GET", "/api/session")[2]["role"] == "reader"
    user("role", folder, "ana", "--role", "editor")
    user("password", folder, "ana", password="another one\n")
    assert ana.ask("GET", "/api/parts")[0] == 401, "whoever knew the old password is still in"
    assert ana.sign_in("ana")[0] == 401
    assert ana.sign_in("ana", "another one")[0] == 200
    user("remove", folder, "ana")
    assert ana.ask("GET", "/api/parts")[0] == 401
    user("add", folder, "ana", password="password of ana\n")


def main(port, folder):
    check_tokens(check_sign_in(port))
    ana = signed_in(port, "ana")
    check_files(ana)
    check_errors(signed_in(port, "ana"))
    check_lengths(port)
    check_parts(ana)
    check_guessing(port)
    check_requests(port)
    check_changes(port, folder)
    print("HTTP is as promised")


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2])
