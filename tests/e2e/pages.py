"""Curators write over HTTP: texts, pages, pictures, and what becomes of them when two do so at once, or the program is
killed.

    tests/e2e/pages.py PORT check CONTENT  # as curators; changes a file of the folder, too
    tests/e2e/pages.py PORT save COUNTER   # saves one page again and again, and notes what was acknowledged in a file

The content is that of the small temple, with the accounts rolf, ana and petra. Standard library only."""

import json
import struct
import sys
import zlib

from curator_http import Client, signed_in

PAGE = "/api/pages/lions.en"


def save(client, path, html, tag):
    headers = {"If_Match": f'"{tag}"'} if tag else {"If_None_Match": "*"}
    return client.ask("PUT", path, json.dumps({"html": html}), **headers)


def page(client, path=PAGE):
    status, _, answer = client.ask("GET", path)
    assert status == 200, answer
    return answer["html"], answer["tag"]


def post(client, path, **body):
    status, _, answer = client.ask("POST", path, json.dumps(body))
    return status, answer


def change(client, part, **fields):
    return post(client, f"/api/parts/{part}/texts", changes=[fields])


def part_of(client, name):
    _, _, information = client.ask("GET", "/api/information")
    return next((part for part in information["parts"] if part["id"] == name), None)


def check_information(client):
    status, headers, information = client.ask("GET", "/api/information")
    assert status == 200 and "en" in information["languages"] and not [p for p in information["problems"] if p["error"]]
    assert "pictures/lions.jpg" in information["pictures"]
    assert next(p for p in information["parts"] if p["id"] == "lions")["pages"]["en"]
    assert client.ask("GET", "/api/information", If_None_Match=headers["etag"])[0] == 304


def check_texts(ana, petra):
    old = part_of(ana, "lions")["caption"]["en"]
    assert change(ana, "lions", field="caption", language="en", **{"from": old}, to="By Ana.")[0] == 200
    status, answer = change(petra, "lions", field="caption", language="en", **{"from": old}, to="By Petra.")
    assert status == 409 and answer["theirs"] == "By Ana."
    assert change(petra, "lions", field="caption", language="en", **{"from": "By Ana."}, to="By both.")[0] == 200
    assert part_of(ana, "lions")["caption"]["en"] == "By both."
    assert change(ana, "lions", field="creator", language="", **{"from": ""}, to="Ana\nPetra")[0] == 200
    assert part_of(ana, "lions")["credits"]["creator"] == ["Ana", "Petra"]
    title = part_of(ana, "lions")["title"]["en"]
    status, answer = change(ana, "lions", field="title", language="en", **{"from": title}, to="")
    assert status == 422 and "title" in answer["problems"][0]["text"], answer
    assert change(ana, "lions", field="thumbnail", language="", **{"from": "pictures/lions.jpg"}, to="../x")[0] == 422
    assert change(ana, "lions", field="region", language="", **{"from": ""}, to="x")[0] == 422
    assert change(ana, "nobody", field="title", language="en", **{"from": ""}, to="x")[0] == 404


def check_order(ana):
    order = lambda: [part["id"] for part in ana.ask("GET", "/api/information")[2]["parts"]]
    first, second = order()[:2]
    assert post(ana, f"/api/parts/{second}/place", before=first)[0] == 200
    assert order()[:2] == [second, first]
    assert post(ana, f"/api/parts/{second}/place", before="nobody")[0] == 404
    status, _, answer = ana.ask("DELETE", "/api/parts/central-tower")
    assert status == 422 and answer["problems"], "a part is removed to which pages link"
    assert ana.ask("DELETE", "/api/parts/spare")[0] == 200
    assert "spare" not in order() and page(ana, "/api/pages/spare.en") == ("", "")


