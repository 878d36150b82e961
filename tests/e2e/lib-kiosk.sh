# For tests in which releases come and go on a kiosk that runs: one at a time, with a copy of the small release in $work,
# which is made anew. Source it after lib.sh.

pid=
begin_release() {
	rm -rf "$work"
	mkdir -p "$work"
	small_release
	cp -a "$small/content" "$work/content"
	cp -a "$small/release" "$work/release"
	trap '[ -z "$pid" ] || kill -9 "$pid" 2>/dev/null || true; stop_server' EXIT
}

# run_kiosk LOG OPTION...: with the state of the one before
run_kiosk() {
	log=$1
	shift
	rm -f "$log" # of the start before
	build/gopura-kiosk --display headless --size 320x180 --poll-s 1 --log debug --state "$work/state" "$@" 2>"$log" &
	pid=$!
}
says() { grep -qE "$1" "$log" 2>/dev/null; }
end_kiosk() {
	kill "$pid"
	wait "$pid" || fail "the kiosk did not end well"
	pid=
}

publish() { # WORD: another heading on each page
	sed -i "s/<h1>/<h1>$1: /" "$work"/content/pages/*.en.html
	build/gopura-content build "$work/content" --out "$work/release" --keys "$small_keys" >/dev/null
}
trial_is_over() { [ -n "$(find "$work/state/state.db.second" -newer "$work/since")" ]; }
prove() { # a release that was shown is seen to work ten seconds later, which is written down
	touch "$work/since"
	wait_for 30 "proof of the release" trial_is_over
}
