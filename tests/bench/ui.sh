#!/bin/bash
# What callouts and pages cost a frame: build/bench/ui.json. The demo's page, and one as large as a page may be.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/bench
make --no-print-directory benches >/dev/null
largest=build/bench/largest.html
python3 - "$largest" <<'P'
import sys

unit = "<p>" + "<b>a</b> <i>b</i> <a href=\"part:gate\">c</a> " * 5 + "</p>"
open(sys.argv[1], "w").write(unit * ((256 << 10) // len(unit)))
P
{
	echo '{"demo":'
	build/tests/bench/bench_ui demo/content/pages/central-tower.km.html
	echo ', "largest":'
	build/tests/bench/bench_ui "$largest"
	echo '}'
} >build/bench/ui.json
