#!/bin/bash
# Every allocation and every call on a file: a program's use is repeated with its n-th malloc failing, then with its n-th
# open, read, write, fsync, rename, mmap ... failing (tests/tools/failing_calls.c). It may succeed without what failed, or end
# with status 1 to 3 and a line that says what is wrong; it may not crash, hang, or fail without a word. What is made is
# whole or not there, and after a failed use the next one makes all that it would have made.
#
# Of the programs that run on, tests/e2e/lib-torture.sh says what a use is. The call fails once, in whichever process
# makes it first: the program may go on, or end and be started again. At the end the use's result must be there, nothing
# may be left in memory or open, and a use without a failing call works.
#
#   make torture            every n of every use
#   SAMPLES=N               so many of each, spread over all, and one errno of several (default 1; all: 0)
#   USES="verify build"     of these alone
#   KINDS="memory io"       and of these calls (memory codec io short database)
#   SHARE=1/2               the first of two halves, so that another process may run the second one
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
share=${SHARE:-1/1} samples=${SAMPLES:-1}
part=${share%/*} parts=${share#*/}
[[ $share =~ ^[1-9][0-9]*/[1-9][0-9]*$ ]] && [ "$part" -le "$parts" ] || fail "SHARE=$share: give one as 1/2"
work=build/e2e/torture
[ "$parts" = 1 ] || work=$work-$part-of-$parts
trap 'end_visits; stop_server' EXIT
rm -rf "$work"
mkdir -p "$work/content"
shim=$PWD/build/tests/tools/failing_calls.so content=build/gopura-content
tiny_content "$work/content" 10000 5000
"$content" build "$work/content" --out "$work/release" --keys "$work/keys" --jobs 1 >"$work/log" 2>&1 || { cat "$work/log"; fail build; }
cp -a "$work/release" "$work/reference"
ln -s reference "$work/reference-build"
cp -a "$work/keys" "$work/both_forms"
"$content" keys --keys "$work/both_forms" --tuf >"$work/log" 2>&1 || { cat "$work/log"; fail keys; }
"$content" annotations export "$work/content" --out "$work/parts.jsonld" >"$work/log" 2>&1 || { cat "$work/log"; fail annotations; }
printf '[terminal]\nname = east hall\n[release]\nurl = https://museum.example/temple/\ntrust = 1.json\n' >"$work/gopura.conf"
cp "$work/keys/root/1.json" "$work/"
mkdir "$work/pillar"
python3 tests/tools/leaning_pillar.py "$work/pillar" 0
printf '[model]\nname = pillar\nscans = pillar.obj\n[grid]\npoints = 4\nface_px = 128\n[hierarchy]\nsurface = octree\ncell_mm = 200\n' >"$work/surface.ini"
cp "$work/surface.ini" "$work/pillar/temple.ini"
"$content" build "$work/pillar" --out "$work/reference-surface" --keys "$work/keys" --jobs 1 >"$work/log" 2>&1 || { cat "$work/log"; fail surface; }
printf '[model]\nscans = pillar.obj\n' >"$work/pillar/temple.ini"
printf '{"steps": [{"lattice": [1, 1, 1], "box": {"low": [-2, -2, 0], "high": [2, 2, 4]}, "moves": [{"points": [0, "all", "all"], "by": [-0.2, 0, 0]}]}]}\n' >"$work/bend.json"
python3 tests/tools/points_of_a_ball.py "$work/ball.ply"
printf '20 -25 14  0 0 9  45\n' >"$work/view.txt"

. tests/e2e/lib-torture.sh

