#!/bin/bash
# The test runner: runs every part, prints a line each, ends with "N passed, N failed, N skipped".
#
#   tests/run.sh quick   style, and the unit tests and fuzz corpora under sanitizers
#   tests/run.sh all     those, the unit tests as built for the field, and tests/e2e, tests/qemu
#   tests/run.sh only NAME...   the tests alone whose path has one of these words in it: test_cut, e2e/kiosk, net/
#
# A test passes with exit status 0, skips with 77 (its last line says why), fails otherwise. Unit
# tests, end-to-end tests and machines in QEMU run beside one another: each has a port and a folder of its own.
set -u
cd "$(dirname "$0")/.."
logs=$PWD/build/test-logs
jobs=$(nproc)
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=0 UBSAN_OPTIONS=print_stacktrace=1
# Third-party libraries keep small one-time allocations; ours are never listed there.
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0

# run_one NAME SECONDS COMMAND...: a line on the terminal, a log and a verdict beside it.
run_one() {
	local name=$1 limit=$2 log=$logs/${1//\//-}.log start=$SECONDS status
	shift 2
	timeout --kill-after=10 "$limit" "$@" >"$log" 2>&1 </dev/null
	status=$?
	# The leak checker itself dies now and then while it stops the threads of Mesa's llvmpipe
	# ("Tracer caught signal 11"): that says nothing of the test, which is run once more.
	if [ "$status" -ne 0 ] && grep -q 'LeakSanitizer has encountered a fatal error' "$log"; then
		timeout --kill-after=10 "$limit" "$@" >"$log" 2>&1 </dev/null
		status=$?
	fi
	case $status in
	0) echo passed >"$log.verdict"; printf '  pass  %-44s %3d s\n' "$name" $((SECONDS - start)) ;;
	77) echo skipped >"$log.verdict"; printf '  skip  %-44s %s\n' "$name" "$(tail -n 1 "$log")" ;;
	*) echo failed >"$log.verdict"
		printf '  FAIL  %-44s exit %s, %d s\n%s\n' "$name" "$status" $((SECONDS - start)) \
			"$(tail -n 30 "$log" | sed 's/^/        /')" ;;
	esac
}
if [ "${1:-}" = one ]; then
	shift
	run_one "$@"
	exit 0
fi

# unit BUILD LABEL [WORDS]: the programs of tests/ as built there, or those whose path has one of the words.
unit() {
	local program
	{
		find tests -name 'test_*.c' | sort | while read -r program; do
			program=${program%.c}
			echo "$2/${program#tests/} 600 $1/$program"
		done
		find tests/fuzz -name 'fuzz_*.c' | sort | while read -r program; do
			program=${program%.c}
			echo "$2/${program#tests/} 600 $1/$program tests/fuzz/corpus/${program#tests/fuzz/fuzz_}"
		done
	} | grep -E "${3:-.}" | xargs -r -P "$jobs" -L 1 tests/run.sh one
}

if [ "${1:-}" = lane ]; then
	shift
	# A machine in QEMU has watchdogs and deadlines in real time: it goes before tests that only compute.
	for name; do
		case $name in
		units)
			unit build/asan san
			unit build unit
			;;
		release-*)
			run_one "$name" 2400 env -u RELEASES_MADE nice -n 5 bash -c ". tests/e2e/lib.sh; ${name#release-}_release"
			;;
		qemu/arm64 | e2e/*)
			case $name in e2e/weak | e2e/pictures) release=demo ;; *) release=small ;; esac
			until [ -z "${RELEASES_MADE:-}" ] || [ -e "$logs/release-$release.log.verdict" ]; do sleep 1; done
			run_one "$name.sh" 2400 nice -n 5 bash "tests/$name.sh"
			;;
		*) run_one "$name.sh" 2400 bash "tests/$name.sh" ;;
		esac
	done
	exit 0
fi

scripts() { find tests/e2e tests/qemu -name '*.sh' ! -name 'lib*.sh' ! -name 'make-*.sh' | sed 's/^tests\///; s/\.sh$//' | sort; }

mode=${1:-all}
began=$SECONDS
rm -rf "$logs"
mkdir -p "$logs"
count() { cat "$logs"/*.verdict | grep -c "$1"; }
summary() {
	printf '\n%d minutes %d seconds\n' $(((SECONDS - began) / 60)) $(((SECONDS - began) % 60))
	echo "$(count passed) passed, $(count failed) failed, $(count skipped) skipped"
	[ "$(count failed)" -eq 0 ]
}

if [ "$mode" = only ]; then
	shift
	words=$(IFS='|'; echo "$*")
	programs=$(find tests -name 'test_*.c' -o -path 'tests/fuzz/fuzz_*.c' | sed 's/\.c$//' | grep -E "$words")
	chosen=$(scripts | grep -E "$words")
	[ -n "$programs$chosen" ] || { echo "no test has '$words' in its path below tests/" >&2; exit 2; }
	if [ -n "$programs" ]; then
		# shellcheck disable=SC2086
		make --no-print-directory -j"$jobs" SAN=1 BUILD=build/asan ${programs//tests\//build\/asan\/tests\/} >"$logs/build.log" 2>&1 ||
			{ tail -n 30 "$logs/build.log"; exit 1; }
		unit build/asan san "tests/($(paste -sd'|' <<<"${programs//tests\//}"))( |$)"
	fi
	if [ -n "$chosen" ]; then
		make --no-print-directory -j"$jobs" all tests >"$logs/build.log" 2>&1 || { tail -n 30 "$logs/build.log"; exit 1; }
		xargs -L 1 tests/run.sh lane <<<"$chosen"
	fi
	summary
	exit
fi

run_one check-style 120 tests/style/check.sh
run_one build-sanitized 1500 make --no-print-directory -j"$jobs" SAN=1 BUILD=build/asan all tests
run_one check-circles 120 tests/style/circles.py build/asan/obj
if [ "$mode" = all ]; then
	run_one build-field 1500 make --no-print-directory -j"$jobs" tests benches
	export RELEASES_MADE=yes
	# A line is what runs in turn, as it shares what it makes. What computes has a lane for each core, those that
	# take long first; beside it, in as many lanes, runs what mostly waits. End-to-end tests wait for their release.
	computes=$(printf '%s\n' 'qemu/kiosk qemu/image qemu/disks qemu/powercut' 'release-small release-demo' units e2e/golden \
		qemu/arm64 e2e/weak e2e/pictures e2e/monkey e2e/tours e2e/tools e2e/scans e2e/visitor e2e/back)
	lanes() { xargs -P "$1" -L 1 tests/run.sh lane; }
	lanes "$jobs" <<<"$computes" &
	{ echo e2e/switch; scripts; } | awk '!seen[$0]++' | grep -vxF "$(tr ' ' '\n' <<<"$computes")" | lanes "$jobs" &
	wait
else
	unit build/asan san
fi

summary
