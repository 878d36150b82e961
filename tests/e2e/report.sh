#!/bin/bash
# What a person reads of a build: the estimate before it, and the report after it, which must be one
# well-formed page without anything from outside that names the counts of the stages.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/report
content=$work/content
rm -rf "$work"
mkdir -p "$content/pages"
build/gopura-content temple --triangles 20000 --out "$content/temple.ply" >/dev/null
cat >"$content/temple.ini" <<'INI'
[model]
name = Towers & <walls>
scans = temple.ply
[grid]
points = 4
face_px = 256
[release]
publish_share = 0.3
INI
cat >"$content/parts.json" <<'JSON'
{"parts": [{"id": "all", "region": {"kind": "sphere", "centre": [0, 0, 5], "radius": 60},
            "anchor": [0, 0, 20], "title": {"en": "The whole temple"}, "page": false}]}
JSON

# ---- before: nothing is built, and the counts are those of the scan
build/gopura-content build "$content" --dry-run >"$work/before.txt"
[ ! -e "$content/.work/mesh" ] && [ ! -e "$content/.work/samples" ] && [ ! -e "$work/keys" ] || fail "a dry run built something"
triangles=$(sed -n 's/^element face //p;/^end_header/q' <(head -c 2000 "$content/temple.ply" | tr -d '\0'))
grep -q "^$triangles triangles; " "$work/before.txt" || { cat "$work/before.txt"; fail "not the scan's $triangles triangles"; }
for stage in import hierarchy samples publishing all; do
	grep -q "^$stage .* s .*MB" "$work/before.txt" || { cat "$work/before.txt"; fail "no line of $stage"; }
done

# ---- a fault ends it as it would end a build
mv "$content/parts.json" "$work/parts.json"
echo '{"parts": [' >"$content/parts.json"
! build/gopura-content build "$content" --dry-run >/dev/null 2>"$work/fault.txt" || fail "a fault of parts.json was not found"
grep -q 'parts.json' "$work/fault.txt" || fail "the fault is not named"
mv "$work/parts.json" "$content/parts.json"

# ---- the build, and its page
build/gopura-content build "$content" --out "$work/release" --keys "$work/keys" >"$work/build.txt" 2>&1 || { cat "$work/build.txt"; fail "it was not built"; }
page=$content/.work/report.html
grep -q "^report for people: $page" "$work/build.txt" || { cat "$work/build.txt"; fail "the build does not name its report"; }
[ -z "$(find "$work/release" -name '*.html')" ] || fail "the report is in the release"
build/gopura-content import "$content/temple.ply" >"$work/import.txt"
python3 - "$page" "$work" "$triangles" <<'P' || fail "the report"
import html.parser
import re
import sys

page, work, triangles = sys.argv[1], sys.argv[2], int(sys.argv[3])
text = open(page, encoding="utf-8").read()
void = {"meta", "img", "path", "circle"}


class Reader(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.open, self.words, self.tags = [], [], []

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        for name, value in attributes:
            if name in ("src", "href"):
                assert value.startswith("data:"), f"{tag} loads {value[:60]}"
        if tag not in void:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.tags.append(tag)

    def handle_endtag(self, tag):
        assert self.open and self.open[-1] == tag, f"</{tag}> ends {self.open[-3:]}"
        self.open.pop()

    def handle_data(self, data):
        if not self.open or self.open[-1] != "style":
            self.words.append(data)


reader = Reader()
reader.feed(text)
reader.close()
assert not reader.open, f"never ended: {reader.open}"
assert "script" not in reader.tags and "link" not in reader.tags
for url in re.findall(r"url\(([^)]{0,20})", text):
    assert url.startswith("data:image/"), url
words = re.sub(r"\s+", " ", " ".join(reader.words).replace("\u202f", ""))
assert "Towers & <walls>" in words, "the name is not escaped as it should be"
assert f"{triangles} triangles in the scan" in words, words[:400]
published = re.search(r"^published (\d+) of the scan's", open(f"{work}/build.txt").read(), re.M)[1]
assert f"{published} triangles published" in words, published
names = {"border edge": "Border edges", "edges of three": "Edges of three faces or more"}
for line in open(f"{work}/import.txt"):
    for said, name in names.items():
        if said in line:
            assert re.search(name + r"[^0-9]*" + line.split()[0] + r"\b", words), line
points = re.search(r"; (\d+) sampling points", open(f"{work}/before.txt").read())[1]
assert f"{points} sampling points" in words, points
states = [int(n) for n in re.search(r"(\d+) points rendered (\d+) see nothing (\d+) inside solid "
                                    r"matter (\d+) below the ground", words).groups()]
assert sum(states) == int(points), states
assert text.count("<g><title>point ") == int(points) - 1, "not every point of the grid is drawn"
assert re.search(r"The first view has a sampling point of its own: [1-6] faces, ", words), words
assert words.count("The whole temple") >= 1, "no place is named by its part"
for stage in ("import and hierarchy", "samples", "publishing"):
    assert stage in words, stage
assert text.count("data:image/jpeg;base64,") == 3 and "data:image/webp;base64," in text
P

# ---- after: what is done is known
build/gopura-content build "$content" --dry-run >"$work/after.txt"
for stage in import hierarchy samples; do
	grep -q "^$stage .*is done" "$work/after.txt" || { cat "$work/after.txt"; fail "$stage is done"; }
done
before=$(sha256sum <"$page")
build/gopura-content build "$content" --out "$work/release" --keys "$work/keys" >"$work/again.txt" 2>&1
grep -q '^nothing changed' "$work/again.txt" && [ "$before" = "$(sha256sum <"$page")" ] || fail "the report of a release that did not change was written again"
echo "ok"
