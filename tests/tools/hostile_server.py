"""A museum server that is ill-meant, or somebody who answers in its place.

    hostile_server.py FOLDER MODE_FILE PORT_FILE

serves FOLDER over HTTP as the first word of MODE_FILE says, looked up for each request:

    good                  the files, with ranges and ETags
    portal                its page of login, for whatever is asked
    elsewhere             a redirection to a neighbour, another port of this machine
    home                  a redirection to a file of the terminal, then to its own port by another name
    round                 a redirection to where it came from, for ever
    silent                no answer
    slow                  a byte a second
    endless               a body without end
    headers               headers without end
    shifted               another range than was asked for
    overlapping           all ranges it was asked for, twice, as a multipart body
    longer                more than was asked for
    reset                 a connection that is broken in the midst of a body
    bomb                  a body of a thousand times its size, said to be packed
    rubbish               what is no HTTP
    broken                the files, but an error of its own for the middle of a pack

PORT_FILE gets "PORT NEIGHBOUR", MODE_FILE.visits a line for each visit to the neighbour, and
MODE_FILE.looks one for each look for a timestamp while it is broken. Ends with its standard input."""
import gzip
import os
import random
import socket
import struct
import sys
import threading
import time

folder, mode_file, port_file = sys.argv[1:4]
PAGE = b"<html><title>Museum guest network</title>Welcome! Please log in. "
BOMB = gzip.compress(bytes(64 << 20))


def mode():
    with open(mode_file) as file:
        return file.read().split()[0]


def read_request(connection):
    request = b""
    while b"\r\n\r\n" not in request:
        piece = connection.recv(65536)
        if not piece or len(request) > 65536:
            return None, {}
        request += piece
    lines = request.decode("latin-1").split("\r\n")
    fields = dict(line.lower().split(": ", 1) for line in lines[1:] if ": " in line)
    return lines[0].split(" ")[1], fields


def answer(connection, status, body, *fields):
    head = [f"HTTP/1.1 {status}", f"Content-Length: {len(body)}", *fields, "", ""]
    connection.sendall("\r\n".join(head).encode() + body)


def asked_range(fields, size):
    first, last = fields["range"].removeprefix("bytes=").split("-")
    return int(first), min(int(last), size - 1)


def serve_file(connection, path, fields, how):
    if how == "broken" and path.endswith("/timestamp.json"):
        with open(mode_file + ".looks", "a") as file:
            file.write("a look\n")
    name = os.path.join(folder, path.lstrip("/"))
    if not os.path.isfile(name):
        answer(connection, "404 Not Found", b"none")
        return
    with open(name, "rb") as file:
        body = file.read()
    if "range" not in fields:
        answer(connection, "200 OK", body, f'ETag: "{hash(body)}"')
        return
    first, last = asked_range(fields, len(body))
    content_range = f"Content-Range: bytes {first}-{last}/{len(body)}"
    part = body[first : last + 1]
    if how == "broken" and first <= len(body) // 2 <= last:
        answer(connection, "500 Internal Server Error", b"the disk has a bad sector")
    elif how == "shifted":
        first += 1
        answer(connection, "206 Partial", part, f"Content-Range: bytes {first}-{last + 1}/{len(body)}")
    elif how == "overlapping":
        piece = b"--X\r\n" + content_range.encode() + b"\r\n\r\n" + part + b"\r\n"
        answer(connection, "206 Partial", piece * 2 + b"--X--\r\n", "Content-Type: multipart/byteranges; boundary=X")
    elif how == "longer":
        answer(connection, "206 Partial", part + bytes(1 << 20), content_range)
    elif how == "reset":
        connection.sendall(
            f"HTTP/1.1 206 Partial\r\nContent-Length: {len(part)}\r\n{content_range}\r\n\r\n".encode()
            + part[: len(part) // 2]
        )
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    else:
        answer(connection, "206 Partial", part, content_range)


def pour(connection, head, piece, pause_s=0.0):
    connection.sendall(head)
    while True:
        connection.sendall(piece)
        time.sleep(pause_s)


def serve(connection, port, neighbour):
    how = mode()
    path, fields = read_request(connection)
    if path is None:
        return False
    if how == "portal":
        answer(connection, "200 OK", PAGE + str(random.random()).encode(), "Content-Type: text/html")
    elif how == "elsewhere":
        answer(connection, "302 Found", b"", f"Location: http://127.0.0.1:{neighbour}/login")
    elif how == "home":
        to = random.choice(["file:///etc/passwd", f"http://localhost:{neighbour}{path}", "gopher://127.0.0.1/"])
        answer(connection, "302 Found", b"", f"Location: {to}")
    elif how == "round":
        answer(connection, "302 Found", b"", f"Location: {path}")
    elif how == "silent":
        time.sleep(60)
    elif how == "slow":
        pour(connection, b"HTTP/1.1 200 OK\r\nContent-Length: 60000\r\n\r\n", b"x", 1)
    elif how == "endless":
        pour(connection, b"HTTP/1.1 200 OK\r\n\r\n", bytes(1 << 16))
    elif how == "headers":
        pour(connection, b"HTTP/1.1 200 OK\r\n", b"X-More: " + b"x" * 990 + b"\r\n")
    elif how == "bomb":
        answer(connection, "200 OK", BOMB, "Content-Encoding: gzip")
    elif how == "rubbish":
        connection.sendall(random.randbytes(5000))
        return False
    else:
        serve_file(connection, path, fields, how)
        return how != "reset"
    return True


def keep_serving(connection, port, neighbour):
    try:
        while serve(connection, port, neighbour):
            pass
    except OSError:
        pass
    connection.close()


def visit(connection):
    with open(mode_file + ".visits", "a") as file:
        file.write("a visit\n")
    connection.close()


def listen(handler):
    listener = socket.create_server(("127.0.0.1", 0), backlog=64)

    def accept():
        while True:
            connection, _ = listener.accept()
            threading.Thread(target=handler, args=(connection,), daemon=True).start()

    threading.Thread(target=accept, daemon=True).start()
    return listener.getsockname()[1]


neighbour_port = listen(visit)
server_port = listen(lambda connection: keep_serving(connection, server_port, neighbour_port))
with open(port_file + ".new", "w") as file:
    file.write(f"{server_port} {neighbour_port}\n")
os.rename(port_file + ".new", port_file)
sys.stdin.read()
