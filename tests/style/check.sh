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
	complain "clang-format is missing (see tests/tools.txt)"
fi

# ---- the include table: FOLDER may include FOLDERS (itself always)
may_include() { # its answer is in $answer: a subshell for each of thousands of lines would take a minute
	answer=
	case $1 in
	base) ;;
	format | board | input | sound | health) answer="base" ;;
	system) answer="base board" ;;
	tuf) answer="base" ;;
	geometry | ui) answer="base format" ;;
	render | storage) answer="base format geometry" ;;
	net) answer="base format storage" ;;
	app) answer="base format tuf geometry board system render ui input sound storage net" ;;
	pipeline) answer="base format tuf geometry render storage" ;;
	curator) answer="base format geometry render ui storage pipeline" ;;
	tests) answer="base format tuf geometry board system render ui input sound storage net app pipeline curator health" ;;
	esac
}
# The same for the rooms of a folder: a room sees those that are named here; the folder's own files see every room.
may_enter() {
	answer=
	case $1 in
	render/lumigraph) answer="display plan patches" ;;
	render/patches) answer="display plan" ;;
	render/scenery) answer="display lumigraph patches" ;;
	render/scene) answer="display plan patches lumigraph scenery" ;;
	pipeline/import) answer="keys scene" ;; # refuses to hand one to the reader of a scan
	pipeline/content) answer="import octree" ;;
	pipeline/octree | pipeline/deform) answer="import" ;;
	pipeline/texmesh) answer="import material samples" ;;
	pipeline/hierarchy) answer="import material" ;;
	pipeline/samples) answer="import content material hierarchy" ;;
	pipeline/release) answer="keys import content hierarchy samples" ;;
	pipeline/report) answer="import content hierarchy samples release" ;;
	pipeline/temple) answer="material" ;;
	curator/view | curator/region) answer="select" ;;
	curator/api) answer="accounts" ;;
	curator/publish) answer="accounts api" ;;
	curator/session) answer="accounts api select store view region" ;;
	curator/pages) answer="accounts api session store" ;;
	curator/server) answer="accounts api pages publish session" ;;
	app/modes) answer="settings view" ;;
	app/settings) answer="release visit" ;; # what gopura.conf says is checked by those whom it is for
	app/visit | app/release) answer="view" ;;
	esac
}
# What may be included of a room from outside it; a room that is not named here: all but what is private.
# Private headers are named *_private.h or *_parts.h.
is_public() {
	local names name=${1##*/}
	case $1 in
	*_private.h | *_parts.h) return 1 ;;
	pipeline/import/*) names="alignment import_scenery json manifest import import_report mesh mesh_edges mesh_file mesh_places face_list ply sandbox scan_look transform" ;;
	pipeline/scene/*) names="vrml vrml_text vrml_surface vrml_scenery vrml_views scene_views gltf_views gltf gltf_scenery scenery_maker soup" ;;
	pipeline/content/*) names="content scans sources info_build part_faces spoken_sound tour_check annotations annotations_export annotations_import start_view work_lock" ;;
	pipeline/hierarchy/*) names="master master_cut normal_cone stream_encode" ;;
	pipeline/samples/*) names="model model_master pieces raster sight chunks sampler sample_store tile_choice tile_use reference sampling_forecast sampling_trial portrait scale_space tile_quality" ;;
	pipeline/release/*) names="delegation publish_content verify inspect inspect_release release_look" ;;
	pipeline/report/*) names="report" ;;
	pipeline/octree/*) names="reconstruct closed_surface budget_mesh mesh_ply" ;;
	pipeline/deform/*) names="deform deform_plan mesh_obj" ;;
	pipeline/texmesh/*) names="texmesh" ;;
	pipeline/keys/*) names="exchange_folder keys keys_exchange keys_place keys_team keys_tuf signing" ;;
	pipeline/material/*) names="material" ;;
	pipeline/temple/*) names="temple" ;;
	*) return 0 ;;
	esac
	case " $names " in *" ${name%.h} "*) return 0 ;; *) return 1 ;; esac
}
# room PATH: folder/room of a file, or its folder
room() { case $1 in */*/*) answer=${1%/*} ;; *) answer=${1%%/*} ;; esac }
declare -A included # FILE: what it includes of ours
while IFS=: read -r file include; do
	include=${include#*\"}
	included[$file]+=" ${include%%\"*}"
done < <(printf '%s\n' $files | xargs grep -HE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"')
for file in $files; do
	folder=${file%%/*}
	may_include "$folder"
	allowed=" $folder $answer "
	room "$file"
	room=$answer
	may_enter "$room"
	entered=" ${room##*/} $answer "
	for include in ${included[$file]:-}; do
		[ -f "$include" ] || { complain "$file: include \"$include\": name it from the top of the tree"; continue; }
		case $allowed in *" ${include%%/*} "*) ;; *) complain "$file: ${folder} may not include $include" ;; esac
		if [ "${include%%/*}" = "$folder" ] && [ "$folder" != tests ] && [ "$room" != "$folder" ]; then
			room "$include"
			inner=$answer
			[ "$inner" != "$folder" ] || inner=.
			case $entered in *" ${inner##*/} "*) ;; *) complain "$file: $room may not include $include" ;; esac
		fi
		if [ "$folder" != tests ] && [ "${include%/*}" != "$room" ] && ! is_public "$include"; then
			complain "$file: $include is private to ${include%/*}"
		fi
		case "$include $file" in
		"app/kiosk.h app/kiosk.c" | "app/kiosk.h app/main.c" | "app/kiosk.h tests/"*) ;;
		"app/kiosk.h "*) complain "$file: only the main program sees the whole kiosk: take what you need as parameters" ;;
		esac
		if [ "$folder" = app ] && [ "${include%%/*}" = net ] && [ "$include" != net/client.h ]; then
			complain "$file: of net, app may include only net/client.h"
		fi
	done
