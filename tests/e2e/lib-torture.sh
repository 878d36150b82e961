# The uses of the programs that run on, for torture.sh, which sources this:
#
#   fetch    from an empty cache it brings a release from nginx for a client, and ends with it
#   folder   the same from a folder
#   stick    the same from a stick, while the server cannot be reached
#   again    as fetch, with a cache that has all of it, which must not be set aside
#   health   it is started by a request, answers each of its pages, and ends when idle (torture_health.py)
#   curator  it starts, ana signs in, opens a page, saves a page and a text, it ends (torture_curator.py)
#   kiosk    it starts with a release and a fetcher of its own, and ends when the picture is complete
#   morning  the same with the state and the cache of the day before, which must not be set aside
#   follow   as kiosk, by the metadata of The Update Framework, from a stick; the call fails in its fetcher
#   touch    as kiosk, and fingers open a part's card and page

visits="fetch folder stick again health curator kiosk morning follow touch" visit=$work/visit metrics_pid=

is_visit() { [[ " $visits " = *" $1 "* ]]; }
is_fetch() { [[ " fetch folder stick again " = *" $1 "* ]]; }
is_slow_visit() { [[ " kiosk morning follow touch " = *" $1 "* ]]; }

# What all visits need, made before the first.
begin_visits() {
	[ ! -e "$work/views.txt" ] || return 0
	echo '46.7 -55.7 32.6  0 0 9  45' >"$work/views.txt"
	cat >"$work/page.touch" <<-'END'
		2500 down 0 600 124
		2550 up 0 600 124
		3700 down 0 320 300
		3750 up 0 320 300
		5000 down 0 2 2
		5050 up 0 2 2
	END
	read -r root root_bytes < <(python3 - "$work/reference/release.json" <<-'P'
		import base64, json, sys
		release = json.loads(base64.b64decode(json.load(open(sys.argv[1]))["payload"]))
		print(release["root"], release["root_bytes"])
	P
	)
	printf '#!/bin/bash\nexec build/gopura-fetch --stick %q "$@"\n' "$work/reference" >"$work/fetch-stick"
	chmod +x "$work/fetch-stick"
	"$content" publish "$work/content" --out "$work/release" --keys "$work/both_forms" >"$work/log" 2>&1 || { cat "$work/log"; fail publish; }
	cp -a "$work/content" "$work/project"
	echo 'password of ana' | build/gopura-curator user add "$work/project" ana >"$work/log" 2>&1 || { cat "$work/log"; fail user; }
	printf 'day,minutes\n2026-11-28,1\n' >"$work/visits.csv"
	serve "$work/reference" "$work/server"
	build/gopura-fetch --release "$work/reference" --cache "$work/metrics.db" --socket "$work/metrics.socket" \
		--metrics "$work/metrics" >"$work/metrics.log" 2>&1 &
	metrics_pid=$!
	wait_for 20 "metrics" test -S "$work/metrics"
	mkdir "$visit"
	use_visit fetch && is_done fetch || { cat "$work/said"; fail "a full cache"; }
	mv "$visit" "$work/full"
	mkdir "$visit"
	use_visit kiosk && is_done kiosk || { cat "$work/said"; fail "the day before"; }
	rm "$visit/views.jsonl"
	mv "$visit" "$work/yesterday"
}
end_visits() { [ -z "$metrics_pid" ] || kill "$metrics_pid"; }

prepare_visit() {
	begin_visits
	rm -rf "$visit" "$work/once" "$work/left"
	mkdir "$visit"
	[ "$1" != again ] || cp "$work"/full/cache.db* "$visit/"
	[ "$1" != morning ] || cp -a "$work/yesterday/." "$visit"
	[ "$1" != curator ] || cp -a "$work/project" "$visit/content"
}

