#!/bin/bash
# A curator at work: a browser of our own (curator.py) turns the small temple, marks parts with every tool, undoes, saves
# and opens them; wrong messages and strange pages are refused; then gopura-content takes the folder.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/curator
rm -rf "$work"
mkdir -p "$work"
small_release
cp -a "$small/content" "$work/content" # with the times of its scan, so the hierarchy is still its own
curator=
trap '[ -z "$curator" ] || kill $curator 2>/dev/null || true' EXIT

# ---- what cannot be served is told with its remedy
mkdir "$work/none"
! build/gopura-curator "$work/none" 2>"$work/log" || fail "it serves a folder without temple.ini"
grep -q 'temple.ini' "$work/log" || fail "without temple.ini: $(cat "$work/log")"
mkdir "$work/fresh"
cp "$work/content/"{temple.ini,scan.ply} "$work/fresh"
! build/gopura-curator "$work/fresh" 2>"$work/log" || fail "it serves a folder without a hierarchy"
grep -q "gopura-content hierarchy $work/fresh" "$work/log" || fail "without a hierarchy: $(cat "$work/log")"
status=0
build/gopura-curator --port 99999 "$work/content" 2>/dev/null || status=$?
[ "$status" = 2 ] || fail "a wrong port ends with $status"

# ---- accounts, whose passwords the tests know
status=0
build/gopura-curator "$work/content" --port 0 2>"$work/log" || status=$?
[ "$status" = 1 ] || fail "without accounts it ends with $status"
grep -q "gopura-curator user add $work/content NAME" "$work/log" || fail "without accounts: $(cat "$work/log")"
user() { build/gopura-curator user "$@" >"$work/log" 2>&1; }
for one in ana:editor rolf:reader petra:publisher; do
	echo "password of ${one%:*}" | user add "$work/content" "${one%:*}" --role "${one#*:}" || fail "$one: $(cat "$work/log")"
done
[ "$(stat -c %a "$work/content/.curator/accounts.json")" = 600 ] || fail "others may read the accounts"
! grep -q 'password of' "$work/content/.curator/accounts.json" || fail "a password is kept as it is"
! echo 'password of ana' | user add "$work/content" ana || fail "an account is made twice"
! echo 'too short' | user add "$work/content" otto || fail "a short password is taken"
! echo 'long enough, but' | user add "$work/content" 'a b' || fail "a name with a space is taken"
! user remove "$work/content" otto || fail "it removes whom it does not know"
user list "$work/content" && grep -q '^editor  *ana$' "$work/log" || fail "the list: $(cat "$work/log")"

# What a browser loads before the first picture: a page, its styles, and its scripts with all that they import.
python3 - <<-'PY' || fail "a page is too large"
	import pathlib, re, sys
	web, page_bytes = pathlib.Path("curator/web"), {}
	for page in web.glob("*.html"):
	    files, todo = {page.name}, [page.name]
	    while todo:
	        for name in re.findall(r'(?:href="|src="|from "\./)([a-z_]+\.(?:css|js))"', (web / todo.pop()).read_text()):
	            if name not in files:
	                files.add(name), todo.append(name)
	    page_bytes[page.name] = sum((web / name).stat().st_size for name in files)
	print(page_bytes)
	sys.exit(max(page_bytes.values()) >= 150 * 1024 or min(page_bytes.values()) < 4096)
PY

# ---- a session
build/gopura-curator "$work/content" --port 0 >"$work/curator.log" 2>&1 &
curator=$!
wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
port=$(sed -nE 's|.*http://127.0.0.1:([0-9]+)/.*|\1|p' "$work/curator.log")
python3 tests/e2e/curator_http.py "$port" "$work/content" || { tail "$work/curator.log"; fail "its answers over HTTP"; }
python3 tests/e2e/curator.py "$port" "$work/content" check || { tail "$work/curator.log"; fail "the session"; }
kill "$curator"
wait "$curator" || { tail "$work/curator.log"; fail "it did not end well"; }
curator=

# ---- on a network it warns, and answers to that address
build/gopura-curator "$work/content" --port 0 --listen 127.0.0.2 >"$work/curator.log" 2>&1 &
curator=$!
wait_for 60 "address" grep -q 'open http://127.0.0.2:' "$work/curator.log"
! grep -q 'plain HTTP' "$work/curator.log" || fail "it warns of this machine"
kill "$curator"
wait "$curator" || fail "it did not end well at another address"
build/gopura-curator "$work/content" --port 0 --listen 0.0.0.0 >"$work/curator.log" 2>&1 &
curator=$!
wait_for 60 "warning" grep -q 'plain HTTP' "$work/curator.log"
kill "$curator"
wait "$curator" || fail "it did not end well on a network"
curator=

# ---- what it saved is content like any other
grep -qE '^[0-9]+(-[0-9]+)?$' "$work/content/regions/the-middle.faces" || fail "no list of faces"
[ -z "$(find "$work/content" -name '*.tmp*' -o -name '*.part')" ] || fail "temporary files are left"
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >"$work/log" 2>&1 || { cat "$work/log"; fail "its parts are refused"; }
build/gopura-content annotations export "$work/content" --out "$work/parts.jsonld" >"$work/log" 2>&1 || { cat "$work/log"; fail "its parts cannot be exported"; }
grep -q regions/the-middle.faces "$work/parts.jsonld" || fail "the part is not among them"
