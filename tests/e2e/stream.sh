#!/bin/bash
# Over a slow line a new terminal shows the streaming mesh long before the patches that take its place: kiosk and fetcher
# from an empty cache, nginx, 200 kbit/s and 60 ms; pictures of what is on the panel between the two.
set -eu
cd "$(dirname "$0")/../.."
command -v nginx >/dev/null || { echo "nginx is not installed"; exit 77; }
. tests/e2e/lib.sh
. tests/e2e/lib-server.sh
work=build/e2e/stream
rm -rf "$work"
mkdir -p "$work"
small_release
build/gopura-content verify "$small/release" --trust "$small/release/root/1.json" | grep -qE "stream page +1 " ||
	fail "the release has no streaming mesh"
trap stop_server EXIT
start_server "$small/release" "$work/server"
port=${server_url##*:}
python3 tests/e2e/stream.py "$work" "$small/release" "${port%/}" "$server_ca" || { tail -n 20 "$work/kiosk.log"; fail "see above"; }
for shot in "$work"/between/*.png; do
	python3 tests/e2e/tones.py "$shot" 40 || fail "nothing on the panel: $shot"
done
