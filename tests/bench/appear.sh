#!/bin/bash
# The longest frame while the first picture gets its images, and while the demo's scenery appears, before the eastern gate:
# build/bench/appear.json.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory benches >/dev/null
demo/prepare.sh >/dev/null
echo '22.6 0 4 17.8 0 4.2 45' >build/bench/appear-views.txt
MESA_SHADER_CACHE_DISABLE=true build/tests/bench/bench_appear build/demo/release build/bench/appear-views.txt 6 >build/bench/appear.json