done
out=$(printf '%s\n' $files | grep '\.h$' | xargs grep -L '^#ifndef GOPURA_')
[ -z "$out" ] || complain "no include guard GOPURA_...:" "$out"
out=$(grep -nE '\blog_(error|warn|info|debug)\(' format/*.c)
[ -z "$out" ] || complain "format never logs:" "$out"

# ---- a source has a header of its own: NAME.c has NAME.h beside it
# Main programs, tests and the commands that pipeline/commands.h lists have none.
for file in $files; do
	case $file in
	tests/* | */main.c | pipeline/command_*.c) continue ;;
	*.c) [ -f "${file%.c}.h" ] || complain "$file: has no ${file%.c}.h" ;;
	esac
done

# ---- one name, one file
out=$(printf '%s\n' $files | grep -v '/main\.c$' | sed 's|.*/||' | sort | uniq -d)
[ -z "$out" ] || complain "two files of one name:" "$out"

# ---- texts of the kiosk: the template is the sources', and every language has every text
if command -v xgettext >/dev/null; then
	[ -z "$(ui/po/extract.sh | diff -q - ui/po/gopura.pot)" ] || complain "ui/po is older than the sources: run 'make po', then translate"
	for language in ui/po/*.po; do
		out=$(msgfmt -c -o /dev/null "$language" 2>&1 && msgcmp "$language" ui/po/gopura.pot 2>&1) ||
			complain "$language is not complete:" "$out"
	done
else
	complain "gettext is missing (see packages.txt)"
fi

# ---- what may not stand in a source
out=$(git grep -nIE '\b(TODO|FIXME|XXX|HACK)\b' -- '*.c' '*.h' '*.sh' '*.py' '*.js' Makefile ':!tests/style' | head -5)
[ -z "$out" ] || complain "unfinished by its own words:" "$out"
out=$(git grep -nE '\b(strcpy|strcat|sprintf|gets|strtok|atoi|atof)\(' -- '*.c' | head -5)
[ -z "$out" ] || complain "banned functions (use the bounded or checked ones):" "$out"

out=$(git grep -nE '\b(glm_|cglm/)' -- '*.[ch]' | head -5)
[ -z "$out" ] || complain "vectors are geometry/vec.h's:" "$out"

[ "$bad" = 0 ] && echo "style: $(printf '%s\n' $files | wc -l) files, clean"
exit "$bad"
