#!/bin/bash
# The kiosk's start, under sanitizers: the help texts of the programs, wrong options, a missing or wrong trust root,
# damaged state and cache, folders that cannot be written, a panel that is mounted rotated.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/kiosk
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory -j"$(nproc)" SAN=1 BUILD=build/asan build/asan/gopura-kiosk build/asan/gopura-fetch >/dev/null
# The unit tests look for leaks: in a whole kiosk the leak checker itself often dies while it stops
# the threads of Mesa's llvmpipe at the end ("Tracer caught signal 11").
export ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
small_release
release=$small/release log=$work/log
pid=
trap '[ -z "$pid" ] || kill "$pid"' EXIT
kiosk=build/asan/gopura-kiosk

# says STATUS PATTERN COMMAND...: it ends within a minute with that status and says that.
says() {
	local want=$1 pattern=$2 got=0
	shift 2
	timeout 60 "$@" >"$log" 2>&1 || got=$?
	[ "$got" = "$want" ] || { tail -n 20 "$log"; fail "$* ended with $got, not $want"; }
	grep -qE -- "$pattern" "$log" || { tail -n 20 "$log"; fail "$* does not say '$pattern'"; }
	! grep -qE 'Sanitizer|runtime error' "$log" || { cat "$log"; fail "$*"; }
}

# ---- what the programs say of themselves
for program in content kiosk fetch health; do
	says 0 "^gopura-$program [0-9a-f]{7}" build/gopura-$program --version
	says 0 "^gopura-$program: " build/gopura-$program --help
	says 2 'nonsense' build/gopura-$program --nonsense
done
says 0 '^Examples' build/gopura-kiosk --help
says 0 '^Examples' build/gopura-fetch --help
for command in annotations build import temple publish verify inspect keys hierarchy render sample; do
	says 0 "^(example: +| +)gopura-content $command " build/gopura-content "$command" --help
done

# ---- wrong options
says 2 "--size does not accept '12'" $kiosk --size 12
says 2 "--display does not accept 'tv'" $kiosk --display tv
says 2 "--mode does not accept 'best'" $kiosk --mode best
says 2 "--budget-triangles does not accept '9999'" $kiosk --budget-triangles 9999
says 2 "--poll-s does not accept '0'" $kiosk --poll-s 0
says 2 "--download does not accept '22:00'" $kiosk --download 22:00
says 2 "--log does not accept 'all'" $kiosk --log all
says 2 "'more' is not an option" $kiosk more
says 2 'need --capture' $kiosk --release . --views x
says 2 'needs --touch-replay' $kiosk --release . --quit-after-replay
headless=("$kiosk" --display headless --size 640x360)
printf '[panel]\nrotation = 45\n' >"$work/crooked.ini"
says 1 "crooked.ini, line 2: rotation must be 0, 90, 180 or 270, not '45'" "${headless[@]}" --board "$work/crooked.ini" --state "$work/s" --release .
says 1 'absent.ini' "${headless[@]}" --board "$work/absent.ini" --state "$work/s" --release .
echo '1 2 3 4 5 6' >"$work/short.txt"
says 1 'short.txt, line 1' "${headless[@]}" --state "$work/s" --release "$release" --views "$work/short.txt" \
	--capture "$work/c"
echo '10 down 0 1' >"$work/bad.touch"
says 1 'bad.touch.*1' "${headless[@]}" --state "$work/s" --release "$release" --touch-replay "$work/bad.touch"
says 2 '--release' "${headless[@]}" --state "$work/s"

# ---- folders that cannot be written
echo 'a file' >"$work/file"
says 1 "$work/file/state: .*--state" "${headless[@]}" --state "$work/file/state" --release "$release"

# ---- trust root: missing, not valid, another museum's
says 1 'absent.json' "${headless[@]}" --state "$work/trust" --release "$release" --trust "$work/absent.json"
says 1 'file: ' "${headless[@]}" --state "$work/trust" --release "$release" --trust "$work/file"

# starts NAME PATTERN OPTIONS...: checks that a kiosk keeps running until it gets a signal, and logs PATTERN
starts() {
	local name=$1 pattern=$2 got=0
	shift 2
	"${headless[@]}" --log debug --poll-s 1 "$@" >"$work/$name.log" 2>&1 &
	pid=$!
	wait_for 60 "'$pattern' in $name.log" grep -qE -- "$pattern" "$work/$name.log"
	kill "$pid"
	wait "$pid" || got=$?
	pid=
	[ "$got" = 0 ] || { tail -n 30 "$work/$name.log"; fail "$name: ended with $got"; }
	! grep -qE 'Sanitizer|runtime error' "$work/$name.log" || { cat "$work/$name.log"; fail "$name"; }
}
starts untrusting 'refused .*: no trust root: start once with --trust' --state "$work/trust" \
	--release "$release"
