#!/bin/bash
# The programs for arm64: cross-compiled against Debian's packages, which are unpacked into build/arm64 and not
# installed, and run under qemu-user. With "all" (make arm64) all programs are compiled, all unit tests run that can run
# there, and a kiosk shows its first picture. Without it (make test) gopura-content makes a hierarchy, and the unit tests
# are those of the formats and of arithmetic with vectors. docs/arm64.md says what this shows and what it does not.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
for tool in aarch64-linux-gnu-gcc qemu-aarch64; do
	command -v $tool >/dev/null || skip "no $tool: apt-get install gcc-aarch64-linux-gnu qemu-user"
done
build=build/arm64
work=$build/work
root=$PWD/$build/sysroot
mkdir -p "$work"

# Not run under qemu-user, and why.
declare -A left_out=(
	[input/test_touch_devices]="umockdev is of this machine's kind"
	[base/test_safe_open]="qemu-user has no openat2, and a walk does not tell mounts apart"
	[net/test_http]="qemu-user tells no TCP_INFO"
	[net/test_packets]="qemu-user does not tell that descriptors were cut off (MSG_CTRUNC)"
	[net/test_hostile_fetcher]="the same"
	[pipeline/import/test_sandbox]="qemu-user holds no child to its memory"
)
for name in pipeline/{estimate,content/{demo_content,page_compile},hierarchy/{hierarchy_file,master},release/publish_labels,samples/{reference,sampler,shading},temple/temple} \
	render/{lumigraph/mediump,scene/{scene,scene_labels,scene_tools}} storage/{cache,powercut} ui/{comfort,tools_view}; do
	left_out[${name%/*}/test_${name##*/}]="over 20 s there"
done
# The sample of "make test" needs no more compiled than gopura-content consists of.
sample='^((base|format|tuf)/|geometry/|pipeline/(material/|samples/test_(pyramid|raster)|hierarchy/))'
parts=(gopura-content FOLDERS="base geometry format tuf render storage pipeline")
if [ "${1:-}" = all ]; then
	parts=(all)
else
	for name in base/test_spill geometry/test_{substance,tour_path} pipeline/hierarchy/test_{simplify,simplify_features,stream_encode}; do
		left_out[$name]="in make arm64"
	done
fi

began=$SECONDS
say() {
	echo "$1: $((SECONDS - began)) s"
	began=$SECONDS
}
image/sysroot.sh >"$work/sysroot.log" || skip "$(tail -n 1 "$work/sysroot.log")"
say "packages, $(du -sm "$root" | cut -f 1) MB"

tests=$(find tests -name 'test_*.c' | sort | sed 's|^tests/||; s|\.c$||')
[ "${1:-}" = all ] || tests=$(grep -E "$sample" <<<"$tests")
chosen=$(for name in $tests; do [ -n "${left_out[$name]:-}" ] || echo "$name"; done)
export PKG_CONFIG_SYSROOT_DIR=$root
export PKG_CONFIG_LIBDIR=$root/usr/lib/aarch64-linux-gnu/pkgconfig:$root/usr/share/pkgconfig
# shellcheck disable=SC2086
make --no-print-directory -j"$(nproc)" BUILD=$build \
	CC="$(command -v ccache || true) aarch64-linux-gnu-gcc --sysroot=$root" \
	"${parts[@]/#gopura/$build/gopura}" $(printf "$build/tests/%s " $chosen) >"$work/make.log" 2>&1 ||
	{ tail -n 30 "$work/make.log"; fail "it does not compile"; }
unset PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_LIBDIR
say "programs and $(echo "$chosen" | wc -l) unit tests built"

arm64() { qemu-aarch64 -L "$root" "$@"; }
export root build work
# shellcheck disable=SC2016
echo "$chosen" | xargs -P "$(nproc)" -I NAME sh -c \
	'timeout 300 qemu-aarch64 -L "$root" "$build/tests/NAME" >"$work/test.log.$$" 2>&1 </dev/null ||
		{ echo "NAME:"; tail -n 30 "$work/test.log.$$"; exit 1; }; rm "$work/test.log.$$"' ||
	fail "unit tests"
[ "${1:-}" != all ] || for name in "${!left_out[@]}"; do
	echo "left out: $name (${left_out[$name]})"
done | sort
say "unit tests passed"

# ---- what it makes is the same, bit by bit: the demo temple's scan, and its hierarchy
hierarchy() { # CONTENT PROGRAM...
	local content=$work/$1
	shift
	rm -rf "$content"
	mkdir -p "$content"
	cp -r demo/content/. "$content/"
	{ "$@" temple --triangles 20000 --seed 1 --out "$content/scan.ply" && "$@" hierarchy "$content"; } \
		>"$content.log" 2>&1 || { tail -n 5 "$content.log"; fail "$* makes no hierarchy"; }
}
hierarchy here build/gopura-content
hierarchy arm64 arm64 $build/gopura-content
cmp "$work/here/scan.ply" "$work/arm64/scan.ply" || fail "another temple"
cmp "$work/here/.work/master/"groups-* "$work/arm64/.work/master/"groups-* || fail "another hierarchy"
say "the same temple and hierarchy"
[ "${1:-}" = all ] || exit 0

# ---- what it shows is the same: fetcher and kiosk, a view of the small temple
small_release >/dev/null
release=$small/release
rm -rf "$work"/{state*,cache*,view*}
sed -n 3p tests/bench/views.txt >"$work/views.txt"
look() { # NAME OPTIONS...: a kiosk that draws the view and ends
	local name=$1
	shift
	"$@" --display headless --size 480x270 --mode polygons --state "$work/state-$name" --trust "$release/root/1.json" \
		--views "$work/views.txt" --capture "$work/view-$name" >"$work/view-$name.log" 2>&1 ||
		{ tail -n 10 "$work/view-$name.log"; fail "$name: no picture"; }
	! grep -q '"settled": false' "$work/view-$name/views.jsonl" || fail "$name: the view did not settle"
}
look here build/gopura-kiosk --release "$release"
# Not by the function, whose shell alone would be ended.
qemu-aarch64 -L "$root" $build/gopura-fetch --release "$release" --cache "$work/cache.db" --socket "$work/socket" \
	>"$work/fetch.log" 2>&1 &
fetch=$!
trap 'kill $fetch 2>/dev/null || true' EXIT
wait_for 20 "fetcher for arm64" test -S "$work/socket"
look arm64 arm64 $build/gopura-kiosk --socket "$work/socket"
make --no-print-directory build/tests/tools/compare_pictures >/dev/null
build/tests/tools/compare_pictures "$work/view-here" "$work/view-arm64" | tail -n 1 >"$work/view.json"
python3 - "$work/view.json" <<'P' || fail "the kiosk for arm64 draws another picture"
import json, sys
found = json.load(open(sys.argv[1]))
print(f"the kiosk's picture against this machine's: {found['psnr_db']} dB")
sys.exit(0 if found["views"] == 1 and found["psnr_db"] >= 35 else 1)
P
say "the same picture"
