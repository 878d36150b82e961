#!/bin/bash
# A release of so many bytes: budgets are met within 2 %, whatever the number of jobs, by all rules; what cannot be met
# is refused with the smallest size that can.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/budget
content=$work/content
rm -rf "$work"
mkdir -p "$content"
build/gopura-content temple --triangles 20000 --out "$content/temple.ply" >/dev/null
cat >"$content/temple.ini" <<'INI'
[model]
scans = temple.ply
[grid]
points = 4
face_px = 256
effort = quick
INI

# build NAME OPTIONS: into $work/NAME; sets bytes, those of its packs.
build() {
	local name=$1
	shift
	build/gopura-content build "$content" --out "$work/$name" --keys "$work/keys" "$@" >"$work/$name.txt" 2>&1 || {
		cat "$work/$name.txt"
		fail "$name was not built"
	}
	bytes=$(cat "$work/$name"/packs/* | wc -c)
	build/gopura-content verify "$work/$name" >/dev/null || fail "$name is not whole"
}
# met NAME BUDGET: $bytes are at most the budget, and at least 98 % of it.
met() {
	[ "$bytes" -le "$2" ] && [ $((bytes * 100)) -ge $(($2 * 98)) ] || fail "$1 has $bytes bytes, not nearly $2"
}

# ---- what is no size, and what is far too small, before any work
for size in 80 MB -5MB 5mb 1.MB 0MB 1e6B '5 M B'; do
	! build/gopura-content build "$content" --budget "$size" >/dev/null 2>"$work/wrong.txt" || fail "'$size' was taken for a size"
	grep -q 'must be a size such as 80MB' "$work/wrong.txt" || fail "'$size' is not named"
done
! build/gopura-content build "$content" --keys "$work/keys" --out "$work/none" --budget 10kB >/dev/null 2>"$work/small.txt" ||
	fail "10 kB were enough"
grep -q 'too small: a release of this content has at least about' "$work/small.txt" || { cat "$work/small.txt"; fail "no smallest size"; }
[ ! -e "$content/.work/samples" ] && [ ! -e "$work/none" ] || fail "it worked before it refused"
build/gopura-content build "$content" --budget 300kB --dry-run >"$work/dry.txt"
grep -q '^budget: 0.3 MB; at least about' "$work/dry.txt" || { cat "$work/dry.txt"; fail "a dry run does not know of the budget"; }

# ---- two budgets between the smallest and the largest release
build most --budget 1GB --jobs 2
most=$bytes
least=$(sed -n 's/.*possible were \([0-9.]*\) to .*/\1/p' "$work/most.txt")
for share in 60 85; do
	budget=$((most * share / 100))
	build at$share --budget ${budget}B --jobs 1
	met "$share %" "$budget"
done
# Samples and all, in shards and with other jobs: the same bytes, and the build finds all samples there.
rm -rf "$content/.work"
for shard in 0 1; do
	build/gopura-content sample --for-budget --shard $shard/2 --jobs 1 "$content" >/dev/null 2>&1 || fail "shard $shard"
done
touch "$work/sampled"
build again --budget ${budget}B --jobs 3
[ -z "$(find "$content/.work/samples" -name '*-*-*' -newer "$work/sampled")" ] || fail "the build sampled again"
[ "$(cat "$work"/at85/packs/* | sha256sum)" = "$(cat "$work"/again/packs/* | sha256sum)" ] || fail "jobs change bytes"

# ---- just too small: named exactly, nothing published
! build/gopura-content build "$content" --keys "$work/keys" --out "$work/none" --budget "$(python3 -c "print(int(($least - 0.11) * 1e6))")B" \
	>/dev/null 2>"$work/small.txt" || fail "too small a budget was met"
least=$(sed -n 's/.*give --budget \([0-9.]*MB\) or more.*/\1/p' "$work/small.txt")
[ -n "$least" ] || { cat "$work/small.txt"; fail "the smallest size is not named"; }
[ ! -e "$work/none/release.json" ] || fail "it was published all the same"
build smallest --budget "$least"

# ---- other rules
printf '[samples]\nquality = uniform\n' >>"$content/temple.ini"
for rule in uniform features; do
	sed -i "s/^quality = .*/quality = $rule/" "$content/temple.ini"
	build $rule --budget ${budget}B
	met $rule "$budget"
	! cmp -s <(cat "$work"/at85/packs/*) <(cat "$work"/$rule/packs/*) || fail "the rule $rule changes nothing"
done
similarity() { sed -n 's/.*mean SSIM //p' "$work/$1.txt"; }
awk "BEGIN { exit !($(similarity at85) > $(similarity uniform)) }" ||
	fail "of what is shown, bytes where they gain make $(similarity at85), all alike $(similarity uniform)"
echo "budgets are met: $most bytes at most, $least at least"
