#!/bin/bash
# Curators mark parts at the same time in real browsers (marking.mjs): none of them overwrites what another one has saved,
# and what is not saved is not left without a question.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-curator.sh
work=build/e2e/marking
serve_curator ana:editor petra:publisher
in_browser marking.mjs "$port" "$curator" "$work"
