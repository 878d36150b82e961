#!/bin/bash
# gopura.conf on the panel: its valid lines are used, the command line overrides them, its errors are shown on the panel
# for half a minute before the temple, and a terminal without the file shows what to do.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v python3 >/dev/null || skip "python3 is not installed"
work=build/e2e/terminal
rm -rf "$work"
mkdir -p "$work/conf" "$work/empty"
small_release
conf=$work/conf/gopura.conf
cp "$small/release/root/1.json" "$work/conf/"

# visit NAME SECONDS OPTIONS...: pictures NAME-early.png (after 3 s) and NAME-late.png (after so many).
visit() {
	local name=$1 late=$2
	shift 2
	printf '3000 %s-early\n%s000 %s-late\n' "$name" "$late" "$name" >"$work/shots-$name"
	printf '%s500 down 0 2 2\n%s550 up 0 2 2\n' "$late" "$late" >"$work/touch-$name"
	timeout 120 build/gopura-kiosk --boards board --display headless --size 320x200 --state "$work/state-$name" \
		--touch-replay "$work/touch-$name" --quit-after-replay --capture "$work" --shots "$work/shots-$name" \
		"$@" >"$work/$name.log" 2>&1 || fail "$name: the kiosk ended with $? ($work/$name.log)"
}

# bar PICTURE PLACE: the page's bar of laterite is along the left, bottom, ... of the picture, or nowhere.
cat >"$work/bar.py" <<'P'
import struct, sys, zlib
data = open(sys.argv[1], "rb").read()
at, idat = 8, b""
while at < len(data):
    size, kind = struct.unpack(">I4s", data[at:at + 8])
    if kind == b"IHDR":
        width, height = struct.unpack(">II", data[at + 8:at + 16])
    if kind == b"IDAT":
        idat += data[at + 8:at + 8 + size]
    at += 12 + size
raw, rows, stride = zlib.decompress(idat), [], 4 * width
before = bytearray(stride)
for y in range(height):
    kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
    for i in range(stride):
        a, b, c = (row[i - 4] if i >= 4 else 0), before[i], (before[i - 4] if i >= 4 else 0)
        p = a + b - c
        paeth = a if abs(p - a) <= abs(p - b) and abs(p - a) <= abs(p - c) else b if abs(p - b) <= abs(p - c) else c
        row[i] = (row[i] + [0, a, b, (a + b) // 2, paeth][kind]) & 255
    rows.append(row)
    before = row
is_bar = lambda x, y: all(abs(v - w) <= 3 for v, w in zip(rows[y][4 * x:4 * x + 3], (158, 72, 38)))
sides = {"left": [(0, y) for y in range(height)], "right": [(width - 1, y) for y in range(height)],
         "top": [(x, 0) for x in range(width)], "bottom": [(x, height - 1) for x in range(width)]}
print(*[side for side, points in sides.items() if all(is_bar(x, y) for x, y in points)] or ["nowhere"])
P
bar() {
	local found
	found=$(python3 "$work/bar.py" "$work/$1.png")
	[ "$found" = "$2" ] || fail "$1: the bar of the page is $found and not $2"
}

# ---- a valid file: no error page; the release comes from where the file says
printf '[release]\nurl = %s\ntrust = 1.json\n[terminal]\nlanguage = km\nboard = generic\n' \
	"$PWD/$small/release" >"$conf"
visit right 8 --conf "$work/no/gopura.conf" --conf "$conf"
bar right-early nowhere
! grep -q 'set-up bug' "$work/right.log" || fail "a right file has faults"
grep -q 'app: showing' "$work/right.log" || fail "the release of gopura.conf was not shown"

# ---- one error: it is shown, the other lines are used (a rotated panel), and the temple follows
printf '[panel]\nrotation = 90\nhours = nine to five\n' >>"$conf"
visit faulty 40 --conf "$conf" &
faulty=$!
# ---- the command line overrides; without a release that could be shown the page stays
mkdir -p "$work/other"
printf '[release]\nurl = %s\n' "$PWD/$small/release" >"$work/other/gopura.conf"
visit overridden 40 --conf "$work/other/gopura.conf" --release "$PWD/$work/empty" || exit 1
wait "$faulty" || exit 1
bar faulty-early bottom
bar faulty-late nowhere
grep -q 'gopura.conf: line 9: hours must be days and times such as' "$work/faulty.log" || fail "the log is silent"
bar overridden-early left
bar overridden-late left
grep -q 'section \[release\] has no trust' "$work/overridden.log" || fail "what is missing was not said"

# ---- an invalid trust file does not end the kiosk
printf '[release]\nurl = %s\ntrust = gopura.conf\n' "$PWD/$small/release" >"$conf"
visit trustless 4 --conf "$conf"
bar trustless-late left
grep -q 'gopura.conf is no trust root' "$work/trustless.log" || fail "the trust file was not looked at"

# ---- no file: what to do; but a terminal that remembers its release shows it
visit unset 4 --conf "$work/no/gopura.conf"
bar unset-late left
mv "$work/state-right" "$work/state-lost"
visit lost 4 --conf "$work/no/gopura.conf"
bar lost-late nowhere
grep -q 'does not exist; the defaults are used' "$work/lost.log" || fail "nobody was told of the missing file"
echo "gopura.conf on the panel: right, faulty, overridden, trustless, missing, lost"
