"""A use of gopura-health: the socket is passed as systemd does, its pages are asked for, and it ends when idle.

    tests/e2e/torture_health.py FOLDER PROGRAM OPTIONS...

Where a request fails, or the program ends, the next request (to a program that is started again, as systemd does) must
be answered right. Exit 0: all were right at last. 1: not. What the program says goes to FOLDER/health.log."""

import http.client
import os
import socket
import sys
import time

folder, command = sys.argv[1], [*sys.argv[2:], "--idle-s", "1"]
listener = socket.create_server(("127.0.0.1", 0))
port = listener.getsockname()[1]
pid = 0
PAGES = {"/metrics": b"gopura_fetch_online ", "/": b"</main>", "/health": b"", "/visits.csv": b"day,"}


def start():
    global pid
    pid = os.fork()
    if pid == 0:
        log = os.open(f"{folder}/health.log", os.O_WRONLY | os.O_APPEND | os.O_CREAT)
        os.dup2(log, 1)
        os.dup2(log, 2)
        os.dup2(listener.fileno(), 3)
        os.set_inheritable(3, True)
        os.execve(command[0], command, {**os.environ, "LISTEN_FDS": "1", "LISTEN_PID": str(os.getpid())})


def ended(block=False):
    """Returns None while it runs."""
    global pid
    if pid == 0:
        return None
    done, status = os.waitpid(pid, 0 if block else os.WNOHANG)
    if done == 0:
        return None
    pid = 0
    code = os.waitstatus_to_exitcode(status)
    if not 0 <= code <= 3:
        sys.exit(f"it ended with {code}")
    return code


def is_right(path):
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
    try:
        connection.request("GET", path)
        answer = connection.getresponse()
        body = answer.read()
    except TimeoutError:
        # Nobody accepts: the program has ended, or it hangs.
        if ended() is None:
            sys.exit(f"{path}: no answer within 10 s")
        return False
    except (http.client.HTTPException, OSError):
        return False
    return answer.status in (200, 503) and PAGES[path] in body and (path != "/health" or b"download" not in body)


def ask(path):
    """Twice at most until it is right."""
    for _ in range(3):
        if pid == 0:
            start()
        if is_right(path):
            return
        time.sleep(1.1)  # an answer is remembered for a second
        ended()
    sys.exit(f"{path}: it is still wrong")


for page in PAGES:
    ask(page)
if pid == 0:
    start()
if ended(block=True) != 0:
    sys.exit("it does not end well when idle")
