# For tests of terminals that follow The Update Framework. Source it after lib.sh and lib-content.sh.

# tuf_work FOLDER: an empty folder with the content of a tiny temple; sets work, content, release and keys.
tuf_work() {
	work=$1 content=build/gopura-content release=$1/release keys=$1/keys
	rm -rf "$work"
	mkdir -p "$work/content"
	tiny_content "$work/content" 10000 5000
	trap stop_all EXIT
}

# publish COMMENT: the content as the next release, signed in each form that the keys are for.
publish() {
	"$content" build "$work/content" --out "$release" --keys "$keys" --comment "$1" >"$work/log" 2>&1 || { cat "$work/log"; fail "publishing $1"; }
}

# terminal NAME [TRUST]: starts a kiosk of that name; TRUST at its first start. Its log is anew. Its fetcher gives up a
# request that brings nothing for two seconds.
declare -A pids
terminal() {
	printf '#!/bin/bash\nexec build/gopura-fetch --stall-s 2 --metrics %s "$@"\n' "$work/$1-fetch.metrics" >"$work/$1-fetch"
	chmod +x "$work/$1-fetch"
	build/gopura-kiosk --display headless --size 320x180 --release "$url" --ca "$ca" --poll-s 1 --stick "$work/media" \
		--fetch "$work/$1-fetch" --metrics "$work/$1.metrics" --state "$work/state-$1" ${2:+--trust "$2"} 2>"$work/$1.log" &
	pids[$1]=$!
}
stop_terminal() {
	kill "${pids[$1]}"
	wait "${pids[$1]}" || fail "terminal $1 did not end well"
	unset "pids[$1]"
}
kill_terminal() {
	kill -9 "${pids[$1]}"
	wait "${pids[$1]}" 2>/dev/null || true
	unset "pids[$1]"
}
stop_all() {
	local pid
	for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
	stop_server
}

# What the log of a terminal says since its start.
said() { grep -q "$2" "$work/$1.log"; }
shown() { [ "$(grep -c 'release .* is shown' "$work/$1.log")" -ge "$2" ]; }
has_shown() { grep -q "release $2 is stored in the state" "$work/$1.log"; }
# A copy to the server brings release.json a moment before its timestamp.json.
refused() { grep -vE 'refused tuf/1.root.json|is not the one timestamp.json names' "$work/$1.log" | grep -q 'refused'; }

# metrics NAME: of a terminal, or of its fetcher: NAME-fetch. figure NAME METRIC: one of them; why NAME: the last refusal.
metrics() { python3 -c 'import socket, sys
s = socket.socket(socket.AF_UNIX)
s.connect(sys.argv[1])
sys.stdout.write(b"".join(iter(lambda: s.recv(65536), b"")).decode())' "$work/$1.metrics"; }
figure() { metrics "$1" | sed -n "s/^$2 //p"; }
why() { metrics "$1" | grep '^gopura_kiosk_refusal_info'; }
