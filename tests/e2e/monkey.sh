#!/bin/bash
# Random fingers on the whole kiosk under sanitizers, on a clock that does not wait: whatever was done
# to it, a terminal that is left alone shows itself again with nothing of the visitor left, no frame is
# over the board's budgets, and nothing leaks. EVENTS=1000 SEED=3; make soak has 20000.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/monkey
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory -j"$(nproc)" build/tests/tools/random_touches >/dev/null
make --no-print-directory -j"$(nproc)" SAN=1 BUILD=build/asan build/asan/tests/tools/hurried_kiosk \
	build/asan/gopura-fetch >/dev/null
export ASAN_OPTIONS=detect_leaks=1 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
small_release
# A weak board, so that its budgets have something to hold back; large enough for reach mode, tools and languages on the bar.
cat >"$work/board.ini" <<'I'
[panel]
width_mm = 270
[render]
triangles = 12000
texture_mib = 24
geometry_mib = 8
I

# play EVENTS SEED: the line of what was seen goes to $work/SEED.json.
play() {
	build/tests/tools/random_touches "$1" "$2" 480 320 >"$work/$2.touch"
	build/asan/tests/tools/hurried_kiosk --fetch build/asan/gopura-fetch --locale build/locale --display headless --size 480x320 \
		--board "$work/board.ini" --release "$small/release" --trust "$small/release/root/1.json" \
		--state "$work/state" --idle-s 5 --touch-replay "$work/$2.touch" --log debug \
		>"$work/$2.json" 2>"$work/$2.log"
}

# holds EVENTS SEED: it was played, and nothing is wrong.
holds() {
	local events=$1 seed=$2 status=0
	play "$events" "$seed" || status=$?
	# The leak checker itself dies now and then while it stops llvmpipe's threads: that says nothing.
	if [ "$status" -ne 0 ] && grep -q 'LeakSanitizer has encountered a fatal error' "$work/$seed.log"; then
		status=0
		play "$events" "$seed" || status=$?
	fi
	cat "$work/$seed.json"
	[ "$status" -eq 0 ] || { tail -n 40 "$work/$seed.log"; fail "after EVENTS=$events SEED=$seed: status $status"; }
	! grep -qE 'Sanitizer|runtime error' "$work/$seed.log" ||
		{ grep -E -A 20 'Sanitizer|runtime error' "$work/$seed.log"; fail "EVENTS=$events SEED=$seed"; }
}

# reached: the fingers came wherever there is something to touch.
reached() {
	python3 - "$work"/*.json <<'P'
import json
import sys

seen = [json.load(open(path)) for path in sys.argv[1:]]
never = [name for name in ("card", "page", "search", "language", "help", "tools")
         if not any(one["frames_with"][name] for one in seen)]
sys.exit(f"the fingers never reached {never}" if never or not any(one["left_alone"] for one in seen) else 0)
P
}

# What a finger meets depends on how soon the temple comes, which no clock of ours rules: where the
# first ones reach too little, others follow.
events=${EVENTS:-1000} first=${SEED:-3}
for seed in $(seq "$first" $((first + 3))); do
	holds "$events" "$seed"
	! reached || exit 0
done
fail "such fingers test little"