def check_pages(ana, petra):
    html, tag = page(ana)
    for wrong in ("<p>x</p><script>alert(1)</script>", "<p onclick='x()'>y</p>", '<p><a href="http://x.example">y</a></p>',
                  '<p>x<img src="//x.example/y.png"></p>', "", '<p><a href="page:nobody">x</a></p>'):
        status, _, answer = save(ana, PAGE, wrong, tag)
        assert status == 422 and answer["problems"][0]["file"] == "pages/lions.en.html", (wrong, answer)
    assert page(ana) == (html, tag)
    assert ana.ask("PUT", PAGE, json.dumps({"html": html}))[0] == 428
    assert ana.ask("PUT", "/api/pages/lions.xx", json.dumps({"html": html}), If_None_Match="*")[0] == 404
    # Two at once, in different paragraphs.
    status, _, answer = save(ana, PAGE, html.replace("</body>", "<p>The end, by Ana.</p>\n</body>"), tag)
    assert status == 200 and not answer["merged"] and not answer["problems"]
    status, _, answer = save(petra, PAGE, html.replace("<p>", "<p>By Petra. ", 1), tag)
    assert status == 200 and answer["merged"]
    now, merged_tag = page(ana)
    assert "by Ana" in now and "By Petra" in now and (now, merged_tag) == (answer["html"], answer["tag"])
    # Two at once, in the same one.
    assert save(ana, PAGE, now.replace("The end, by Ana", "No end, by Ana"), merged_tag)[0] == 200
    status, _, answer = save(petra, PAGE, now.replace("The end, by Ana", "The end, by both"), merged_tag)
    assert status == 409 and "No end, by Ana" in answer["html"] and "The end, by both" in answer["html"]
    assert "<<<<<<< mine" in answer["html"]
    decided = page(ana)[0].replace("No end, by Ana", "The arrived end, by both")
    status, _, saved = save(petra, PAGE, decided, answer["tag"])
    assert status == 200
    # The answer was lost, and it is sent again.
    status, _, again = save(petra, PAGE, decided, answer["tag"])
    assert status == 200 and again["tag"] == saved["tag"] and not again["merged"]


def check_bytes(ana, content):
    """A page that is not UTF-8 is not shown as something else, which would then be saved."""
    with open(f"{content}/pages/lions.ja.html", "rb") as file:
        before = file.read()
    for wrong in ("<p>Été</p>".encode("latin-1"), "<p>x</p>".encode("utf-16")):
        with open(f"{content}/pages/lions.ja.html", "wb") as file:
            file.write(wrong)
        status, _, answer = ana.ask("GET", "/api/pages/lions.ja")
        assert status == 422 and "pages/lions.ja.html is not UTF-8" in answer["message"] and answer["html"] == ""
        version = ana.ask("GET", "/api/versions?document=pages/lions.ja.html")[2]["versions"][1]["version"]
        assert post(ana, "/api/restore", document="pages/lions.ja.html", version=version, tag=answer["tag"])[0] == 200
        with open(f"{content}/pages/lions.ja.html", "rb") as file:
            assert file.read() == before


def check_tours(ana, petra):
    """The second one who saves gets what the first one saved, and nothing is overwritten."""
    put = lambda client, tours, **headers: client.ask("PUT", "/api/tours", json.dumps({"tours": tours}), **headers)
    read = lambda: ana.ask("GET", "/api/tours")[2]
    first = read()
    of = lambda who: [{**first["tours"][0], "title": {"en": f"By {who}"}}, *first["tours"][1:]]
    assert put(ana, of("Ana"))[0] == 428
    status, _, answer = put(ana, of("Ana"), If_Match=f'"{first["tag"]}"')
    assert status == 200 and answer == {"tag": read()["tag"]}, answer
    for headers in ({"If_Match": f'"{first["tag"]}"'}, {"If_None_Match": "*"}):
        status, _, answer = put(petra, of("Petra"), **headers)
        assert status == 409 and answer["tours"] == of("Ana") and answer["tag"] == read()["tag"], answer
    versions = ana.ask("GET", "/api/versions?document=tours.json")[2]["versions"]
    assert post(petra, "/api/restore", document="tours.json", version=versions[-1]["version"], tag=first["tag"])[0] == 412
    assert read()["tours"] == of("Ana")
    assert put(petra, of("Petra"), If_Match=f'"{answer["tag"]}"')[0] == 200
    status, _, answer = put(petra, [{"id": "one", "stops": []}], If_Match=f'"{read()["tag"]}"')
    assert status == 422 and answer["problems"] and read()["tours"] == of("Petra")
    assert post(petra, "/api/restore", document="tours.json", version=versions[-1]["version"], tag=read()["tag"])[0] == 200
    assert read()["tours"] == first["tours"]


