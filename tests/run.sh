#!/bin/bash
# The test runner. It prints one line for each test and ends with "N passed, N failed, N skipped".
#
#   tests/run.sh quick          style; unit tests and fuzz corpora under sanitizers
#   tests/run.sh all            the same, then the unit tests as built for release, tests/e2e and tests/qemu
#   tests/run.sh only NAME...   only tests whose path contains one of the names: test_cut, e2e/kiosk, net/
#
# A test passes with exit status 0. With 77 it is skipped, and its last line says why. Any other status is a failure.
# The end names the ten tests that took most processor time.
# Unit tests, end-to-end tests and virtual machines run at the same time; each uses its own port and its own folder.
set -u
cd "$(dirname "$0")/.."
logs=$PWD/build/test-logs
jobs=$(nproc)
# A small quarantine of freed memory still finds its uses, and saves half of the kernel's time, which went into fresh
# pages and into copying their tables at each fork.
# Without intercept_tls_get_addr=0 the leak checker takes garbage for the thread-local memory of Mesa's libraries, and
# crashes.
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=0:quarantine_size_mb=16:intercept_tls_get_addr=0 UBSAN_OPTIONS=print_stacktrace=1
# The file lists third-party libraries that keep small one-time allocations, and none of our own code.
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0

# children_s FILE: seconds of processor time of what a shell started and waited for, by the output of its `times`.
children_s() { awk -F '[ms ]+' 'NR == 2 { printf "%d", $1 * 60 + $2 + $3 * 60 + $4 }' "$1"; }

# run_one NAME SECONDS COMMAND...: runs a test, prints its line, and writes its log and, beside that, its verdict.
run_one() {
	local name=$1 limit=$2 log=$logs/${1//\//-}.log start=$SECONDS cpu status
	shift 2
	times >"$log.times" # not in a subshell, which has times of its own
	cpu=$(children_s "$log.times")
	timeout --kill-after=10 "$limit" "$@" >"$log" 2>&1 </dev/null
	status=$?
	# The leak checker itself sometimes crashes while it stops the threads of Mesa's llvmpipe ("Tracer caught signal
	# 11"). That says nothing about the test, so the test runs once more.
	if [ "$status" -ne 0 ] && grep -q 'LeakSanitizer has encountered a fatal error' "$log"; then
		timeout --kill-after=10 "$limit" "$@" >"$log" 2>&1 </dev/null
		status=$?
	fi
	times >"$log.times"
	cpu=$(($(children_s "$log.times") - cpu))
	echo "$cpu $name" >"$log.cpu"
	case $status in
	0) echo passed >"$log.verdict"; printf '  pass  %-44s %3d s, %d of processor\n' "$name" $((SECONDS - start)) "$cpu" ;;
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

# What takes long runs once in "all", where it finds most: pictures and arithmetic as built for release (kiosks run under
# sanitizers in e2e/kiosk and e2e/monkey); state machines and files under sanitizers.
only_unit='tests/(render/scene/test_scene(|_tools|_scenery)|render/scenery/test_materials|pipeline/octree/test_(closed_surface|reconstruct)|pipeline/samples/test_sampler|pipeline/hierarchy/test_master|ui/test_(comfort|tools_view))( |$)'
only_san='tests/(pipeline/hierarchy/test_hierarchy_file|storage/test_(cache|powercut)|pipeline/temple/test_temple|system/test_setup|pipeline/content/test_demo_content|pipeline/release/test_publish_labels|base/test_spill)( |$)'

# unit BUILD LABEL [PATTERN] [COUNT] [EXCEPT]: runs the test programs in BUILD, or only those whose path matches PATTERN; so many
# at once, by default one for each core; without those that match EXCEPT.
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
	} | grep -E "${3:-.}" | grep -vE "${5:-^$}" | nice -n 5 xargs -r -P "${4:-$jobs}" -L 1 tests/run.sh one
}

if [ "${1:-}" = lane ]; then
	shift
	# A virtual machine has watchdogs and deadlines in real time, so tests that only compute get a lower priority.
	for name; do
		case $name in
		units)
			unit build/asan san "" "" "$only_unit"
			unit build unit "" "" "$only_san"
			;;
		release-small)
			run_one "$name" 2400 env -u RELEASES_MADE nice -n 5 bash -c ". tests/e2e/lib.sh; small_release"
			;;
		qemu/arm64) run_one "$name.sh" 2400 nice -n 5 bash "tests/$name.sh" ;;
		e2e/*)
			until [ -z "${RELEASES_MADE:-}" ] || [ -e "$logs/release-small.log.verdict" ]; do sleep 1; done
			run_one "$name.sh" 2400 nice -n 5 bash "tests/$name.sh"
			;;
		*) run_one "$name.sh" 2400 bash "tests/$name.sh" ;;
		esac
	done
	exit 0
fi

# Campaigns, which take long or of which the other tests take a sample, are in targets of make alone; "only" runs one here too.
campaigns='qemu/powercut qemu/raspberry_pi qemu/tpm qemu/worn'
scripts() { find tests/e2e tests/qemu -name '*.sh' ! -name 'lib*.sh' ! -name 'make-*.sh' | sed 's/^tests\///; s/\.sh$//' | sort; }

mode=${1:-all}
began=$SECONDS
rm -rf "$logs"
mkdir -p "$logs"
count() { cat "$logs"/*.verdict | grep -c "$1"; }
summary() {
	printf '\n%d minutes %d seconds, %d s of processor; the dearest:\n' $(((SECONDS - began) / 60)) \
		$(((SECONDS - began) % 60)) "$(cat "$logs"/*.cpu | awk '{ sum += $1 } END { print sum }')"
	cat "$logs"/*.cpu | sort -rn | head -n 10 | awk '{ printf "  %4d s  %s\n", $1, $2 }'
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

run_one check-style 600 tests/style/check.sh &
run_one build-sanitized 1500 make --no-print-directory -j"$jobs" SAN=1 BUILD=build/asan all tests
wait
run_one check-circles 120 tests/style/circles.py build/asan/obj
if [ "$mode" = all ]; then
	run_one build-field 1500 make --no-print-directory -j"$jobs" tests benches
	export RELEASES_MADE=yes
	# The tests of one line run one after another, because each uses what those before it made. There is one lane for
	# each core for tests that compute, the longest first. Tests that mostly wait run beside them in as many lanes
	# again. An end-to-end test waits until the release that it uses is made.
	computes=$(printf '%s\n' 'qemu/kiosk qemu/image qemu/disks qemu/loader' release-small units e2e/golden \
		qemu/arm64 e2e/weak e2e/pictures e2e/monkey e2e/tours e2e/tools e2e/scans e2e/visitor e2e/back)
	lanes() { xargs -P "$1" -L 1 tests/run.sh lane; }
	lanes "$jobs" <<<"$computes" &
	{ echo e2e/switch; scripts; } | awk '!seen[$0]++' | grep -vxF "$(tr ' ' '\n' <<<"$computes $campaigns")" | lanes "$jobs" &
	wait
else
	unit build/asan san . $((jobs + 1)) # some wait instead of computing
fi

summary