# makes NAME: of the uses that make files from others, the command, which writes into $work/new
makes() {
	case $1 in
	export) command=("$content" export "$work/pillar" --budget 20kB --out "$work/new/pillar.glb") ;;
	temple) command=("$content" temple --triangles 10000 --out "$work/new/temple.ply") ;;
	deform) command=("$content" deform --with "$work/bend.json" --out "$work/new/pillar.obj" "$work/pillar/pillar.obj") ;;
	reconstruct) command=("$content" reconstruct --closed --budget-triangles 300 --out "$work/new/ball.ply" "$work/ball.ply") ;;
	render) command=("$content" render "$work/content" --views "$work/view.txt" --size 64x48 --out "$work/new") ;;
	annotations) command=("$content" annotations export "$work/content" --out "$work/new/parts.jsonld") ;;
	iiif) command=("$content" annotations export "$work/content" --iiif --out "$work/new/manifest.json") ;;
	annotated) command=("$content" annotations import "$work/parts.jsonld" --into "$work/new") ;;
	terminal) command=(build/gopura-setup --conf "$work/gopura.conf" --boards board --out "$work/new") ;;
	*) return 1 ;;
	esac
}

# use NAME SETTING...: one use of a program, from a fresh state, with these settings of the shim for the program alone
use() {
	local name=$1 command
	shift
	is_visit "$name" && { use_visit "$name" "$@"; return; }
	makes "$name" || case $name in
	keys) command=("$content" keys "$work/content" --keys "$work/new") ;;
	rekeys) command=("$content" keys "$work/content" --keys "$work/exchanged" --museum) ;;
	team) command=("$content" keys "$work/content" --keys "$work/exchanged" --team stone --from "$work/handed") ;;
	exchange) command=("$content" keys --keys "$work/exchanged" --exchange root --exchange timestamp) ;;
	inspect) command=("$content" inspect "$work/release") ;;
	verify) command=("$content" verify "$work/release") ;;
	import) command=("$content" import "$work/content/temple.ply") ;;
	publish) command=("$content" publish "$work/content" --out "$work/release" --keys "$work/keys" --comment "$RANDOM") ;;
	both) command=("$content" publish "$work/content" --out "$work/new" --keys "$work/both_forms" --comment "$RANDOM") ;;
	user) command=(build/gopura-curator user add "$work/new" eva) ;;
	publisher) command=(build/gopura-curator publisher "$work/new" --out "$work/made" --keys "$work/keys" --jobs 1 --once) ;;
	build | surface) command=("$content" build "$work/fresh" --out "$work/made" --keys "$work/keys" --jobs 1) ;;
	setup) command=(build/gopura-setup --check "$work/gopura.conf") ;;
	esac
	timeout -k 5 120 env FAIL_PROGRAM="${command[0]##*/}" "$@" LD_PRELOAD="$shim" "${command[@]}" >"$work/said" 2>&1 <<<'password of eva'
}
# prepare NAME: what a use begins with
prepare() {
	rm -rf "$work/new" "$work/fresh" "$work/made" "$work/exchanged"
	is_visit "$1" && { prepare_visit "$1"; return; }
	! makes "$1" || mkdir "$work/new"
	case $1 in
	exchange | rekeys) cp -a "$work/both_forms" "$work/exchanged" ;;
	team)
		[ -d "$work/handed" ] || {
			cp -a "$work/both_forms" "$work/handed"
			"$content" keys "$work/content" --keys "$work/handed" --museum >"$work/said" 2>&1
			rm -rf "$work/handed"/{root,release,targets}.key "$work/handed/root"
		} ;;
	both) cp -a "$work/reference" "$work/new" ;;
	user)
		mkdir "$work/new"
		cp "$work/content/temple.ini" "$work/new/"
		build/gopura-curator user add "$work/new" ana >"$work/said" 2>&1 <<<'password of ana' ;;
	publisher)
		cp -a "$work/content" "$work/new"
		cp -a "$work/reference" "$work/made"
		mkdir -p "$work/new/.curator/publish"
		ask 1 ;;
	build) fresh "$work/content" ;;
	surface)
		fresh "$work/pillar"
		cp "$work/surface.ini" "$work/fresh/temple.ini" ;;
	esac
}
# fresh FOLDER: its content as it was before any build
fresh() {
	cp -a "$1" "$work/fresh"
	rm -rf "$work/fresh/.work"
}
# ask N: the page's N-th request for a release
ask() {
	printf '{"number": %d, "sequence": 0, "at": 1795000000, "by": "ana", "comment": "%d"}\n' "$1" "$RANDOM" >"$work/new/.curator/publish/request.json"
}
says_tuf() { python3 -c 'import base64, json, sys; sys.exit("tuf_root" not in json.loads(base64.b64decode(json.load(open(sys.argv[1]))["payload"])))' "$1/release.json"; }
# All releases are ana's in the list but the first, which was made on the command line.
are_by_ana() { python3 -c 'import json, sys; sys.exit(any((one["by"] == "ana") != (one["sequence"] > 1) for one in json.load(open(sys.argv[1]))["releases"]))' "$work/new/.curator/publish/releases.json"; }
step_of_publisher() { python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["step"])' "$work/new/.curator/publish/state.json"; }

