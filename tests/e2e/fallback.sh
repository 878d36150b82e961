#!/bin/bash
# A release that is signed and complete but shows nothing, on a running kiosk: the kiosk goes back to the previous
# release by itself, gives the reason on the health page, accepts neither the same one again nor an older one, and
# accepts the next one.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-kiosk.sh
command -v curl >/dev/null || skip "curl is not installed"
work=build/e2e/fallback
begin_release
cp -a "$work/release" "$work/release1"
health=
trap 'kill -9 $pid $health 2>/dev/null || true; stop_server' EXIT
serve "$work/release" "$work/server"
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
build/gopura-health --listen "127.0.0.1:$port" --kiosk "$work/kiosk" --fetch "$work/none" --data "$work" >"$work/health.log" 2>&1 &
health=$!
start_kiosk() { # LOG
	run_kiosk "$1" --release "$url" --ca "$ca" --trust "$work/release1/root/1.json" --metrics "$work/kiosk"
}
health_says() { curl -s "http://127.0.0.1:$port$1" | grep -qE -- "$2"; }
root_of() { sed -n 's/^gopura_kiosk_release_info{root="\([0-9a-f]*\)".*/\1/p' <(curl -s "http://127.0.0.1:$port/metrics"); }
# eye_is_at X: in metres
eye_is_at() { grep 'app: eye at' "$log" | tail -n 1 | grep -q "eye at $1\\(\\.0*\\)\\? "; }
shows() { [ "$(root_of)" = "$1" ]; }

make --no-print-directory build/tests/tools/spoiled_release >/dev/null

# ---- release 1 works
start_kiosk "$work/first.log"
wait_for 60 "first release" says 'release 1 is shown'
prove
first=$(root_of)
[ -n "$first" ] || fail "the health page does not say what is shown"
end_kiosk

# ---- release 2 has invalid patches and comes while release 1 is unavailable: its cache is lost, and the server does
# not have it at this time. So release 2 goes onto the panel before all of it was checked, and its fault is found there.
rm -f "$work"/state/cache.db*
mkdir "$work/aside"
mv "$work"/release/locator/* "$work/aside/"
build/tests/tools/spoiled_release "$small_keys" "$work/release"
start_kiosk "$work/spoiled.log"
wait_for 60 "release 2" says 'release 2 is shown'
wait_for 60 "refusal of release 2" says 'refused release 2: objects of it cannot be decoded'
! says 'first picture' || fail "there was a picture of what cannot be decoded"
cp -n "$work"/aside/* "$work/release/locator/"
wait_for 90 "a picture of release 1" says 'first picture'
shows "$first" || fail "it is not release 1 that is shown"
health_says /health '^warning: A new release was rejected: release 2, .*: objects of it cannot be decoded' ||
	{ curl -s "http://127.0.0.1:$port/health"; fail "the health page does not say why"; }
health_says /metrics '^gopura_kiosk_release_sequence 2$' || fail "the floor fell"
# The eye is at the start view of release 1, not at that of the other, in which nothing was visible.
wait_for 10 "eye at the start of release 1" eye_is_at "$(sed -n 's/^start *= *\([-0-9.]*\) .*/\1/p' "$work/content/temple.ini")"
sleep 4 # several looks at the server, which offers release 2 still
{ [ "$(grep -c 'release 2 is shown' "$log")" = 1 ] && shows "$first"; } || fail "what was refused was taken up again"
end_kiosk

# ---- the next start: release 1 at once, not on trial; neither 2 nor the signed file of 1 is taken, but 3 is
start_kiosk "$work/again.log"
wait_for 60 "a picture of release 1" says 'first picture'
{ shows "$first" && ! says 'on trial'; } || fail "the next start did not begin with release 1"
health_says /metrics '^gopura_kiosk_release_sequence 2$' || fail "the floor fell with the next start"
cp "$work"/release/{release,timestamp}.json "$work/aside/"
cp "$work"/release1/{release,timestamp}.json "$work/release/"
wait_for 20 "refusal of an older release" says 'refused timestamp.json: .*older'
cp "$work"/aside/{release,timestamp}.json "$work/release/"
publish Mended
wait_for 90 "the release after it" says 'release 3 is shown'
! says 'release 2 is' || fail "what was refused was taken up again"
prove
end_kiosk
