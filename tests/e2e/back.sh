#!/bin/bash
# The back button of the bar, step by step: from a page reached by a link to the page with that link, where it was read,
# to its card, to the search as it was left, to the first view; then no step is left.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/back log=build/e2e/back/kiosk.log
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory -j"$(nproc)" build/tests/tools/hurried_kiosk build/tests/tools/golden >/dev/null
small_release
# At 960 x 540: the search, "to", the first that is found, its card, its page, a finger's way down, a link in its text.
python3 - "$work" <<'P'
import sys

now, touches, shots = 4000, [], []


def tap(x, y, then=1500):
    global now
    touches.extend((f"{now} down 0 {x} {y}", f"{now + 80} up 0"))
    now += then


def shot(name):
    global now
    shots.append(f"{now} {name}")
    now += 500


back = lambda: tap(58, 516, 4000)
tap(128, 516)
tap(698, 417, 500)
tap(877, 417, 3000)
shot("list")
tap(720, 75, 4000)
tap(480, 430, 4000)
touches.append(f"{now} down 0 720 470")
touches += [f"{now + 20 * i} move 0 720 {470 - 10 * i}" for i in range(1, 35)]
touches += [f"{now + 1200} move 0 720 130", f"{now + 1300} up 0"]
now += 4000
shot("read")
tap(754, 441, 6000)
shot("linked")
for name in ("read-again", "card", "list-again", "start", "nothing"):
    back()
    shot(name)
open(f"{sys.argv[1]}/fingers.touch", "w").write("\n".join(touches) + "\n")
open(f"{sys.argv[1]}/shots.txt", "w").write("\n".join(shots) + "\n")
P
build/tests/tools/hurried_kiosk --fetch build/gopura-fetch --locale build/locale --display headless --size 960x540 \
	--release "$small/release" --trust "$small/release/root/1.json" --state "$work/state" --idle-s 60 \
	--touch-replay "$work/fingers.touch" --shots "$work/shots.txt" --capture "$work/shots" --log debug \
	>"$work/seen.json" 2>"$log" || { tail -n 20 "$log"; fail "the kiosk ended with an error"; }
python3 - "$log" <<'P'
import re
import sys

steps, eye, eyes = [], None, []
for line in open(sys.argv[1]):
    if at := re.search(r"eye at (\S+ \S+ \S+), looks", line):
        eye = at[1]
    if step := re.search(r"app: (back: .*|page of .*|card of .*)", line):
        steps.append(step[1])
        eyes.append(eye)
    if "nobody is there" in line:
        break
print(*steps, sep="\n")
number = {name: i for i, name in enumerate(dict.fromkeys(s.split()[2] for s in steps if " of " in s))}
opened = [s.split()[:3:2] for s in steps if " of " in s]
assert [kind for kind, _ in opened] == ["card", "page", "page"] and opened[0][1] == opened[1][1] != opened[2][1], opened
backs = [re.fullmatch(r"back: card (-?\d+), page (-?\d+)(, search)?", s).groups() for s in steps if s.startswith("back")]
part = backs[0][1]
assert part != "-1" and backs == [("-1", part, None), (part, "-1", None), ("-1", "-1", ", search"), ("-1", "-1", None)], backs
assert eyes[0] == eye, f"the eye is at {eye} at last, and was at {eyes[0]}"
P
for step in read list; do
	build/tests/tools/golden keep "$work/shots/$step.png" "$work/$step.png"
	build/tests/tools/golden compare "$work/$step.png" "$work/shots/$step-again.png" "$work/$step-differs.png" ||
		fail "going back shows another picture: $work/shots/$step.png, $work/shots/$step-again.png"
done
