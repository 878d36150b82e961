"""What gopura-curator answers over HTTP: files, errors, limits.

    tests/e2e/curator_http.py PORT

Standard library only."""

import gzip
import http.client
import json
import socket
import sys


class Client:
    """One connection that is kept. Answers are (status, headers, body); a body of JSON is parsed."""

    def __init__(self, port):
        self.port = port
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)

    def ask(self, method, path, body=None, **headers):
        self.connection.request(method, path, body, {k.replace("_", "-"): v for k, v in headers.items()})
        response = self.connection.getresponse()
        data = response.read()
        if response.headers["content-type"] == "application/json":
            data = json.loads(data)
        return response.status, response.headers, data


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


def main(port):
    client = Client(port)
    check_files(client)
    check_errors(Client(port))
    check_lengths(port)
    check_parts(client)
    print("HTTP is as promised")


if __name__ == "__main__":
    main(int(sys.argv[1]))
