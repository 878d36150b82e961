#!/bin/bash
# Curators write in a real browser (writing.mjs): typing, pasting, two on one page, previews. Its pictures are in
# build/e2e/writing/.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-curator.sh
work=build/e2e/writing
serve_curator ana:editor petra:publisher
in_browser writing.mjs "$port" "$work"