tried=0 runs=0 survived=0 faults=0
fault() { faults=$((faults + 1)); echo "  FAULT $*"; sed 's/^/        /' "$work/said" "$work/once" 2>/dev/null | tail -n 6; }

# Nothing is damaged here: a lack of memory or a failed call is no fault of a file.
blames() { grep -v '"damaged":0' "$work/said" | grep -E 'content bug|damaged|does not decode|not a complete' >"$work/blamed"; }
# strain NAME KIND ERRNO N
strain() {
	local status=0
	prepare "$1"
	use "$1" FAIL_KIND="$2" FAIL_ERRNO="$3" FAIL_AT="$4" || status=$?
	runs=$((runs + 1))
	[ "$status" != 0 ] || survived=$((survived + 1))
	[ "$status" -le 3 ] || fault "$1: $2 call $4 (errno $3) ended it with status $status"
	[ "$status" = 0 ] || [ -s "$work/said" ] || fault "$1: $2 call $4 (errno $3): it failed without a word"
	! blames || fault "$1: $2 call $4 (errno $3): it blames what is whole: $(head -n 1 "$work/blamed")"
	is_visit "$1" && { check_visit "$1" "$status" "$1: $2 call $4 (errno $3)"; return; }
	! makes "$1" || { check_made "$1" "$status" "$1: $2 call $4 (errno $3)"; return; }
	case $1 in
	publish | inspect | verify)
		"$content" verify "$work/release" >"$work/said" 2>&1 || fault "$1: $2 call $4: the release is damaged" ;;
	both)
		! says_tuf "$work/new" || [ -f "$work/new/tuf/1.root.json" ] || fault "both: $2 call $4: a root is promised that is not there"
		use both && "$content" verify "$work/new" >"$work/said" 2>&1 &&
			"$content" verify "$work/new" --trust "$work/both_forms/tuf/1.root.json" >"$work/said" 2>&1 ||
			fault "both: $2 call $4: the next one does not go on" ;;
	rekeys)
		for path in "$work/both_forms"/*.key "$work/both_forms"/*/1.*json; do
			cmp "$path" "$work/exchanged/${path#"$work/both_forms/"}" >"$work/said" 2>&1 || fault "rekeys: $2 call $4: ${path##*/} is lost"
		done
		use rekeys && [ -f "$work/exchanged/snapshot.key" ] || fault "rekeys: $2 call $4: the next one does not work" ;;
	team)
		use team && cmp "$work/handed/snapshot.key" "$work/exchanged/snapshot.key" >>"$work/said" 2>&1 &&
			grep -q 'snapshot = snapshot.key' "$work/exchanged/signing.ini" ||
			fault "team: $2 call $4: the next one does not work, or a key was left out" ;;
	exchange)
		"$content" keys --keys "$work/exchanged" --exchange root --exchange timestamp >"$work/said" 2>&1 &&
			"$content" keys --keys "$work/exchanged" >>"$work/said" 2>&1 || fault "exchange: $2 call $4: the next one does not go on" ;;
	user)
		{ [ "$status" = 0 ] || use user || grep -q "an account of this name" "$work/said"; } &&
			build/gopura-curator user list "$work/new" >"$work/said" && grep -q ana "$work/said" && grep -q eva "$work/said" || fault "user: $2 call $4: an account is lost, or none can be added" ;;
	publisher)
		use publisher && [[ $(step_of_publisher) =~ done|failed ]] && ask 2 && use publisher && [ "$(step_of_publisher)" = done ] &&
			"$content" verify "$work/made" >"$work/said" 2>&1 || fault "publisher: $2 call $4: the next request is not carried out"
		are_by_ana || fault "publisher: $2 call $4: who published is wrong" ;;
	build | surface)
		"$content" build "$work/fresh" --out "$work/made" --keys "$work/keys" --jobs 1 >"$work/said" 2>&1 &&
			diff -rq "$work/reference-$1/packs" "$work/made/packs" >>"$work/said" || fault "$1: $2 call $4: the next one makes another release" ;;
	esac
}

