#!/bin/bash
# The test runner: runs every part, prints a line each, ends with "N passed, N failed, N skipped".
#
#   tests/run.sh quick   style, and the unit tests and fuzz corpora under sanitizers
#   tests/run.sh all     those, the unit tests as built for the field, and tests/e2e/*.sh
#
# A test passes with exit status 0, skips with 77 (its last line says why), fails otherwise.
set -u
cd "$(dirname "$0")/.."
mode=${1:-all}
passed=0 failed=0 skipped=0
logs=build/test-logs
mkdir -p "$logs"
jobs=$(nproc)
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=0 UBSAN_OPTIONS=print_stacktrace=1
# Third-party libraries keep small one-time allocations; ours are never listed there.
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0

# run_one NAME SECONDS COMMAND...
run_one() {
	local name=$1 limit=$2 status start=$SECONDS
	shift 2
	timeout --kill-after=10 "$limit" "$@" >"$logs/${name//\//-}.log" 2>&1 </dev/null
	status=$?
	case $status in
	0) passed=$((passed + 1)); printf '  pass  %-44s %3d s\n' "$name" $((SECONDS - start)) ;;
	77) skipped=$((skipped + 1)); printf '  skip  %-44s %s\n' "$name" "$(tail -n 1 "$logs/${name//\//-}.log")" ;;
	*) failed=$((failed + 1)); printf '  FAIL  %-44s exit %s\n' "$name" "$status"
		tail -n 30 "$logs/${name//\//-}.log" | sed 's/^/        /' ;;
	esac
}

# build VARIANT MAKE_ARGUMENTS...
build() {
	local name=$1
	shift
	run_one "build-$name" 1500 make --no-print-directory -j"$jobs" "$@"
}

unit() { # FOLDER_OF_THE_BUILD LABEL
	local program
	for program in $(find tests -name 'test_*.c' | sort); do
		program=${program%.c}
		run_one "$2/${program#tests/}" 300 "$1/$program"
	done
	for program in $(find tests/fuzz -name 'fuzz_*.c' | sort); do
		program=${program%.c}
		run_one "$2/${program#tests/}" 300 "$1/$program" "tests/fuzz/corpus/${program#tests/fuzz/fuzz_}"
	done
}

run_one check-style 120 tests/style/check.sh
build sanitized SAN=1 BUILD=build/asan tests
unit build/asan san
if [ "$mode" = all ]; then
	build field tests
	unit build unit
	for script in $(find tests/e2e tests/qemu -name '*.sh' ! -name 'lib*.sh' 2>/dev/null | sort); do
		run_one "${script#tests/}" 1200 bash "$script"
	done
fi

echo
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
