"""A use of gopura-curator: it starts, ana signs in, opens a page, saves a changed page and a changed text; it ends.

    tests/e2e/torture_curator.py FOLDER PROGRAM CONTENT

Where a request fails, or the program ends, its files are the old or the new ones, and the next try works (of a program
that is started again, if it ended). Exit 0: all was saved at last. 1: not. What the program says goes to
FOLDER/curator.log."""

import http.client
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

from curator_http import Client

folder, program, content = sys.argv[1:]
page_file, parts_file = pathlib.Path(content, "pages/tower.en.html"), pathlib.Path(content, "parts.json")
log = pathlib.Path(folder, "curator.log")
process = client = None


def wrong(what):
    if process and process.poll() is None:
        process.kill()
    sys.exit(what)


def check_end(code):
    if not 0 <= code <= 3:
        wrong(f"it ended with {code}")


def start():
    """Returns whether it runs and ana is signed in."""
    global process, client
    if process and process.poll() is None and client:
        return True
    if not process or process.poll() is not None:
        if process:
            check_end(process.returncode)
        with open(log, "ab") as out:
            told = out.tell()
            process = subprocess.Popen([program, content, "--port", "0"], stdout=out, stderr=out)
        until = time.monotonic() + 20
        while not (match := re.search(rb"(?:http://127.0.0.1:|printed: .* port )(\d+)", log.read_bytes()[told:])):
            if process.poll() is not None:
                return False
            if time.monotonic() > until:
                wrong("it does not start within 20 s")
            time.sleep(0.01)
        start.port = int(match[1])
    client = Client(start.port)
    client.connection.timeout = 20
    status, answer, _ = client.sign_in("ana")
    if status != 200:
        client = None
    return status == 200


def save_page(html):
    status, _, answer = client.ask("GET", "/api/pages/tower.en")
    if status != 200:
        return False
    if html in answer["html"]:
        return True
    status, _, answer = client.ask("PUT", "/api/pages/tower.en", json.dumps({"html": html}),
                                   If_Match=f'"{answer["tag"]}"')
    return status == 200


def save_title(title):
    status, _, answer = client.ask("GET", "/api/information")
    if status != 200:
        return False
    old = next(part for part in answer["parts"] if part["id"] == "tower")["title"]["en"]
    if old == title:
        return True
    change = {"field": "title", "language": "en", "from": old, "to": title}
    return client.ask("POST", "/api/parts/tower/texts", json.dumps({"changes": [change]}))[0] == 200


def has_versions(what):
    status, _, answer = client.ask("GET", f"/api/versions?document={what}")
    return status == 200


def attempt(do, *values):
    global client
    try:
        return start() and do(*values)
    except TimeoutError:
        wrong(f"no answer within 20 s: {do.__name__}")
    except (OSError, http.client.HTTPException, AttributeError) as error:
        client = None
        return False


def whole(texts):
    """The files are one of the texts that were there or are saved."""
    page, parts = page_file.read_text(), json.loads(parts_file.read_text())
    if not any(text in page for text in texts["page"]) or not page.rstrip().endswith(("</p>", "</html>")):
        wrong(f"the page is {page!r}")
    if parts["parts"][0]["title"]["en"] not in texts["title"]:
        wrong(f"the parts are {parts}")


def insist(do, value, texts):
    for _ in range(3):
        done = attempt(do, value)
        whole(texts)
        if done:
            if do is save_page and value not in page_file.read_text():
                wrong("it said that the page was saved")
            return
    wrong(f"{do.__name__} does not work again")


texts = {"page": ["The mountain in the middle.", "Number 1.", "Number 2."], "title": ["Tower", "Another"]}
insist(save_page, "<p>Number 1.</p>", texts)
insist(save_title, "Another", texts)
insist(save_page, "<p>Number 2.</p>", texts)
insist(has_versions, "pages/tower.en.html", texts)
process.send_signal(signal.SIGTERM)
try:
    code = process.wait(20)
except subprocess.TimeoutExpired:
    wrong("it does not end")
if code != 0:
    wrong(f"it ended with {code}")
