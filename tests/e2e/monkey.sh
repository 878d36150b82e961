#!/bin/bash
# Random touches on the whole kiosk under sanitizers, on a clock that skips waiting times. Whatever was touched, a
# terminal that is left alone returns to its state for nobody with nothing of the visitor left, no frame exceeds the
# board's budgets, and nothing leaks. EVENTS=1000 SEED=4; make soak uses 20000.
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
# A weak board, so that its budgets are reached; large enough for reach mode, tools and languages on the bar.
cat >"$work/board.ini" <<'I'
[panel]
width_mm = 270
[render]
triangles = 12000
texture_mib = 24
geometry_mib = 8
I

# play EVENTS SEED: writes the line of results to $work/SEED.json.
play() {
	build/tests/tools/random_touches "$1" "$2" 480 320 >"$work/$2.touch"
	build/asan/tests/tools/hurried_kiosk --fetch build/asan/gopura-fetch --locale build/locale --display headless --size 480x320 \
		--board "$work/board.ini" --release "$small/release" --trust "$small/release/root/1.json" \
		--state "$work/state" --idle-s 5 --touch-replay "$work/$2.touch" --log debug \
		>"$work/$2.json" 2>"$work/$2.log"
}

# holds EVENTS SEED: plays it and fails if anything is wrong.
holds() {
	local events=$1 seed=$2 status=0
	play "$events" "$seed" || status=$?
	# The leak checker itself sometimes crashes while it stops llvmpipe's threads: that says nothing about the
	# kiosk.
	if [ "$status" -ne 0 ] && grep -q 'LeakSanitizer has encountered a fatal error' "$work/$seed.log"; then
		status=0
		play "$events" "$seed" || status=$?
	fi
	cat "$work/$seed.json"
	[ "$status" -eq 0 ] || { tail -n 40 "$work/$seed.log"; fail "after EVENTS=$events SEED=$seed: status $status"; }
	! grep -qE 'Sanitizer|runtime error' "$work/$seed.log" ||
		{ grep -E -A 20 'Sanitizer|runtime error' "$work/$seed.log"; fail "EVENTS=$events SEED=$seed"; }
}

# reached: succeeds if the touches reached every kind of control.
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

# What a touch meets depends on how soon the temple is loaded, which the simulated clock does not control. If the first
# seeds reach too little, others follow.
events=${EVENTS:-1000} first=${SEED:-4}
for seed in $(seq "$first" $((first + 3))); do
	holds "$events" "$seed"
	! reached || exit 0
done
fail "such fingers test little"
