#!/bin/bash
# Exports the demo's parts and pages as W3C Web Annotations, imports them into an empty folder and exports them again:
# the bytes are the same. A foreign file is refused with its name and the place.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/annotations
rm -rf "$work"
mkdir -p "$work/out" "$work/again"
gopura=build/gopura-content
"$gopura" annotations export demo/content --out "$work/out/demo.jsonld"
# Scenes are not exchanged; a tour leads through one of them.
! "$gopura" annotations import "$work/out/demo.jsonld" --into "$work/copy" 2>"$work/scene.log" || fail "a tour without its scene was taken"
grep -q 'scenes.json does not name "scenes/walk.wrl"' "$work/scene.log" || fail "not said what is missing: $(cat "$work/scene.log")"
[ ! -e "$work/copy" ] || fail "something was left"
mkdir "$work/copy"
cp -r demo/content/scenes.json demo/content/scenes "$work/copy/"
"$gopura" annotations import "$work/out/demo.jsonld" --into "$work/copy"
"$gopura" annotations export "$work/copy" --out "$work/again/demo.jsonld"
cmp "$work/out/demo.jsonld" "$work/again/demo.jsonld" || fail "the round trip lost something"
# Spoken texts are not exchanged.
diff -r -x "*.opus" -x "*.vtt" demo/content/pages "$work/copy/pages" || fail "pages came back changed"
diff -r "$work/out/pictures" "$work/again/pictures" || fail "pictures came back changed"
python3 - "$work/out/demo.jsonld" <<'P'
import json
import sys

collection = json.load(open(sys.argv[1]))
assert collection["total"] == len(collection["first"]["items"]) > 0
P

# Further documents come back, one of two parts once, also where a part has no page of its own.
mkdir -p "$work/documents/pages" "$work/out2" "$work/again2"
cat >"$work/documents/parts.json" <<'P'
{"parts": [
 {"id": "gate", "anchor": [1, 2, 3], "title": {"en": "Gate", "fr": "Porte"}, "documents": ["repair", "kings"]},
 {"id": "stair", "anchor": [4, 5, 6], "title": {"en": "Stair"}, "page": false, "documents": ["kings", "gate"]}]}
P
for page in gate.en gate.fr repair.fr kings.en kings.fr; do
	echo "<p>About $page</p>" >"$work/documents/pages/$page.html"
done
"$gopura" annotations export "$work/documents" --out "$work/out2/all.jsonld"
"$gopura" annotations import "$work/out2/all.jsonld" --into "$work/documents-copy"
"$gopura" annotations export "$work/documents-copy" --out "$work/again2/all.jsonld"
cmp "$work/out2/all.jsonld" "$work/again2/all.jsonld" || fail "the round trip lost a document"
diff -r "$work/documents/pages" "$work/documents-copy/pages" || fail "documents came back changed"
sed '0,/About kings.en/s//Other/' "$work/out2/all.jsonld" >"$work/out2/two.jsonld"
! "$gopura" annotations import "$work/out2/two.jsonld" --into "$work/two" 2>"$work/two.log" ||
	fail "a document with two texts was taken"
grep -q 'two.jsonld:.*two texts for pages/kings.en.html' "$work/two.log" || fail "not said which: $(cat "$work/two.log")"

cat >"$work/foreign.jsonld" <<'P'
{"type": "AnnotationPage", "items": [
 {"id": "https://example.org/1", "type": "Annotation", "bodyValue": "a note",
  "target": {"source": "https://example.org/photo.jpg", "selector": {"type": "SvgSelector"}}}]}
P
! "$gopura" annotations import "$work/foreign.jsonld" --into "$work/foreign" 2>"$work/foreign.log" ||
	fail "an annotation of a photograph was taken"
grep -q 'foreign.jsonld:2: .*SvgSelector.*PointSelector' "$work/foreign.log" ||
	fail "not said what and where: $(cat "$work/foreign.log")"
[ ! -e "$work/foreign" ] || fail "something was left"
"$gopura" annotations import "$work/foreign.jsonld" --into "$work/foreign" --skip-unknown ||
	fail "cannot be left out"

# A manifest has the shape of those that others publish: no member that theirs lack, and each of the same type.
mkdir -p "$work/temple"
printf '[model]\nscans = a.glb b.glb\n' >"$work/temple/temple.ini"
touch "$work/temple/a.glb" "$work/temple/b.glb"
cat >"$work/temple/parts.json" <<'P'
{"parts": [{"id": "eye", "anchor": [1, 2, 3], "page": false, "title": {"en": "Eye", "es": "Ojo"},
 "caption": {"en": "It looks east."}, "documents": ["paint"]}]}
P
mkdir -p "$work/temple/pages"
echo '<p>It was painted.</p>' >"$work/temple/pages/paint.en.html"
"$gopura" annotations export "$work/temple" --iiif --base https://example.org/t --out "$work/temple/scene.json"
"$gopura" annotations import "$work/temple/scene.json" --into "$work/iiif"
grep -q '"It looks east."' "$work/iiif/parts.json" || fail "the caption did not come back"
grep -q 'It was painted.' "$work/iiif/pages/eye.en.html" || fail "the document did not come back as text of the page"
theirs=../shared/conformance/iiif3d/manifests
if [ -d "$theirs" ]; then
	python3 - "$work/temple/scene.json" "$theirs" <<'P'
import json
import pathlib
import sys


def shape(value, path, into):
    """Adds (path, type) of every value; lists add nothing to a path, nor do the languages of texts."""
    into.add((path, type(value).__name__ if not isinstance(value, (int, float)) else "number"))
    if isinstance(value, dict):
        for key, inner in value.items():
            is_text = path.endswith("/label")
            shape(inner, path + "/" + ("LANGUAGE" if is_text else key), into)
    elif isinstance(value, list):
        for inner in value:
            shape(inner, path, into)
    return into


ours = shape(json.load(open(sys.argv[1])), "", set())
theirs = set()
for name in pathlib.Path(sys.argv[2]).glob("*/*.json"):
    text = name.read_text()
    if text:
        shape(json.loads(text), "", theirs)
assert len(ours) > 30 and len(theirs) > 30, (len(ours), len(theirs))
assert ours <= theirs, sorted(ours - theirs)
P
	commented=0
	for manifest in $(grep -l '"commenting"' "$theirs"/*/*.json); do
		"$gopura" annotations import "$manifest" --into "$work/theirs-$commented" || fail "$manifest was refused"
		commented=$((commented + 1))
	done
	[ "$commented" = 6 ] || fail "$commented manifests with comments, not the 6 of docs/iiif.md"
else
	echo "$theirs is not here: its manifests are not read, and the shape of ours is not compared"
fi
