#!/bin/bash
# check.sh: checks that two builds from scratch give the same slot, byte by byte. With MIRROR at a date of
# snapshot.debian.org the builds may be on different days; without, both must see the same state of the mirror.
set -eu
cd "$(dirname "$0")/.."
work=build/image-check
rm -rf "$work"
for turn in 1 2; do
	OUT=$work/$turn TRACKER=no image/build.sh
done
cmp "$work/1/packages.txt" "$work/2/packages.txt" || { echo "image: the mirror changed between the builds: run this again" >&2; exit 1; }
failed=0
for file in root.squashfs boot.img; do
	if cmp "$work/1/$file" "$work/2/$file"; then
		echo "$file is the same: $(sha256sum <"$work/1/$file" | cut -c1-32)"
	else
		failed=1
	fi
done
[ $failed = 0 ] || diff -rq --no-dereference "$work/1/tree" "$work/2/tree" >&2 || true
exit $failed
