#!/bin/bash
# make clean removes what was built, but not the keys without which nobody can update the terminals of an image.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=$PWD/build/e2e/clean
rm -rf "$work"
mkdir -p "$work/build/image-keys" "$work/build/obj/base" "$work/build/.cache"
echo private >"$work/build/image-keys/key.pem"
touch "$work/build/obj/base/log.o" "$work/build/gopura-kiosk" "$work/build/.deps" "$work/build/.cache/a"
make --no-print-directory BUILD="$work/build" clean >"$work/said" 2>&1 || fail "$(cat "$work/said")"
[ "$(cat "$work/build/image-keys/key.pem")" = private ] || fail "the keys are gone"
[ "$(ls -A "$work/build")" = image-keys ] || fail "left: $(ls -A "$work/build")"
grep -q 'image-keys stays' "$work/said" || fail "nobody is told: $(cat "$work/said")"
make --no-print-directory BUILD="$work/none" clean >"$work/said" 2>&1 || fail "nothing to remove: $(cat "$work/said")"
echo "clean: the keys of images stay"
