#!/bin/bash
# What the information database costs, of the demo and of 1000 parts with its texts over and over:
# build/bench/info.json.
set -eu
cd "$(dirname "$0")/../.."
work=build/bench/info
rm -rf "$work"
mkdir -p "$work/pages"
make --no-print-directory benches >/dev/null
python3 - "$work" <<'P'
import json
import re
import sys

parts = json.load(open("demo/content/parts.json"))["parts"]
many = []
for n in range(1000):
    part = dict(parts[n % len(parts)], id=f"part-{n}")
    part.pop("thumbnail", None)
    many.append(part)
    for language in part["title"]:
        html = open(f"demo/content/pages/{parts[n % len(parts)]['id']}.{language}.html").read()
        html = re.sub(r"</?a\b[^>]*>|<img\b[^>]*>", "", html)
        open(f"{sys.argv[1]}/pages/part-{n}.{language}.html", "w").write(html)
json.dump({"parts": many}, open(f"{sys.argv[1]}/parts.json", "w"))
P
{
	echo '{"demo":'
	build/tests/bench/bench_info demo/content
	echo ', "many":'
	build/tests/bench/bench_info "$work"
	echo '}'
} >build/bench/info.json
rm -rf "$work"
