#!/bin/bash
# A server with damaged packs and a kiosk under sanitizers: flipped bytes, a truncated pack, a locator of random bytes.
# Damaged objects are refused and reported; after the repair all objects arrive, and the pictures are those of the
# undamaged release.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
command -v nginx >/dev/null || skip "nginx is not installed"
work=build/e2e/damage
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory -j"$(nproc)" SAN=1 BUILD=build/asan build/asan/gopura-kiosk build/asan/gopura-fetch >/dev/null
# The unit tests look for leaks: in a whole kiosk the leak checker itself often dies while it stops
# the threads of Mesa's llvmpipe at the end ("Tracer caught signal 11").
export ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
small_release
cp -a "$small/release" "$work/release"
cp -a "$small/release" "$work/whole"
release=$work/release

# nginx may not keep packs open that change under their names.
port=$((20000 + RANDOM % 12000))
while (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((20000 + RANDOM % 12000)); done
server/setup.sh "$release" "$port" "$work/server" >/dev/null
sed -i 's|^\(\s*open_file_cache\)|#\1|' "$work/server/nginx.conf"
nginx -p "$work/server" -e logs/error.log -c nginx.conf &
server=$!
pid=
trap 'kill $server $pid 2>/dev/null || true' EXIT
wait_for 20 "answer of nginx" bash -c "exec 3<>/dev/tcp/127.0.0.1/$port"

grep -v '^#' tests/bench/views.txt | sed -n '1p;13p;24p' >"$work/views.txt"
# visits NAME MODE: three views into $work/NAME, in the background; pid is the kiosk's.
visits() {
	build/asan/gopura-kiosk --display headless --size 640x360 --mode "$2" --log debug \
		--release "https://localhost:$port" --ca "$work/server/ca.pem" --trust "$work/whole/root/1.json" \
		--state "$work/state-$1" --views "$work/views.txt" --capture "$work/$1" >"$work/$1.log" 2>&1 &
	pid=$!
}
# ended NAME: checks that the visit ended without an error and that every picture settled.
ended() {
	local status=0
	wait "$pid" || status=$?
	pid=
	! grep -qE 'Sanitizer|runtime error' "$work/$1.log" || { cat "$work/$1.log"; fail "$1"; }
	[ "$status" = 0 ] || { tail -n 20 "$work/$1.log"; fail "$1: the kiosk ended with $status"; }
	! grep -q '"settled": false' "$work/$1/views.jsonl" || fail "$1: a view did not settle"
}
# same NAME CLEAN LEAST: in dB, of the worst picture.
same() {
	build/tests/tools/compare_pictures "$work/$2" "$work/$1" >"$work/$1.jsonl"
	python3 - "$work/$1.jsonl" "$3" <<-'P' || fail "$1: other pictures than $2"
	import json, sys
	last = json.loads(open(sys.argv[1]).readlines()[-1])
	print(f"{sys.argv[1]}: {last['psnr_worst5_db']} dB at worst")
	sys.exit(0 if last["views"] == 3 and last["psnr_worst5_db"] >= float(sys.argv[2]) else 1)
	P
}
repair() { cp "$work"/whole/packs/* "$release/packs/"; cp "$work"/whole/locator/* "$release/locator/"; }

for mode in polygons lumigraph; do
	visits clean-$mode $mode
	ended clean-$mode
done

# ---- three bytes of every twenty thousand in every pack: index pages, patches and samples
for pack in "$release"/packs/*; do
	python3 - "$pack" <<-'P'
	import sys
	with open(sys.argv[1], "r+b") as pack:
	    for at in range(5000, pack.seek(0, 2) - 3, 20000):
	        pack.seek(at)
	        was = pack.read(3)
	        pack.seek(at)
	        pack.write(bytes(b ^ 0x5A for b in was))
	P
done
for mode in polygons lumigraph; do
	visits flipped-$mode $mode
	wait_for 60 "word of damage" grep -q 'is missing: damaged' "$work/flipped-$mode.log"
	sleep 3
	repair
	ended flipped-$mode
	echo "$(grep -c 'is missing: damaged' "$work/flipped-$mode.log") times damaged"
	if [ $mode = polygons ]; then
		for pack in "$release"/packs/*; do printf 'xyz' | dd of="$pack" bs=1 seek=9000 conv=notrunc status=none; done
	fi
done
same flipped-polygons clean-polygons 38
same flipped-lumigraph clean-lumigraph 30

# ---- every pack cut to a third
for pack in "$release"/packs/*; do truncate -s $(($(stat -c %s "$pack") / 3)) "$pack"; done
visits cut lumigraph
wait_for 60 "word of what is missing" grep -q 'is missing: not on the server' "$work/cut.log"
sleep 3
repair
ended cut
same cut clean-lumigraph 30

# ---- a locator that is not valid
for locator in "$release"/locator/*; do head -c 5000 /dev/urandom >"$locator"; done
visits lost lumigraph
wait_for 60 "first release" grep -q 'is published' "$work/lost.log"
sleep 3
! grep -q 'app: showing' "$work/lost.log" || fail "something was shown that nobody could find"
repair
ended lost
same lost clean-lumigraph 30
