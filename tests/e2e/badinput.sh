#!/bin/bash
# Passes malformed and unusual files to every reader that could meet them, readers of scans under sanitizers: each run
# ends within ten seconds without a crash, and a refusal names the file and the reason. Pictures are also tested as the
# texture of a scan. Every fifth file; "all" (make badinput) takes each.
set -u
cd "$(dirname "$0")/../.."
scans=../shared/scans/badinput
[ -d "$scans" ] || { echo "$scans is absent"; exit 77; }
make --no-print-directory -j"$(nproc)" SAN=1 BUILD=build/asan build/asan/gopura-content >/dev/null || exit 1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# inspect as built for release: the start of a sanitized program takes most of its time, and fuzz_inspect is sanitized.
export folder content=$PWD/build/asan/gopura-content plain=$PWD/build/gopura-content
export ASAN_OPTIONS=detect_leaks=1:abort_on_error=0 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0

# judge STATUS LOG FILE WHAT: complains on standard output, or says nothing.
judge() {
	local status=$1 log=$2 file=$3 what=$4 name
	name=$(basename "$file")
	case $status in
	0) ;;
	1 | 2) grep -qF "$name" "$log" && grep -qE ': .*[a-z]{3}' "$log" ||
		echo "FAIL $what $file: refused without naming the file and the fault: $(tail -n 1 "$log")" ;;
	124 | 137) echo "FAIL $what $file: hangs" ;;
	*) echo "FAIL $what $file: exit status $status" ;;
	esac
	if grep -qE 'Sanitizer|runtime error' "$log"; then
		echo "FAIL $what $file:"
		head -n 30 "$log"
	fi
}

# meet FILE: as a scan, as an object, and, a picture, as a texture.
meet() {
	local file=$1 log status picture
	log=$(mktemp "$folder/log-XXXXXX")
	timeout -k 1 10 "$content" import "$file" >"$log" 2>&1 </dev/null
	judge $? "$log" "$file" import
	timeout -k 1 10 "$plain" inspect "$file" >"$log" 2>&1 </dev/null
	status=$?
	# inspect prints its result to standard output; the name is on the command line.
	echo "$file: inspected" >>"$log"
	judge $status "$log" "$file" inspect
	case $file in *.jpg | *.jpeg | *.png | *.gif)
		picture=$(mktemp -d "$folder/scan-XXXXXX")
		cp "$file" "$picture/skin" # links are not followed
		cat >"$picture/square.ply" <<-END
			ply
			format ascii 1.0
			comment TextureFile skin
			element vertex 3
			property float x
			property float y
			property float z
			property float s
			property float t
			element face 1
			property list uchar int vertex_indices
			end_header
			0 0 0 0 0
			1 0 0 1 0
			0 1 0 0 1
			3 0 1 2
		END
		timeout -k 1 10 "$content" import "$picture/square.ply" >"$log" 2>&1 </dev/null
		status=$?
		judge $status "$log" square.ply texture
		[ $status = 0 ] && grep -qE "colours: 1 picture|its picture 'skin'" "$log" ||
			echo "FAIL texture $file: neither read nor complained about: $(tail -n 1 "$log")"
		rm -rf "$picture" ;;
	esac
	rm -f "$log"
	echo "met $file"
}
export -f meet judge

every=5
[ "${1:-}" != all ] || every=1
find "$scans" -type f ! -name 'SOURCE*' | sort | awk -v every="$every" 'NR % every == 0' >"$folder/files"
xargs -d '\n' -P 2 -n 8 bash -c 'for file; do meet "$file"; done' meet <"$folder/files" >"$folder/results"
grep -v '^met ' "$folder/results"
met=$(grep -c '^met ' "$folder/results")
expected=$(wc -l <"$folder/files")
echo "$met of $expected files met"
! grep -q '^FAIL' "$folder/results" && [ "$met" = "$expected" ] && [ "$met" -gt $((400 / every)) ]
