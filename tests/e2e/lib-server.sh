# Sourced by end-to-end tests that need the museum server. Run from the top of the tree.

# start_server RELEASE RUN [PORT [NAME ...]]: nginx in the background, on a free port unless one is given;
# sets server_pid, server_url and server_ca once it answers.
start_server() {
	rm -f "$2/url"
	server/serve.sh "$1" "${3:-0}" "$2" "${@:4}" >"$2.log" 2>&1 &
	server_pid=$!
	for _ in $(seq 200); do
		[ ! -f "$2/url" ] || break
		kill -0 "$server_pid" 2>/dev/null || { cat "$2.log" >&2; return 1; }
		sleep 0.1
	done
	server_url=$(cat "$2/url") server_ca=$2/ca.pem
}

stop_server() {
	[ -n "${server_pid:-}" ] || return 0
	kill "$server_pid" 2>/dev/null
	wait "$server_pid" 2>/dev/null
	server_pid=
	return 0
}
