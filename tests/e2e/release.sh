#!/bin/bash
# From a scan to a release on a museum server: build (interrupted and resumed), verify over TLS, change, undo, and find
# what was tampered with.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib-server.sh
make --no-print-directory -s all
content=$PWD/build/gopura-content
folder=$(mktemp -d)
trap 'stop_server; rm -rf "$folder"' EXIT
dir=$folder/content release=$folder/release run=$folder/run
export XDG_CONFIG_HOME=$folder/config
keys=$XDG_CONFIG_HOME/gopura/keys
fail() { echo "FAIL: $*" >&2; exit 1; }

mkdir -p "$dir/pages"
"$content" temple --triangles 20000 --seed 1 --out "$dir/temple.ply" >/dev/null
cat >"$dir/temple.ini" <<'INI'
[model]
name = Small temple
scans = temple.ply
colours = procedural
[grid]
points = 8
face_px = 128
INI
parts() { # TITLE
	cat >"$dir/parts.json" <<-JSON
	{"parts": [{"id": "tower", "region": {"kind": "sphere", "centre": [0, 0, 20], "radius": 4},
	  "anchor": [0, 0, 22], "title": {"en": "$1", "fr": "Tour", "km": "ប្រាង្គ", "ja": "塔"}},
	  {"id": "step", "region": {"kind": "faces", "file": "regions/step.faces"}, "page": false,
	  "title": {"en": "A step", "fr": "Marche", "km": "ជណ្ដើរ", "ja": "段"}}]}
	JSON
}
mkdir -p "$dir/regions"
echo '0-399 # the first that were made' >"$dir/regions/step.faces"
# ---- errors in the texts are reported before the long work, not after it
parts Tower
"$content" build "$dir" --out "$release" >"$folder/log" 2>&1 && fail "a part without its page was built"
grep -q 'pages/tower.en.html' "$folder/log" || fail "the message does not name the page: $(cat "$folder/log")"
[ ! -e "$dir/.work/master" ] || fail "the fault was found after the hierarchy was made"
echo '<h1>Tower</h1><p>The mountain in the middle.</p>' >"$dir/pages/tower.en.html"

root_of() { sed -nE 's/.*root ([0-9a-f]{32})$/\1/p' "$1"; }
files() { (cd "$release" && find packs locator -type f | sort); }
points() { (cd "$dir/.work/samples" && stat -c '%n %i %Y %s' [0-9]* | sort); }

# ---- a build that is killed continues where it stopped, and gives the same result as an undisturbed one
for seconds in 1 3; do
	timeout -s KILL "$seconds" "$content" build "$dir" --out "$release" >"$folder/log" 2>&1 || true
	[ ! -f "$release/timestamp.json" ] || "$content" verify "$release" >/dev/null || fail "a cut-off build left a bad release"
done
"$content" build "$dir" --out "$release" >"$folder/first" 2>&1 || { cat "$folder/first"; fail "build"; }
first=$(root_of "$folder/first")
[ -n "$first" ] || fail "build does not say its root"
[ -f "$keys/content/release.key" ] && [ ! -e "$dir/keys" ] || fail "the keys are not where they belong"
cp -r "$dir" "$folder/again" && rm -rf "$folder/again/.work"
cp -r "$keys/content" "$folder/keys-again"
"$content" build "$folder/again" --jobs 1 --out "$folder/release-again" --keys "$folder/keys-again" >"$folder/log" 2>&1
[ "$(root_of "$folder/log")" = "$first" ] || fail "the same content gave another root"
diff <(files) <(cd "$folder/release-again" && find packs locator -type f | sort) || fail "other packs"

# ---- over TLS
start_server "$release" "$run"
"$content" verify "$server_url" --ca "$server_ca" --trust "$keys/content/root/1.json" >"$folder/verified" ||
	fail "verify over TLS"
cat "$folder/verified"
grep -qE '^  labels +[1-9]' "$folder/verified" || fail "parts have regions, and nothing is labelled"
share=$(sed -nE 's/.*published share: ([0-9]+) of ([0-9]+) .*/\1 \2/p' "$folder/verified")
[ -n "$share" ] && [ $((10 * ${share% *})) -le "${share#* }" ] || fail "the published share passes a tenth: $share"
"$content" verify "$server_url" >/dev/null 2>&1 && fail "an unknown authority was trusted"
"$content" verify "$server_url" --ca "$server_ca" --trust "$folder/keys-again/root/1.json" >/dev/null ||
	fail "copied keys are the same keys"
mkdir "$folder/others"
"$content" keys "$folder/others" >/dev/null
"$content" verify "$server_url" --ca "$server_ca" --trust "$keys/others/root/1.json" >/dev/null 2>"$folder/log" &&
	fail "another publisher's root was enough"
grep -q 'signatures' "$folder/log" || fail "the message does not speak of signatures: $(cat "$folder/log")"

