# For tests that build releases of tiny temples and compare them. Source it after lib.sh.

# tiny_content DIR TRIANGLES BLOCK: a content folder of a temple that is built in blocks, with a part and its page.
tiny_content() {
	mkdir -p "$1/pages"
	[ -f "$1/temple.ply" ] || build/gopura-content temple --triangles "$2" --seed 1 --out "$1/temple.ply" >/dev/null
	cat >"$1/temple.ini" <<-INI
		[model]
		name = Tiny temple
		scans = temple.ply
		colours = procedural
		[grid]
		points = 4
		face_px = 128
		[hierarchy]
		block_triangles = $3
	INI
	cat >"$1/parts.json" <<-'JSON'
		{"parts": [{"id": "tower", "region": {"kind": "sphere", "centre": [0, 0, 20], "radius": 4},
		  "anchor": [0, 0, 22], "title": {"en": "Tower"}}]}
	JSON
	echo '<h1>Tower</h1><p>The mountain in the middle.</p>' >"$1/pages/tower.en.html"
}

# What the signed files of a release say, without what depends on the time of day.
signed() { # RELEASE
	python3 - "$1" <<-'PY'
		import base64, json, pathlib, sys
		release = pathlib.Path(sys.argv[1])
		for path in [*sorted((release / "history").iterdir()), release / "release.json", release / "timestamp.json"]:
		    payload = json.loads(base64.b64decode(json.loads(path.read_text())["payload"]))
		    for name in ("expires_s", "issued_s", *(["release"] if path.stem == "timestamp" else [])):
		        payload.pop(name, None)
		    print(path.relative_to(release), json.dumps(payload, sort_keys=True))
	PY
}

# same_release A B: the same files, and all of them equal byte for byte; of the signed ones, what they say.
same_release() {
	diff -rq -x history -x release.json -x timestamp.json "$1" "$2" &&
		diff <(cd "$1" && find . | sort) <(cd "$2" && find . | sort) && diff <(signed "$1") <(signed "$2")
}
