#!/bin/bash
# A visitor holds the raking light and the section: on, moved, off by a second tap, and gone with the
# visitor. Whatever is cut away hides no label and takes no touch; a tool at rest draws nothing.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/tools
rm -rf "$work"
mkdir -p "$work"
small_release

# ---- a tool that there is none of
mkdir "$work/bad"
cp -r "$small/content/." "$work/bad/"
sed -i 's/^tools *=.*/tools = light, lens/' "$work/bad/temple.ini"
if build/gopura-content publish "$work/bad" --out "$work/release" 2>"$work/bad.log"; then
	fail "a tool that does not exist was published"
fi
grep -q 'temple.ini:[0-9]*: tools = light, lens: it must be light, section' "$work/bad.log" ||
	{ cat "$work/bad.log"; fail "the tool has no name"; }

# ---- at 960 x 540: the bar's light, its ring, the bar's light again; the section, pushed away and turned, a
# touch on what is seen through it, the end of it; both at once, and nobody
cat >"$work/fingers.touch" <<'T'
5000 down 0 164 520
5080 up 0
16000 down 0 905 380
16100 move 0 920 400
16200 move 0 921 440
16300 up 0
27000 down 0 164 520
27080 up 0
38000 down 0 199 520
38080 up 0
49000 down 0 713 438
49150 move 0 713 430
49300 move 0 713 424
49400 up 0
60000 down 0 713 490
60150 move 0 740 486
60300 move 0 755 470
60400 up 0
71000 down 0 199 520
71080 up 0
82000 down 0 164 520
82080 up 0
82500 down 0 199 520
82580 up 0
119000 down 0 480 20
119050 up 0
T
printf '%s\n' '4500 whole' '15500 light' '26500 lower' '37500 whole-again' '48500 section' '59500 pushed' '70500 turned' \
	'81500 whole-at-last' '84500 both' '118500 nobody' >"$work/shots.txt"
build/gopura-kiosk --display headless --size 960x540 --release "$small/release" \
	--trust "$small/release/root/1.json" --state "$work/state" --log debug --idle-s 5 --figures "$work/figures" \
	--touch-replay "$work/fingers.touch" --quit-after-replay --capture "$work/shots" --shots "$work/shots.txt" \
	2>"$work/kiosk.log" || { tail -n 20 "$work/kiosk.log"; fail "the kiosk ended with an error"; }
grep -E 'app: (light|section|no tools|nobody|is somebody)' "$work/kiosk.log"
python3 - "$work/kiosk.log" <<'P'
import re
import sys

log = open(sys.argv[1]).read()
lights = [tuple(map(float, m)) for m in re.findall(r"app: light at (\S+) (\S+)", log)]
sections = [tuple(map(float, m)) for m in re.findall(r"app: section at (\S+) m, turned (\S+)", log)]
said = re.findall(r"app: (light|section|no tools|nobody)", log)
assert said[:9] == ["light", "light", "no tools", "section", "section", "section", "no tools", "light", "light"], said
assert "no tools" in said[9:] and said.index("nobody", 9) < 9 + said[9:].index("no tools") + 2, said
(x, y), (x2, y2) = lights[:2]
assert x < 0 < y and x2 > 0.7 and abs(x2 * x2 + y2 * y2) <= 1.01, lights
assert sections[0][0] == 0 and sections[1][0] < -2, sections  # away from the visitor
assert sections[2][0] == sections[1][0] and abs(sections[2][1] - sections[1][1]) > 0.5, sections
P

# ---- as pictures: how much of each differs from the one before a tool was taken up
make --no-print-directory build/tests/tools/compare_pictures >/dev/null
python3 tests/e2e/tools.py "$work/shots"