# ---- nothing changed: nothing is written but the timestamp; keys that an earlier program made in the content are taken out
mv "$keys/content" "$dir/keys"
files >"$folder/before"
"$content" build "$dir" --out "$release" | grep -q 'nothing changed' || fail "something was made anew"
files | diff "$folder/before" - || fail "files were written for nothing"
[ -f "$keys/content/release.key" ] && [ ! -e "$dir/keys" ] || fail "the keys stayed among the content"

# ---- a new title: a few small blocks, samples untouched
points >"$folder/points"
[ "$(wc -l <"$folder/points")" -gt 100 ] || fail "there are hardly any samples"
parts 'High tower'
echo '<h1>Tower</h1><p>Another page.</p>' >"$dir/pages/tower.en.html"
"$content" build "$dir" --out "$release" --comment 'a better title' >"$folder/second"
grep -q '^release 2 ' "$folder/second" || fail "no second release"
files >"$folder/after"
[ -z "$(comm -23 "$folder/before" "$folder/after")" ] || fail "an old file is gone"
new=$(comm -13 "$folder/before" "$folder/after" | (cd "$release" && xargs cat | wc -c))
# The root block is stored anew, and most of it is the space for the eye (58 886 bytes here).
[ "$new" -lt 210000 ] || fail "a title cost $new bytes"
"$content" verify "$server_url" --ca "$server_ca" >"$folder/verified"
grep -q 'a better title' "$folder/verified" || fail "the comment is not there"

# ---- undo
"$content" publish "$dir" --out "$release" --undo >"$folder/undone"
grep -q '^release 3 ' "$folder/undone" || fail "undo has no higher number"
[ "$(root_of "$folder/undone")" = "$first" ] || fail "undo shows another root"
"$content" verify "$server_url" --ca "$server_ca" >/dev/null || fail "undone, but not whole"

# ---- inspect finds what verify walks
"$content" inspect "$server_url" --ca "$server_ca" "$first" | grep -q 'root page' || fail "inspect: root"
"$content" inspect "$release" >"$folder/log"
hash=$(sed -nE 's/^  child +[0-9]+ +([0-9a-f]{32}) .*/\1/p' "$folder/log" | tail -n 1)
"$content" inspect "$release" "$hash" | grep -q 'in packs/' || fail "inspect: $hash"

# ---- another region: labels and words alone are new
"$content" publish "$dir" --out "$release" >/dev/null 2>"$folder/log"
! grep -q 'have changed since' "$folder/log" || fail "samples of today are called old"
files >"$folder/before"
echo 'here' >"$dir/regions/step.faces"
"$content" publish "$dir" --out "$release" >/dev/null 2>"$folder/log" && fail "a list without faces was published"
grep -q "regions/step.faces:1: 'here' is not a face" "$folder/log" || fail "the message does not name the line: $(cat "$folder/log")"
echo '0-99' >"$dir/regions/step.faces"
"$content" publish "$dir" --out "$release" >/dev/null
files >"$folder/after"
new=$(comm -13 "$folder/before" "$folder/after" | (cd "$release" && xargs cat | wc -c))
[ "$new" -gt 0 ] && [ "$new" -lt 210000 ] || fail "another region cost $new bytes"
"$content" build "$dir" --out "$release" >/dev/null
echo '0-199' >"$dir/regions/step.faces"
"$content" build "$dir" --out "$release" | grep -q '^release' || fail "a build did not see another list of faces"
points | diff "$folder/points" - || fail "a title, a page or a region touched samples"
"$content" verify "$server_url" --ca "$server_ca" >/dev/null || fail "another region, but not whole"

# ---- another sun without other samples: published as asked for, but not without a word
sed -i '/^colours/a sun = 1 0 1' "$dir/temple.ini"
"$content" publish "$dir" --out "$release" >/dev/null 2>"$folder/log" || fail "another sun is not published"
grep -q "have changed since hierarchy and samples were made: 'gopura-content build" "$folder/log" ||
	fail "samples of another light were published without a word: $(cat "$folder/log")"

# ---- a changed byte, at rest or in transit
pack=$(ls -S "$release"/packs/* | head -n 1) # the tiles; a smaller one may be of an older release alone
cp "$pack" "$folder/pack"
tests/tools/flip_byte.sh "$pack" 50000
"$content" verify "$server_url" --ca "$server_ca" >/dev/null 2>"$folder/log" && fail "tampering was not found"
grep -q "$(basename "$pack")" "$folder/log" || fail "the message does not name the pack: $(cat "$folder/log")"
cp "$folder/pack" "$pack"
sed -i 's/payload":"e/payload":"f/' "$release/release.json"
"$content" verify "$server_url" --ca "$server_ca" >/dev/null 2>"$folder/log" && fail "a changed release.json was not found"
grep -q 'release.json' "$folder/log" || fail "the message does not name release.json"
"$content" publish "$dir" --out "$release" >/dev/null 2>"$folder/log" && fail "published over a damaged release.json"
echo "built, served, verified, changed, undone"