def check_history(ana):
    document = "pages/lions.en.html"
    versions = ana.ask("GET", f"/api/versions?document={document}")[2]["versions"]
    assert [v["author"] for v in versions] == ["petra", "ana", "petra", "ana", ""], versions
    oldest = versions[-1]["version"]
    lines = ana.ask("GET", f"/api/difference?document={document}&from={oldest}")[2]["lines"].split("\n")
    assert any(line.startswith("+") and "arrived" in line for line in lines)
    old = ana.ask("GET", f"/api/version?document={document}&version={oldest}")[2]["text"]
    status, answer = post(ana, "/api/restore", document=document, version=oldest, tag=page(ana)[1])
    assert status == 200 and page(ana) == (old, answer["tag"])
    assert post(ana, "/api/restore", document=document, version=versions[0]["version"], tag=page(ana)[1])[0] == 200
    assert ana.ask("GET", f"/api/version?document={document}&version={'0' * 40}")[0] == 404
    for name in ("temple.ini", "../x", ".curator/accounts.json", "/etc/passwd", ""):
        assert ana.ask("GET", f"/api/version?document={name}&version=")[0] in (404, 422), name
        assert post(ana, "/api/restore", document=name, version=oldest)[0] in (404, 422), name


def png(width, height, pixel):
    row = b"\0" + bytes(pixel) * width
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(row * height)) + chunk(b"IEND", b"")


def check_pictures(ana):
    send = lambda name, data: ana.ask("POST", f"/api/pictures?name={name}", data, Content_Type="application/octet-stream")
    status, _, answer = send("My%20Gate%20(1).PNG", png(40, 30, (200, 100, 50)))
    assert (status, answer) == (200, {"name": "pictures/my-gate-1.png"}), answer
    assert send("my-gate-1.png", png(40, 30, (200, 100, 50)))[2]["name"] == "pictures/my-gate-1.png"
    assert send("my-gate-1.png", png(40, 30, (0, 0, 0)))[2]["name"] == "pictures/my-gate-1-2.png"
    status, headers, data = ana.ask("GET", "/api/picture?name=pictures/my-gate-1.png")
    assert status == 200 and headers["content-type"] == "image/png" and data[:4] == b"\x89PNG"
    assert send("..%2f..%2fetc%2fx.png", png(4, 4, (1, 2, 3)))[2]["name"] == "pictures/etc-x.png"
    for wrong in (b"", b"GIF89a", b"<svg/>", png(40, 30, (9, 9, 9))[:-30]):
        assert send("x.png", wrong)[0] in (400, 422), wrong
    assert ana.ask("GET", "/api/picture?name=temple.ini")[0] == 404
    assert ana.ask("GET", "/api/picture?name=pictures/../temple.ini")[0] == 422
    html, tag = page(ana)
    figure = '<figure><img src="pictures/my-gate-1.png" alt="A gate"><figcaption>A gate</figcaption></figure>'
    assert save(ana, PAGE, html.replace("</body>", figure + "\n</body>"), tag)[0] == 200


def check_spoken(ana):
    """A recording and its words; what a terminal would not play is refused with the remedy."""
    opus = open("demo/content/pages/central-tower.en.opus", "rb").read()
    ask = lambda method, kind, data, tag="", name="lions.en": ana.ask(method, f"/api/{kind}/{name}", data, Content_Type="application/octet-stream",
        **({"If_Match": f'"{tag}"'} if tag else {"If_None_Match": "*"}))
    told = ask("PUT", "spoken", opus[:-2000])
    assert told[0] == 422 and "opusenc" in told[2]["message"], told
    for wrong in (b"", b"no sound", png(4, 4, (1, 2, 3)), opus.replace(b"OpusHead", b"OpusHeap")):
        assert ask("PUT", "spoken", wrong)[0] == 422
    assert ask("PUT", "spoken", opus, name="lions.xx")[0] == 404
    assert ana.ask("GET", "/api/spoken/lions.en")[0] == 404
    status, _, answer = ask("PUT", "spoken", opus)
    assert status == 200, answer
    assert ask("PUT", "spoken", opus[:-1])[0] == 422
    assert ask("PUT", "spoken", opus)[0] == 412, "over another recording"
    status, headers, data = ana.ask("GET", "/api/spoken/lions.en")
    assert (status, headers["content-type"], data[-1000:]) == (200, "audio/ogg", opus[-1000:])
    assert b"OpusTags" + bytes(8) in data and b"OpusTags" + bytes(8) not in opus, "what the file says of itself is left out"
    assert ask("PUT", "words", b"00:00.000 --> 00:02.000\nNo head")[0] == 422
    late = ask("PUT", "words", b"WEBVTT\n\n05:00.000 --> 05:02.000\nToo late\n")
    assert late[0] == 422 and "another recording" in late[2]["message"], late
    assert ask("PUT", "words", b"WEBVTT\n\n00:00.000 --> 00:02.000\nLions\n")[0] == 200
    part = part_of(ana, "lions")
    assert part["spoken"] == {"en": answer["tag"]} and list(part["words"]) == ["en"], part
    assert ask("DELETE", "spoken", None, answer["tag"])[0] == 200
    part = part_of(ana, "lions")
    assert part["spoken"] == part["words"] == {}, "the words go with their recording"
    assert ask("PUT", "spoken", opus)[0] == 200
    versions = ana.ask("GET", "/api/versions?document=pages/lions.en.opus")[2]["versions"]
    assert [(v["what"], v["removed"]) for v in versions] == [("recording of lions in en", False), ("recording of lions in en, removed", True), ("recording of lions in en", False)]


