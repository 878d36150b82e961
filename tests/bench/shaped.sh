#!/bin/bash
# What bench_motion has on a clock of its own, once in real time: nginx, a line of 10 Mbit/s and 40 ms
# (tests/tools/shape.py), fetcher and kiosk, a visit by touch from an empty cache; then the same way of the eye on
# the virtual clock, for its bytes. build/bench/shaped.json.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib-server.sh
work=build/bench/shaped release=build/demo/release
rm -rf "$work"
mkdir -p "$work"
make --no-print-directory -j"$(nproc)" all benches >/dev/null
trap stop_server EXIT
demo/prepare.sh >/dev/null
start_server "$release" "$work/server"
port=${server_url##*:}
python3 tests/bench/shaped.py "$work" "$release" "${port%/}" "$server_ca" >build/bench/shaped.json.new
mv build/bench/shaped.json.new build/bench/shaped.json