# use_visit NAME SETTING...: see use in torture.sh
use_visit() {
	local name=$1 program=gopura-$1 command
	shift
	local from=$url fetcher=build/gopura-fetch
	case $name in
	folder) from=$work/reference ;;
	stick) from=https://localhost:1/ fetcher=$work/fetch-stick ;;
	esac
	! is_fetch "$name" || program=gopura-fetch
	local kiosk=(build/gopura-kiosk --display headless --size 640x360 --release "$work/reference"
		--trust "$work/reference/root/1.json" --state "$visit/state" --visits "$visit/visits.csv" --metrics "$visit/metrics"
		--log debug)
	case $name in
	fetch | folder | stick | again) command=(build/tests/tools/fetch_tool walk --brief --fetch "$fetcher" --release "$from" --ca "$ca"
		--cache "$visit/cache.db" --root "$root" --bytes "$root_bytes" --most-s 20) ;;
	health) command=(python3 tests/e2e/torture_health.py "$visit" build/gopura-health --kiosk "$visit/none"
		--fetch "$work/metrics" --faults "$visit/faults" --data "$work" --visits "$work/visits.csv") ;;
	curator) command=(python3 tests/e2e/torture_curator.py "$visit" build/gopura-curator "$visit/content") ;;
	follow) program=gopura-fetch command=("${kiosk[@]}" --release https://localhost:1/ --stick "$work/release" --trust
		"$work/both_forms/tuf/1.root.json" --poll-s 1 --views "$work/views.txt" --capture "$visit") ;;
	kiosk | morning) program=gopura-kiosk command=("${kiosk[@]}" --views "$work/views.txt" --capture "$visit") ;;
	touch) program=gopura-kiosk command=("${kiosk[@]}" --touch-replay "$work/page.touch" --quit-after-replay) ;;
	esac
	timeout -k 5 120 env FAIL_PROGRAM=$program FAIL_ONCE="$work/once" FAIL_LEFT="$work/left" "$@" LD_PRELOAD="$shim" \
		"${command[@]}" >"$work/said" 2>&1
}

# Whether the use's result is there, after a use that ended with 0.
is_done() {
	case $1 in
	fetch | folder | stick | again) grep -q '"damaged":0' "$work/said" ;;
	kiosk | morning | follow) grep -q '"settled": true' "$visit/views.jsonl" ;;
	touch) grep -q 'app: page of' "$work/said" || was_late ;;
	esac
}
# On a busy machine the fingers may come before the picture, which they find where the first frames are quick.
was_late() { ! grep -qE 'first picture after (1[0-4])?[0-9]{2,3} ms' "$work/said" || grep -q 'a frame took' "$work/said"; }
has_said() { grep -qE '^(error|warn): |^gopura-' "$work/said"; }

# check_visit NAME STATUS WHAT: after a use with a failing call
check_visit() {
	local name=$1 status=$2 what=$3
	if ! is_slow_visit "$name" || [ "$name" = follow ]; then
		[ "$status" = 0 ] && is_done "$name" || fault "$what: it does not work again"
	elif [ "$status" != 0 ]; then
		has_said || fault "$what: it ended without a word"
	elif ! is_done "$name"; then
		has_said || fault "$what: its result is not there, and nothing was said"
	fi
	! grep -q '^crashed' "$work/once" 2>/dev/null || fault "$what: it crashed"
	# Without a thread to close it, a descriptor stays open by design (net/closer.c).
	[ ! -s "$work/left" ] || grep -q 'thread that closes descriptors' "$work/said" || { cp "$work/left" "$work/said"; fault "$what: it leaves memory or descriptors"; }
	if [ "$name" = curator ]; then
		! command -v git >/dev/null || git --git-dir="$visit/content/.curator/history.git" fsck --strict >"$work/said" 2>&1 ||
			fault "$what: the history is damaged"
		[ -z "$(find "$visit/content" -name '*.tmp*' -o -name '*broken*')" ] || fault "$what: it leaves files"
	elif [ "$name" != health ]; then
		[ "$name" != touch ] || name=kiosk
		use_visit "$name" FAIL_KIND=none && is_done "$name" || fault "$what: the next one does not work"
		[ -z "$(find "$visit" -name '*.broken*')" ] || fault "$what: the next one sets a file aside as damaged"
	fi
}