mkdir -p "$work/other"
build/gopura-content keys "$work/other" --keys "$work/other-keys" >/dev/null
starts stranger 'refused timestamp.json: .*signature' --state "$work/trust" --release "$release" \
	--trust "$work/other-keys/root/1.json"
! grep -q 'app: showing' "$work/untrusting.log" "$work/stranger.log" || fail "an unknown museum was shown"

# ---- a start, and what must come out of every later one
grep -v '^#' tests/bench/views.txt | sed -n '1p;9p' >"$work/views.txt"
# draws NAME OPTIONS...: settled pictures of two views into $work/NAME. Polygons are the same but for
# the last bits of the sum of frames; which images a picture is made of depends on what came first.
draws() {
	local name=$1
	shift
	"${headless[@]}" --mode polygons --views "$work/views.txt" --capture "$work/$name" "$@" 2>"$work/$name.log" ||
		{ tail -n 30 "$work/$name.log"; fail "$name: the kiosk ended with an error"; }
	! grep -q '"settled": false' "$work/$name/views.jsonl" || fail "$name: a view did not settle"
}
# same NAME LEAST [TO]: as near to the first pictures as that, in dB.
same() {
	build/tests/tools/compare_pictures "$work/${3:-first}" "$work/$1" | tail -n 1 >"$work/$1.json"
	python3 - "$work/$1.json" "$2" <<-'P' || fail "$1: other pictures"
	import json, sys
	found = json.load(open(sys.argv[1]))
	print(f"{sys.argv[1]}: {found['psnr_worst5_db']} dB at worst")
	sys.exit(0 if found["views"] == 2 and found["psnr_worst5_db"] >= float(sys.argv[2]) else 1)
	P
}
state=$work/state offline=https://localhost:9/
draws first --state "$state" --release "$release" --trust "$release/root/1.json"
draws offline --state "$state" --release "$offline"
same offline 38

# ---- damaged state: the second copy is used; both damaged: it starts from nothing and needs a trust root again
garbage() { head -c 3000 /dev/zero | tr '\0' 'x' | dd of="$1" conv=notrunc status=none; }
garbage "$state/state.db"
draws healed --state "$state" --release "$offline"
same healed 38
[ -f "$state/state.db.broken" ] || fail "the damaged state.db was not set aside"
garbage "$state/state.db"
garbage "$state/state.db.second"
starts forgot 'no trust root is stored' --state "$state" --release "$offline"
draws again --state "$state" --release "$release" --trust "$release/root/1.json"
same again 38

# ---- a damaged cache: filled again
garbage "$state/cache.db"
draws refilled --state "$state" --release "$release"
same refilled 38
[ -f "$state/cache.db.broken" ] || fail "the damaged cache.db was not set aside"
draws from-refilled --state "$state" --release "$offline"

# ---- a disk that takes neither: a kiosk that cannot remember, and shows all the same
mkdir -p "$work/stuck/state.db/x" "$work/stuck/cache.db/x"
draws stuck --state "$work/stuck" --release "$release" --trust "$release/root/1.json"
same stuck 38
grep -q 'state.db' "$work/stuck.log" || fail "nothing is said about a state that cannot be written"

# ---- a panel that hangs turned: the same picture, turned; pixels lie elsewhere on its edges
# turned DEGREES MODE LEAST FIRST
turned() {
	local name=$2-$1 size=360x640 picture
	[ "$1" != 180 ] || size=640x360
	printf '[panel]\nrotation = %d\n' "$1" >"$work/turned.ini"
	draws "panel-$name" --mode "$2" --size $size --board "$work/turned.ini" --state "$state" --release "$release"
	mkdir "$work/turned-$name"
	for picture in "$work/panel-$name"/*.png; do
		build/tests/tools/turn_picture $(($1 / 90)) "$picture" "$work/turned-$name/${picture##*/}"
	done
	same "turned-$name" "$3" "$4"
}
# Without sanitizers, under which a picture takes long and which find nothing else in it.
headless[0]=build/gopura-kiosk
turned 90 polygons 32 first
turned 180 polygons 32 first
turned 270 polygons 32 first
draws images --mode lumigraph --state "$state" --release "$release"
turned 90 lumigraph 28 images
