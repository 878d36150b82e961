#!/bin/bash
# By make bench-full: what the first view and frames of a moving eye cost in instructions, which unlike
# time can be counted for an architecture that is not at hand: x86-64 and arm64 in QEMU's user emulation,
# a temple of 60 000 triangles at 640 x 360, on one thread. build/bench/instructions.json. Ten minutes.
set -eu
cd "$(dirname "$0")/../.."
for tool in aarch64-linux-gnu-gcc qemu-aarch64 qemu-x86_64; do
	command -v $tool >/dev/null || { echo "no $tool: apt-get install gcc-aarch64-linux-gnu qemu-user"; exit 77; }
done
work=build/bench/instructions root=$PWD/build/arm64/sysroot
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory all benches build/tests/tools/count_instructions.so >/dev/null
tests/qemu/make-release.sh build/qemu >&2
image/sysroot.sh >"$work/sysroot.log" || { tail -n 1 "$work/sysroot.log"; exit 77; }
PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root/usr/lib/aarch64-linux-gnu/pkgconfig:$root/usr/share/pkgconfig \
	make --no-print-directory -j"$(nproc)" BUILD=build/arm64 CC="$(command -v ccache || true) aarch64-linux-gnu-gcc --sysroot=$root" \
	build/arm64/tests/bench/bench_instructions >"$work/make.log" 2>&1 || { tail -n 20 "$work/make.log"; exit 1; }
grep -v '^#' tests/bench/views.txt | head -n 1 >"$work/views.txt"

# count NAME PROGRAM...: one thread, or which of them computes what would change the sum; and programs of the
# driver compiled anew, or a second run would count others
count() {
	local name=$1
	shift
	LP_NUM_THREADS=0 MESA_SHADER_CACHE_DISABLE=true "$@" build/qemu/release "$work/views.txt" \
		>"$work/$name.parts" 2>"$work/$name.counts"
}
plugin=(-plugin build/tests/tools/count_instructions.so)
count arm64 qemu-aarch64 -L "$root" "${plugin[@]}" build/arm64/tests/bench/bench_instructions &
count x86_64 qemu-x86_64 -cpu max "${plugin[@]}" build/tests/bench/bench_instructions
wait $!
python3 - "$work" >build/bench/instructions.json <<'P'
import json
import re
import sys

rows = []
for name in ("x86_64", "arm64"):
    # Before each part is a count of what came before it.
    counts = [int(n) for n in re.findall(r"^instructions: (\d+)$", open(f"{sys.argv[1]}/{name}.counts").read(), re.M)][1::2]
    parts = [line.rsplit(", ", 1) for line in open(f"{sys.argv[1]}/{name}.parts")]
    assert len(counts) == len(parts), f"{name}: {len(counts)} counts of {len(parts)} parts"
    rows.append({"architecture": name} | {
        what: {"frames": int(frames), "millions_a_frame": round(count / int(frames) / 1e6, 1)}
        for (what, frames), count in zip(parts, counts)})
print(json.dumps(rows, indent=1))
P
