#!/bin/bash
# Publishing from the page: what would change, a release, its list, going back; who may; and that a kill of the web
# process, the publisher or gopura-content at any moment leaves a whole release, the old one or the new one.
#
#   KILLS=3 SEED=1 tests/e2e/publish.sh     (`make interrupted` for more)
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-content.sh
work=build/e2e/publish
rm -rf "$work"
mkdir -p "$work"
tiny_content "$work/content" 10000 2000
build/gopura-content build "$work/content" --out "$work/release" --keys "$work/keys" --comment $'by hand,\nin two lines' \
	>"$work/log" 2>&1 || { cat "$work/log"; fail "the first build"; }
for one in ana:editor petra:publisher; do
	echo "password of ${one%:*}" | build/gopura-curator user add "$work/content" "${one%:*}" --role "${one#*:}"
done
# A publisher needs to be told where releases are, and only one may run.
status=0
build/gopura-curator publisher "$work/content" 2>/dev/null || status=$?
[ "$status" = 2 ] || fail "a publisher without --out ends with $status"
python3 tests/e2e/publish.py "$work" "${KILLS:-3}" "${SEED:-1}" || { tail -n 5 "$work"/*.log; fail "publishing"; }
build/gopura-content verify "$work/release" >/dev/null || fail "the last release is not whole"
[ -z "$(find "$work"/content/.curator/{publish,accounts.json*} -name '*.json.*')" ] || fail "temporary files are left"
