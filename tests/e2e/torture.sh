#!/bin/bash
# Every allocation and every call on a file: a program's use is repeated with its n-th malloc failing, then with its n-th
# open, read, write, fsync, rename, mmap ... failing (tests/tools/failing_calls.c). It may succeed without what failed, or end
# with status 1 to 3 and a line that says what is wrong; it may not crash, hang, or fail without a word. What is made is
# whole or not there: after a failed build the next one makes the release that it would have made.
#
# Of the programs that run on, tests/e2e/lib-torture.sh says what a use is. The call fails once, in whichever process
# makes it first: the program may go on, or end and be started again. At the end the use's result must be there, nothing
# may be left in memory or open, and a use without a failing call works.
#
#   make torture            every n of every use
#   SAMPLES=N               so many of each, spread over all (default 2; all: 0)
#   USES="verify build"     of these alone
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
work=build/e2e/torture samples=${SAMPLES:-2}
trap 'end_visits; stop_server' EXIT
rm -rf "$work"
mkdir -p "$work/content"
shim=$PWD/build/tests/tools/failing_calls.so content=build/gopura-content
tiny_content "$work/content" 10000 5000
"$content" build "$work/content" --out "$work/release" --keys "$work/keys" --jobs 1 >"$work/log" 2>&1 || { cat "$work/log"; fail build; }
cp -a "$work/release" "$work/reference"
cp -a "$work/keys" "$work/both_forms"
"$content" keys --keys "$work/both_forms" --tuf >"$work/log" 2>&1 || { cat "$work/log"; fail keys; }
printf '[terminal]\nname = east hall\n[release]\nurl = https://museum.example/temple/\ntrust = 1.json\n' >"$work/gopura.conf"
cp "$work/keys/root/1.json" "$work/"
mkdir "$work/pillar"
python3 tests/tools/leaning_pillar.py "$work/pillar" 0
printf '[model]\nscans = pillar.obj\n' >"$work/pillar/temple.ini"
"$content" export "$work/pillar" --budget 20kB --out "$work/pillar.glb" >"$work/log" 2>&1 || { cat "$work/log"; fail export; }

. tests/e2e/lib-torture.sh

# use NAME SETTING...: one use of a program, from a fresh state, with these settings of the shim for the program alone
use() {
	local name=$1 command
	shift
	is_visit "$name" && { use_visit "$name" "$@"; return; }
	case $name in
	keys) command=("$content" keys "$work/content" --keys "$work/new") ;;
	exchange) command=("$content" keys --keys "$work/exchanged" --exchange root --exchange timestamp) ;;
	export) command=("$content" export "$work/pillar" --budget 20kB --out "$work/new.glb") ;;
	temple) command=("$content" temple --triangles 10000 --out "$work/new.ply") ;;
	inspect) command=("$content" inspect "$work/release") ;;
	verify) command=("$content" verify "$work/release") ;;
	import) command=("$content" import "$work/content/temple.ply") ;;
	publish) command=("$content" publish "$work/content" --out "$work/release" --keys "$work/keys" --comment "$RANDOM") ;;
	build) command=("$content" build "$work/fresh" --out "$work/made" --keys "$work/keys" --jobs 1) ;;
	setup) command=(build/gopura-setup --check "$work/gopura.conf") ;;
	esac
	timeout -k 5 120 env "$@" LD_PRELOAD="$shim" "${command[@]}" >"$work/said" 2>&1
}
# prepare NAME: what a use begins with
prepare() {
	rm -rf "$work/new" "$work/new.glb" "$work/fresh" "$work/made" "$work/exchanged"
	is_visit "$1" && { prepare_visit "$1"; return; }
	[ "$1" != exchange ] || cp -a "$work/both_forms" "$work/exchanged"
	[ "$1" = build ] || return 0
	mkdir "$work/fresh"
	cp -a "$work/content/." "$work/fresh/"
	rm -rf "$work/fresh/.work"
}

runs=0 survived=0 faults=0
fault() { faults=$((faults + 1)); echo "  FAULT $*"; sed 's/^/        /' "$work/said" "$work/once" 2>/dev/null | tail -n 6; }

# strain NAME KIND ERRNO N
strain() {
	local status=0
	prepare "$1"
	use "$1" FAIL_KIND="$2" FAIL_ERRNO="$3" FAIL_AT="$4" || status=$?
	runs=$((runs + 1))
	[ "$status" != 0 ] || survived=$((survived + 1))
	[ "$status" -le 3 ] || fault "$1: $2 call $4 (errno $3) ended it with status $status"
	[ "$status" = 0 ] || [ -s "$work/said" ] || fault "$1: $2 call $4 (errno $3): it failed without a word"
	is_visit "$1" && { check_visit "$1" "$status" "$1: $2 call $4 (errno $3)"; return; }
	case $1 in
	publish | inspect | verify)
		"$content" verify "$work/release" >"$work/said" 2>&1 || fault "$1: $2 call $4: the release is damaged" ;;
	exchange)
		"$content" keys --keys "$work/exchanged" --exchange root --exchange timestamp >"$work/said" 2>&1 &&
			"$content" keys --keys "$work/exchanged" >>"$work/said" 2>&1 || fault "exchange: $2 call $4: the next one does not go on" ;;
	export)
		[ ! -e "$work/new.glb" ] || cmp -s "$work/pillar.glb" "$work/new.glb" || fault "export: $2 call $4: the file is not whole" ;;
	build)
		"$content" build "$work/fresh" --out "$work/made" --keys "$work/keys" --jobs 1 >"$work/said" 2>&1 &&
			diff -rq "$work/reference/packs" "$work/made/packs" >>"$work/said" || fault "build: $2 call $4: the next one makes another release" ;;
	esac
}

# all NAME KIND ERRNO
all() {
	local calls step n count="$work/count-$1-$2" most=$samples
	if [ ! -e "$count" ]; then
		prepare "$1"
		use "$1" FAIL_KIND="$2" FAIL_COUNT="$count" || fault "$1 fails without a failing call"
	fi
	calls=$(sort -n "$count" | tail -n 1)
	step=1
	[ "$samples" -le 1 ] || ! is_slow_visit "$1" || most=$((samples / 2))
	[ "$samples" = 0 ] || step=$(((calls + most - 1) / most))
	[ "$step" -gt 0 ] || step=1
	for ((n = 1 + RANDOM % step; n <= calls; n += step)); do strain "$1" "$2" "$3" "$n"; done
	echo "$1: $calls calls of $2, errno $3"
}

RANDOM=${SEED:-1}
for name in ${USES:-keys exchange export temple inspect verify import publish setup build fetch again health curator kiosk touch}; do
	all "$name" memory 12
	all "$name" io 5  # EIO
	all "$name" io 28 # ENOSPC
	all "$name" io 4  # EINTR
	all "$name" short 0
	is_visit "$name" || continue
	all "$name" database 5
	all "$name" database 28
done
echo "$runs runs, $survived went on without what failed, $faults faults"
[ "$faults" = 0 ]
