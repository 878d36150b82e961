#!/bin/bash
# The Update Framework's own conformance suite against tuf/workflow.h, which tests/tools/tuf_client drives: 108 repositories
# honest and hostile, two of them recorded from the field.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
suite=$(realpath -m ../shared/conformance/tuf) work=build/e2e/tuf top=$PWD
[ -d "$suite" ] || skip "no ../shared/conformance/tuf beside this folder: the suite of the TUF project is not part of ours"
mkdir -p "$work"
# From the folder of the plugin, which is found there.
(cd tests/e2e && sh "$suite/run.sh" "$top/build/tests/tools/tuf_client" -p rsa_2048) >"$work/log" 2>&1 || { tail -n 40 "$work/log"; fail "see $work/log"; }
tail -n 1 "$work/log"
grep -q '^108 passed' "$work/log" || fail "not all of 108 tests ran"
