#!/bin/bash
# make fuzz: each fuzz target under libFuzzer, with AddressSanitizer and UndefinedBehaviorSanitizer.
#
#   TIME=SECONDS  for each target (60)      TARGET=NAME  only tests/fuzz/fuzz_NAME.c
#   RUNS=N        a target ends after so many, too (no limit)
#   KEEP=yes      what reached new edges and is small goes into tests/fuzz/corpus/NAME
#
# A target starts from tests/fuzz/corpus/NAME and from what earlier runs found (build/fuzz/NAME/corpus);
# tests/fuzz/dictionaries/NAME, where there is one, has the words of its format. A line each tells what
# the run reached. What crashed, hung or leaked lies in build/fuzz/NAME/, and the command fails.
set -u
cd "$(dirname "$0")/../.."
out=build/fuzz
time=${TIME:-60}
[[ $time =~ ^[1-9][0-9]*$ ]] || { echo "TIME=$time: give whole seconds" >&2; exit 2; }
[[ ${RUNS:-1} =~ ^[1-9][0-9]*$ ]] || { echo "RUNS=$RUNS: give a whole number" >&2; exit 2; }
INPUT_BYTES_MAX=4096 # of an input that is kept
CORPUS_BYTES_MAX=24000 CORPUS_FILES_MAX=60 # of a target's corpus, past which nothing is added
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1:quarantine_size_mb=16 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0

names=${TARGET:-$(find tests/fuzz -name 'fuzz_*.c' -printf '%f\n' | sed 's/^fuzz_//; s/\.c$//' | sort)}
programs=()
for name in $names; do
	[ -f "tests/fuzz/fuzz_$name.c" ] || { echo "TARGET=$name: there is no tests/fuzz/fuzz_$name.c" >&2; exit 2; }
	programs+=("$out/tests/fuzz/fuzz_$name")
done
make --no-print-directory -j"${JOBS:-$(nproc)}" FUZZER=yes BUILD="$out" "${programs[@]}" >"$out.log" 2>&1 ||
	{ tail -n 30 "$out.log" >&2; exit 1; }

# stat NAME LOG: a final statistic of libFuzzer.
stat() { sed -n "s/^stat::$1: *//p" "$2" | tail -n 1; }
# status FIELD LOG: of the last line of progress, such as "#1234 DONE cov: 567 ft: 890 corp: 12/3456b".
status() { grep -E '^#[0-9]+' "$2" | grep -oE " $1: [0-9]+" | tail -n 1 | grep -oE '[0-9]+$'; }

# New inputs that reach an edge that no kept input reaches: the smallest first, while there is room.
keep() { # NAME
	local kept=tests/fuzz/corpus/$1 merged=$out/$1/merged bytes file name
	rm -rf "$merged"
	cp -r "$kept" "$merged"
	"$out/tests/fuzz/fuzz_$1" -merge=1 -use_counters=0 -close_fd_mask=3 -max_len="$INPUT_BYTES_MAX" \
		"$merged" "$out/$1/corpus" >"$out/$1/merge.log" 2>&1
	bytes=$(cat "$kept"/* | wc -c)
	while read -r file; do
		name=$(basename "$file")
		[ -e "$kept/$name" ] && continue
		bytes=$((bytes + $(wc -c <"$file")))
		[ "$bytes" -le "$CORPUS_BYTES_MAX" ] && [ "$(find "$kept" -type f | wc -l)" -lt "$CORPUS_FILES_MAX" ] || break
		cp "$file" "$kept/found-${name:0:8}"
	done < <(find "$merged" -type f -size -"$((INPUT_BYTES_MAX + 1))"c -printf '%s %p\n' | sort -n | cut -d ' ' -f 2)
}

run() { # NAME
	local folder=$out/$1 program=$out/tests/fuzz/fuzz_$1 log=$out/$1/log words=tests/fuzz/dictionaries/$1 rc
	mkdir -p "$folder/corpus"
	"$program" -max_total_time="$time" -runs="${RUNS:--1}" -timeout=25 -rss_limit_mb=2048 -print_final_stats=1 -close_fd_mask=3 \
		-artifact_prefix="$folder/" ${words:+$([ -f "$words" ] && echo "-dict=$words")} \
		"$folder/corpus" "tests/fuzz/corpus/$1" >"$log" 2>&1 </dev/null
	rc=$?
	printf '%-14s %10s %7s %7s %7s\n' "$1" "$(stat number_of_executed_units "$log")" "$(status cov "$log")" \
		"$(find "$folder/corpus" -type f | wc -l)" "$(stat peak_rss_mb "$log")"
	if [ "$rc" -ne 0 ]; then
		bad=1
		grep -E 'ERROR:|SUMMARY:|runtime error:' "$log" | head -n 3
		echo "  the whole report: $log; again: $program $(grep -oE 'Test unit written to .*' "$log" | sed 's/.* //')"
	fi
	[ "${KEEP:-}" != yes ] || keep "$1"
}

bad=0
printf '%-14s %10s %7s %7s %7s\n' target runs edges inputs MB
for name in $names; do run "$name"; done
exit "$bad"
