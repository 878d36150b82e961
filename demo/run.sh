#!/bin/bash
# make demo: builds the demo temple and shows it on a panel. Ctrl-C ends everything that this script started.
#
#   demo/run.sh [--triangles N] [KIOSK OPTIONS]
#
# Everything is in build/demo/: content/ (the scan and the information about it), release/ (the files of the museum
# server), server/ (nginx's run folder), state/ (the kiosk's). A second run reuses all of it and starts at once.
set -eu
cd "$(dirname "$0")/.."
[ "${1:-}" != --help ] || { sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0"; exit 0; }

triangles=''
if [ "${1:-}" = --triangles ]; then
	triangles=$2
	shift 2
fi
demo=$PWD/build/demo release=$PWD/build/demo/release
server='' kiosk_pid=''
end() {
	trap - EXIT INT TERM
	for pid in $kiosk_pid $server; do kill "$pid" 2>/dev/null || true; done
	wait 2>/dev/null || true
}
trap end EXIT
trap 'exit 130' INT TERM

demo/prepare.sh ${triangles:+"$triangles"}

rm -f "$demo/server/url" # of the run before
server/serve.sh "$release" 0 "$demo/server" >"$demo/server.log" 2>&1 &
server=$!
for _ in $(seq 100); do
	[ ! -f "$demo/server/url" ] || break
	kill -0 "$server" 2>/dev/null || { cat "$demo/server.log" >&2; exit 1; }
	sleep 0.1
done
echo "Museum server: $(cat "$demo/server/url")"

kiosk=(build/gopura-kiosk --release "$(cat "$demo/server/url")" --ca "$demo/server/ca.pem"
	--trust "$release/root/1.json" --state "$demo/state")
# The kiosk runs in the background, so that a signal ends this script at once and not only after the kiosk.
show() {
	"${kiosk[@]}" "$@" &
	kiosk_pid=$!
	wait "$kiosk_pid"
}
# The kiosk uses a free panel or a desktop. Without either, a recorded visit is played and its pictures are saved.
if [ $# -gt 0 ] || [ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] || compgen -G '/dev/dri/card*' >/dev/null; then
	echo "Starting the kiosk; Ctrl-C ends it. With a mouse: drag to turn, wheel to zoom."
	show "$@"
else
	echo "No panel and no desktop found: playing a recorded visit (about half a minute) ..."
	show --display headless --size 1280x720 --touch-replay demo/visit.touch \
		--quit-after-replay --shots demo/visit.shots --capture "$demo"
	echo "Pictures of the visit:"
	ls "$demo"/*.png
fi