def check_fields(ana):
    """Each text of a card has a history of its own, and goes back by itself."""
    rows = lambda: [row for row in ana.ask("GET", "/api/parts/lions/history")[2]["changes"] if (row["field"], row["language"]) == ("caption", "en")]
    first = part_of(ana, "lions")["caption"]["en"]
    for before, after in ((first, "One."), ("One.", "Two.")):
        assert change(ana, "lions", field="caption", language="en", **{"from": before}, to=after)[0] == 200
    assert change(ana, "lions", field="title", language="km", **{"from": part_of(ana, "lions")["title"]["km"]}, to="Another title")[0] == 200
    assert [(row["from"], row["to"], row["author"]) for row in rows()[:2]] == [("One.", "Two.", "ana"), (first, "One.", "ana")]
    assert rows()[-1]["from"] == "" and rows()[-1]["author"] == "", "the text that was there at first"
    assert change(ana, "lions", field="caption", language="en", **{"from": "Two."}, to=rows()[1]["from"])[0] == 200
    part = part_of(ana, "lions")
    assert part["caption"]["en"] == first and part["title"]["km"] == "Another title"
    assert ana.ask("GET", "/api/parts/nobody/history")[2] == {"changes": []}


def check_preview(ana):
    ask = lambda **body: ana.ask("POST", "/api/preview", json.dumps(body))
    pictures = []
    for kind in ("near", "card", "page"):
        status, headers, picture = ask(part="lions", language="en", kind=kind)
        assert status == 200 and headers["content-type"] == "image/jpeg" and picture[:2] == b"\xff\xd8"
        pictures.append(picture)
    assert len(set(pictures)) == 3
    assert ask(part="lions", language="en", kind="page")[2] == pictures[2]
    assert ask(part="lions", language="en", kind="page", html="<p>Other words.</p>")[2] != pictures[2]
    assert ask(part="lions", language="km", kind="card")[2] != pictures[1]
    assert ask(part="lions", language="en", kind="page", html="<script>x</script>")[0] == 422
    assert ask(part="nobody", language="en", kind="card")[0] == 404
    assert ask(part="lions", language="en", kind="other")[0] == 400
    assert ask(part="lions", language="zz", kind="card")[0] == 200  # as a terminal: in the nearest language


def check_roles(rolf):
    html, tag = page(rolf)
    assert save(rolf, PAGE, html, tag)[0] == 403
    assert change(rolf, "lions", field="title", language="en", **{"from": ""}, to="x")[0] == 403
    assert rolf.ask("DELETE", "/api/parts/lions")[0] == 403
    assert rolf.ask("POST", "/api/pictures?name=x", png(4, 4, (1, 2, 3)))[0] == 403
    assert rolf.ask("PUT", "/api/spoken/lions.fr", b"x", If_None_Match="*")[0] == 403


def keep_saving(port, counter):
    ana = signed_in(port, "ana")
    html, tag = page(ana)
    for n in range(100000):
        text = html.replace("</body>", f"<p>Number {n}.</p>\n</body>")
        status, _, answer = save(ana, PAGE, text, tag)
        assert status == 200, answer
        tag = answer["tag"]
        with open(counter, "w") as file:
            file.write(str(n))


def main():
    port = int(sys.argv[1])
    if sys.argv[2] == "save":
        keep_saving(port, sys.argv[3])
        return
    assert Client(port).ask("GET", "/api/information")[0] == 401
    ana, petra, rolf = (signed_in(port, name) for name in ("ana", "petra", "rolf"))
    check_information(ana)
    check_texts(ana, petra)
    check_order(ana)
    check_pages(ana, petra)
    check_bytes(ana, sys.argv[3])
    check_tours(ana, petra)
    check_history(ana)
    check_pictures(ana)
    check_spoken(ana)
    check_fields(ana)
    check_preview(ana)
    check_roles(rolf)


if __name__ == "__main__":
    main()