# check_made NAME STATUS WHAT: a file is there whole or not at all, and the next use makes all of them. gopura-setup goes on
# with what it could read, and lists what it could not.
check_made() {
	local path again=$2
	if [ "$1" = terminal ] && [ -s "$work/new/faults" ]; then
		again=1
	else
		while read -r path; do
			cmp "$work/new/$path" "$work/made-$1/$path" >"$work/said" 2>&1 || fault "$3: $path is not whole"
		done < <(cd "$work/new" && find . -type f)
	fi
	[ "$again" = 0 ] || use "$1" || fault "$3: the next one does not work"
	diff -r "$work/made-$1" "$work/new" >"$work/said" 2>&1 || fault "$3: something else was made"
}

# all NAME KIND ERRNO
all() {
	local calls step n count="$work/count-$1-$2" most=$samples
	if [ ! -e "$count" ]; then
		prepare "$1"
		use "$1" FAIL_KIND="$2" FAIL_COUNT="$count" || fault "$1 fails without a failing call"
		[ ! -d "$work/new" ] || [ -d "$work/made-$1" ] || mv "$work/new" "$work/made-$1"
	fi
	calls=$(sort -n "$count" | tail -n 1)
	step=1
	[ "$samples" -le 1 ] || ! is_slow_visit "$1" || most=$((samples / 2))
	[ "$samples" = 0 ] || step=$(((calls + most - 1) / most))
	[ "$step" -gt 0 ] || step=1
	for ((n = 1 + RANDOM % step; n <= calls; n += step)); do
		[ $((tried++ % parts)) = $((part - 1)) ] || continue
		strain "$1" "$2" "$3" "$n"
		[ $((runs % 100)) != 0 ] || echo "  $1: $2 call $n of $calls, $runs runs, $faults faults"
	done
	echo "$1: $calls calls of $2, errno $3"
}

# Uses in which libraries decode or compress; one of each is enough for a sample.
has_codecs() { [[ " verify kiosk " = *" $1 "* ]] || { [ "$samples" != 1 ] && [[ " export deform render publish both publisher build surface morning follow touch curator " = *" $1 "* ]]; }; }
is_asked() { [ -z "${KINDS:-}" ] || [[ " $KINDS " = *" $1 "* ]]; }
RANDOM=${SEED:-1}
for name in ${USES:-keys rekeys team exchange inspect verify import export temple deform reconstruct render annotations iiif annotated publish both build surface setup terminal user publisher fetch folder stick again health curator kiosk morning follow touch}; do
	! is_asked memory || all "$name" memory 12
	! is_asked codec || ! has_codecs "$name" || all "$name" codec 12
	io=(5 28 4) database=(5 28) # EIO, ENOSPC, EINTR
	[ "$samples" = 0 ] || io=("${io[RANDOM % 3]}") database=("${database[RANDOM % 2]}")
	! is_asked io || for error in "${io[@]}"; do all "$name" io "$error"; done
	! is_asked short || all "$name" short 0
	is_visit "$name" && is_asked database || continue
	for error in "${database[@]}"; do all "$name" database "$error"; done
done
echo "$runs runs, $survived went on without what failed, $faults faults"
[ "$faults" = 0 ]
