#!/bin/bash
# The rules of the tree as a script: white space, who may include whom, and what a source may say.
set -u
cd "$(dirname "$0")/../.."
bad=0
complain() { bad=1; printf '%s\n' "$@"; }

# ---- clang-format settles white space
files=$(git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp')
if command -v clang-format >/dev/null; then
	out=$(printf '%s\n' $files | xargs clang-format --dry-run 2>&1 | grep -E 'warning:' | head -5)
	[ -z "$out" ] || complain "run 'make format':" "$out"
else
	complain "clang-format is missing (see packages.txt)"
fi

# ---- the include table: FOLDER may include FOLDERS (itself always)
may_include() {
	case $1 in
	base) echo ;;
	format | board | input | health) echo base ;;
	render | ui | storage) echo base format ;;
	net) echo base format storage ;;
	app) echo base format board render ui input storage net ;;
	pipeline) echo base format render storage ;;
	curator) echo base format render storage pipeline ;;
	tests) echo base format board render ui input storage net app pipeline curator health ;;
	*) echo ;;
	esac
}
for file in $files; do
	folder=${file%%/*}
	allowed=" $folder $(may_include "$folder") "
	for include in $(sed -nE 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*"([^"]+)".*/\1/p' "$file"); do
		[ -f "$include" ] || { complain "$file: include \"$include\": name it from the top of the tree"; continue; }
		case $allowed in *" ${include%%/*} "*) ;; *) complain "$file: ${folder} may not include $include" ;; esac
		if [ "$folder" = app ] && [ "${include%%/*}" = net ] && [ "$include" != net/client.h ]; then
			complain "$file: of net, app may include only net/client.h"
		fi
	done
	case $file in
	*.h) grep -q '^#ifndef GOPURA_' "$file" || complain "$file: no include guard GOPURA_..." ;;
	esac
	case $file in
	format/*.c) ! grep -nE '\blog_(error|warn|info|debug)\(' "$file" || complain "$file: format never logs" ;;
	esac
done

# ---- what may not stand in a source
out=$(git grep -nIE '\b(TODO|FIXME|XXX|HACK)\b' -- '*.c' '*.h' '*.sh' '*.py' '*.js' Makefile ':!tests/style' | head -5)
[ -z "$out" ] || complain "unfinished by its own words:" "$out"
out=$(git grep -nE '\b(strcpy|strcat|sprintf|gets|strtok|atoi|atof)\(' -- '*.c' | head -5)
[ -z "$out" ] || complain "banned functions (use the bounded or checked ones):" "$out"

[ "$bad" = 0 ] && echo "style: $(printf '%s\n' $files | wc -l) files, clean"
exit "$bad"
