#!/bin/bash
# Builds are killed at random moments, or meet a full disk, and are then run again: the release is that of an
# undisturbed build, byte for byte, and what was published before stays whole meanwhile.
#
#   KILLS=4 FULL=2 SEED=1 tests/e2e/interrupted.sh     (`make interrupted` for many)
set -eu
cd "$(dirname "$0")/../.."
# A mount of its own for the full disk, which goes with the test.
if [ -z "${INTERRUPTED_MOUNTS:-}" ]; then
	export INTERRUPTED_MOUNTS=no
	map=$([ "$(id -u)" = 0 ] || echo --map-root-user)
	# shellcheck disable=SC2086
	if unshare -m $map mount -t tmpfs -o size=1m none /mnt 2>/dev/null; then
		export INTERRUPTED_MOUNTS=yes
		exec unshare -m $map bash "$0"
	fi
fi
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
kills=${KILLS:-4} full=${FULL:-2} seed=${SEED:-1}
RANDOM=$seed
content=$PWD/build/gopura-content
folder=$PWD/build/e2e/interrupted
rm -rf "$folder"
mkdir -p "$folder/disk"
echo "seed $seed"

# Stages that a round may begin at: nothing made yet; all made, and a title changed.
tiny_content "$folder/first" 10000 2000
touch -d '2026-01-01' "$folder"/first/*
# build BASE: content, release and keys are there. begin does the same in the background, as process $!.
build() { begin "$1" && wait "$!"; }
begin() { "$content" build "$1/content" --jobs 2 --out "$1/release" --keys "$1/keys" & }
now_ms() { date +%s%3N; }
for stage in first second; do
	mkdir -p "$folder/$stage-begin"
	if [ "$stage" = first ]; then
		mv "$folder/first" "$folder/first-begin/content"
		mkdir "$folder/first-begin/release"
		"$content" keys "$folder/first-begin/content" --keys "$folder/first-begin/keys" >/dev/null
	else
		cp -rp "$folder/first-end/." "$folder/second-begin"
		sed -i 's/"Tower"/"High tower"/' "$folder/second-begin/content/parts.json"
	fi
	cp -rp "$folder/$stage-begin" "$folder/$stage-end"
	began=$(now_ms)
	build "$folder/$stage-end" >"$folder/log" 2>&1 || { cat "$folder/log"; fail "an undisturbed build"; }
	eval "${stage}_ms=$(($(now_ms) - began))"
	"$content" verify "$folder/$stage-end/release" >/dev/null || fail "an undisturbed release"
done

# resume STAGE BASE WHAT: what is published is whole; another run makes the rest.
resume() {
	[ ! -f "$2/release/timestamp.json" ] || "$content" verify "$2/release" >"$folder/verified" 2>&1 ||
		{ cat "$folder/verified"; fail "$3: what is published is not whole"; }
	build "$2" >"$folder/log" 2>&1 || { cat "$folder/log"; fail "$3: cannot be resumed"; }
	same_release "$folder/$1-end/release" "$2/release" || fail "$3: another release"
	"$content" verify "$2/release" >/dev/null || fail "$3: the release is not whole"
}

stage_of() { [ $(($1 % 3)) = 0 ] && echo second || echo first; }

# ---- kill -9: by turns the process alone, whose children must go with it, and the whole group
killed=0 late=0 round=0
while [ "$killed" -lt "$kills" ]; do
	round=$((round + 1))
	[ "$late" -le $((kills + 10)) ] || fail "the builds end before they are killed"
	stage=$(stage_of "$round") base=$folder/round
	length_ms=${stage}_ms
	at_ms=$(((RANDOM * 32768 + RANDOM) % ${!length_ms}))
	rm -rf "$base"
	cp -rp "$folder/$stage-begin" "$base"
	set -m
	begin "$base" >"$folder/log" 2>&1
	pid=$!
	set +m
	sleep "$((at_ms / 1000)).$(printf %03d $((at_ms % 1000)))"
	who=$pid
	[ $((round % 2)) = 0 ] || who=-$pid
	kill -9 -- "$who" 2>/dev/null || true
	status=0
	wait "$pid" 2>/dev/null || status=$?
	if [ "$status" != 137 ]; then
		late=$((late + 1))
		continue
	fi
	killed=$((killed + 1))
	resume "$stage" "$base" "killed after $at_ms ms of the $stage build"
done

# ---- a full disk: room for only a part of what the build writes
filled=0
[ "$INTERRUPTED_MOUNTS" = yes ] || full=0
# Bytes that a folder takes on such a disk.
bytes_of() {
	mount -t tmpfs none "$folder/disk"
	cp -rp "$1/." "$folder/disk"
	df --output=used -B1 "$folder/disk" | tail -n 1
	umount "$folder/disk"
}
while [ "$filled" -lt "$full" ]; do
	filled=$((filled + 1))
	stage=$(stage_of "$((filled + 1))") base=$folder/disk
	least=$(bytes_of "$folder/$stage-begin") most=$(bytes_of "$folder/$stage-end")
	size=$((least + (RANDOM * 32768 + RANDOM) % ((most - least) / 4096) * 4096))
	mount -t tmpfs -o "size=$size" none "$base"
	cp -rp "$folder/$stage-begin/." "$base"
	status=0
	build "$base" >"$folder/log" 2>&1 || status=$?
	what="a disk of $size bytes in the $stage build"
	[ "$status" = 1 ] || { cat "$folder/log"; fail "$what: ended with $status"; }
	grep -qi 'no space left' "$folder/log" || { cat "$folder/log"; fail "$what: the message does not say so"; }
	mount -o remount,size=1g "$base"
	resume "$stage" "$base" "$what"
	umount "$base"
done
# ---- what a kill left of a file goes, unless it is young: a shard may be writing it (docs/cluster.md)
work=$folder/first-end/content/.work
for name in mesh samples/00-00-00 master/groups; do
	touch "$work/$name.NewOne"
	touch -d '2 hours ago' "$work/$name.OldOne"
done
build "$folder/first-end" >/dev/null 2>&1 || fail "a build with leftovers"
[ -z "$(find "$work" -name '*.OldOne')" ] || fail "what was left of files stays"
[ -e "$work/mesh.NewOne" ] && [ -e "$work/samples/00-00-00.NewOne" ] || fail "the file of another shard is gone"
[ "$INTERRUPTED_MOUNTS" = yes ] || echo "no full disk was tried: mounting is not allowed here"
echo "$killed kills, $filled full disks: each time the same release"
