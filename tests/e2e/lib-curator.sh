# For tests of the curator's pages in a real browser. Source it after lib.sh.
command -v chromium >/dev/null || skip "chromium is not installed"
command -v node >/dev/null || skip "node is not installed"

# serve_curator ACCOUNT:ROLE...: serves a copy of the small temple's content in $work, which is made anew; an account's
# password is "password of ACCOUNT". Sets curator, its process, and port.
serve_curator() {
	local one
	rm -rf "$work"
	mkdir -p "$work"
	small_release
	cp -a "$small/content" "$work/content" # with the times of its scan, so the hierarchy is still its own
	for one; do
		echo "password of ${one%:*}" | build/gopura-curator user add "$work/content" "${one%:*}" --role "${one#*:}" >"$work/log"
	done
	build/gopura-curator "$work/content" --port 0 >"$work/curator.log" 2>&1 &
	curator=$!
	trap 'kill $curator 2>/dev/null || true' EXIT
	wait_for 60 "address" grep -q 'open http://127.0.0.1:' "$work/curator.log"
	port=$(sed -nE 's|.*http://127.0.0.1:([0-9]+)/.*|\1|p' "$work/curator.log")
}

# in_browser SCRIPT ARGUMENT...
in_browser() { timeout 240 node "tests/e2e/$1" "${@:2}" || { tail "$work/curator.log"; fail "in the browser"; }; }
