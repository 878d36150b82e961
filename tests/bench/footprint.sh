#!/bin/bash
# What kiosk and fetcher take from a machine: memory and wake-ups at rest, programs and libraries,
# bytes written in a visitor's hour, memory after MINUTES of visits (default 4; 60 for the hour).
# build/bench/footprint.json.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/footprint
rm -rf "$work"
mkdir -p "$work"
demo/prepare.sh >/dev/null
for program in kiosk fetch content; do strip -o "$work/gopura-$program" "build/gopura-$program"; done
python3 tests/bench/footprint.py "$work" >build/bench/footprint.json.new
mv build/bench/footprint.json.new build/bench/footprint.json
