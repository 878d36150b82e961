#!/bin/bash
# Compares every state in Arabic (make golden: in four languages) with the reviewed pictures tests/golden/STATE-LANGUAGE.png, within a tolerance:
# a visit (tests/golden/visit.py) is played in each language on a clock that jumps. States that differ are named, and
# their pictures are saved in build/golden/differ/.
#
#   make golden [LANGUAGES="en km"] [STATES=card]   takes them anew into build/golden/, compares
#   make golden KEEP=yes ...                        and keeps what was taken: look at each first
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/golden
mkdir -p "$work/content"
make --no-print-directory -j"$(nproc)" build/tests/tools/hurried_kiosk build/tests/tools/golden >/dev/null
small_release
# The small temple with the demo's texts (other tests change its own copy) and Arabic ones.
cp -au "$small/content/." "$work/content/"
rm -rf "$work/content/pages" "$work/differ"
cp -r demo/content/pages demo/content/parts.json demo/content/tours.json demo/content/scenes.json "$work/content/"
python3 tests/golden/content.py "$work/content"
build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >"$work/log" 2>&1 ||
	{ cat "$work/log"; fail "no release for the pictures"; }
python3 tests/golden/visit.py "$work"
mkdir -p "$work/differ"

# take LANGUAGE: its pictures into $work/LANGUAGE/.
take() {
	rm -rf "$work/$1" "$work/state-$1"
	build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless --size 960x540 \
		--release "$work/release" --trust "$work/release/root/1.json" --state "$work/state-$1" \
		--language "$1" --idle-s 20 --touch-replay "$work/visit.touch" --shots "$work/shots.txt" \
		--capture "$work/$1" --log debug >"$work/$1.json" 2>"$work/$1.log"
}

taken() { # PID
	wait "$1" || { tail -n 5 "$work"/*.log; fail "a kiosk ended with an error"; }
}

# Two at a time: a kiosk that waits for its fetcher leaves the cores to the other.
languages=${LANGUAGES:-ar}
takers=()
for language in $languages; do
	take "$language" &
	takers+=($!)
	[ "${#takers[@]}" -lt 2 ] || { taken "${takers[0]}"; takers=("${takers[@]:1}"); }
done
for taker in "${takers[@]}"; do taken "$taker"; done

differ=0
for language in $languages; do
	for shot in "$work/$language"/*.png; do
		state=$(basename "$shot" .png)
		golden=tests/golden/$state-$language.png
		[ "${STATES:-$state}" = "$state" ] || continue
		if [ -n "${KEEP:-}" ]; then
			build/tests/tools/golden keep "$shot" "$golden"
		elif ! build/tests/tools/golden compare "$golden" "$shot" "$work/differ/$state-$language.png"; then
			echo "differs: $golden, see $shot and $work/differ/$state-$language.png"
			differ=1
		fi
	done
done
[ "$differ" = 0 ] || fail "pictures differ from those that were kept; where that is right: make golden KEEP=yes"
