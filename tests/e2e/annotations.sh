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
"$gopura" annotations import "$work/out/demo.jsonld" --into "$work/copy"
"$gopura" annotations export "$work/copy" --out "$work/again/demo.jsonld"
cmp "$work/out/demo.jsonld" "$work/again/demo.jsonld" || fail "the round trip lost something"
diff -r demo/content/pages "$work/copy/pages" || fail "pages came back changed"
diff -r "$work/out/pictures" "$work/again/pictures" || fail "pictures came back changed"
python3 - "$work/out/demo.jsonld" <<'P'
import json
import sys

collection = json.load(open(sys.argv[1]))
assert collection["total"] == len(collection["first"]["items"]) > 0
P

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
