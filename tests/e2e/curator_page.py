"""A curator in a real browser: signs in with the keyboard, looks, publishes what has changed, goes back to the first
release, and signs out. Pictures of each state are kept.

    tests/e2e/curator_page.py PORT FOR_PICTURES NAME

The password is "password of NAME", a publisher's. Needs chromium."""

import os
import sys

from chromium import Chromium

SIZES = ((1280, 800), (1024, 768))


def shots(page, folder, state):
    for scheme in ("dark", "light"):
        for width, height in SIZES:
            page.show(width, height, scheme)
            page.run("new Promise(done => setTimeout(done, 300))")
            page.wait("!document.getElementById('quality') || document.getElementById('quality').hidden")
            wide = page.run("document.documentElement.scrollWidth")
            assert wide <= width, f"{state}: {wide} px on {width}"
            page.shot(f"{folder}/{state}-{scheme}-{width}.png")
    page.show(*SIZES[0])


def sign_in(page, address, name, folder):
    page.open(address)
    page.wait("document.activeElement && document.activeElement.id === 'name'")
    assert page.run("location.pathname") == "/sign-in"
    shots(page, folder, "sign-in")
    page.complaints.clear()
    page.type(name)
    page.press("Tab")
    page.type("a wrong password")
    page.press("Enter", "\r")
    page.wait("document.getElementById('message').textContent.includes('wrong')")
    shots(page, folder, "sign-in-wrong")
    page.complaints.clear()  # that the program answered 401
    page.run("document.getElementById('password').select()")
    page.type(f"password of {name}")
    page.press("Enter", "\r")
    page.wait("location.pathname === '/' && document.getElementById('who')?.textContent")


def change_title(page, title):
    """As somebody else would, beside what the page shows."""
    page.run(f"""(async () => {{
      const {{ token }} = await (await fetch("/api/session")).json(), [part] = (await (await fetch("/api/information")).json()).parts;
      const changes = [{{ field: "title", language: "en", from: part.title.en, to: {title!r} }}];
      return (await fetch(`/api/parts/${{part.id}}/texts`, {{ method: "POST", headers: {{ "Content-Type": "application/json", "X-Gopura-Token": token }}, body: JSON.stringify({{ changes }}) }})).status;
    }})()""")


def check_publish(page, folder):
    """The panel by keyboard: it compares, publishes, goes back, and closes by Escape."""
    page.run("document.getElementById('open-publish').focus()")
    page.press("Enter", "\r")
    page.wait("document.getElementById('publish').open")
    page.wait("!document.getElementById('publish-now').disabled")
    shots(page, folder, "publish")
    page.run("document.getElementById('publish-comment').focus()")
    page.type("what is new")
    change_title(page, "Changed meanwhile")
    page.press("Enter", "\r")
    page.wait("document.getElementById('publish-problem').textContent.includes('look at them again')")
    page.wait("document.getElementById('changes').textContent.includes('Changed meanwhile')")
    page.complaints.clear()  # that the program answered 409
    assert page.run("!document.getElementById('publish-now').disabled"), "it publishes"
    assert page.run("document.getElementById('publish-comment').value") == "what is new"
    page.press("Enter", "\r")
    page.wait("document.getElementById('publish-state').className.includes('good')", 120)
    page.wait("document.getElementById('changes').textContent.includes('Nothing has changed')")
    assert "what is new" in page.run("document.querySelector('.release.current').textContent")
    newest = page.run("document.querySelector('.release').textContent")
    page.run("document.querySelector('.release:last-child button').focus()")
    page.press("Enter", "\r")
    page.wait("document.getElementById('back').open")
    shots(page, folder, "back")
    page.press("Tab")
    page.press("Enter", "\r")
    page.wait(f"!document.querySelector('.release').textContent.includes({newest!r})", 120)
    page.wait("document.getElementById('publish-state').className.includes('good')", 120)
    shots(page, folder, "published")
    page.press("Escape")
    page.wait("!document.getElementById('publish').open")
    assert page.run("document.activeElement.id") == "open-publish"


def main(port, folder, name):
    os.makedirs(folder, exist_ok=True)
    page = Chromium(f"{folder}/profile")
    try:
        page.show(*SIZES[0])
        sign_in(page, f"http://127.0.0.1:{port}/", name, folder)
        assert page.run("document.getElementById('who').textContent") == name
        page.wait("document.getElementById('connection').textContent === 'Connected'")
        page.wait("document.getElementById('quality').hidden")
        shots(page, folder, "page")
        check_publish(page, folder)
        page.run("document.getElementById('sign-out').click()")
        page.wait("location.pathname === '/sign-in'")
        assert not page.complaints, page.complaints
    finally:
        page.close()
    print(f"the page is as promised; pictures are in {folder}")


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], sys.argv[3])
