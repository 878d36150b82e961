# Functions that the end-to-end tests share. Source it from the top of the tree. Tests write only below build/e2e/.

skip() {
	echo "$*"
	exit 77
}

fail() {
	echo "FAILED: $*" >&2
	exit 1
}

# The bar of the tests' terminals is that of two tools: recorded fingers know where its buttons are. What the section
# cuts is plainly red.
plain_tools() { sed -i -e 's/^tools *=.*/tools = light section/' -e '/^cut *=/d' "$1/temple.ini"; }

# A small temple and its release, built once for all tests: build/e2e/small/{content,release}. To publish to a copy of
# that release, sign with its keys: --keys "$small_keys".
small=build/e2e/small small_keys=build/e2e/small/keys
export XDG_CONFIG_HOME=$PWD/build/e2e/config # nothing is written into the home
small_release() {
	[ -z "${RELEASES_MADE:-}" ] || return 0 # by the runner, whose tests run beside one another
	demo/make-content.sh "$small/content" 200000
	plain_tools "$small/content"
	sed -i -e 's/^points *=.*/points = 6/' -e 's/^face_px *=.*/face_px = 512/' -e '/^effort/d' \
		-e 's/^publish_share *=.*/publish_share = 0.25/' "$small/content/temple.ini"
	build/gopura-content build "$small/content" --out "$small/release" --keys "$small_keys" >"$small/log" 2>&1 || { cat "$small/log"; fail "no small temple"; }
	# The tests expect release 1; a program that makes other bytes from the same content has published release 2.
	grep -q '^release 1 ' "$small/log" && return 0
	rm -rf "$small/release"
	build/gopura-content build "$small/content" --out "$small/release" --keys "$small_keys"
}

# The temple of make demo for a panel of half the width, and its release: build/e2e/demo/{content,release}. Faces of half the
# width and a quarter of the triangles take a quarter of the time and show on 640 x 360 what those of make demo show on
# 1280 x 720.
demo=build/e2e/demo
demo_release() {
	demo/make-content.sh "$demo/content" 500000
	plain_tools "$demo/content"
	sed -i 's/^face_px *=.*/face_px = 1024/' "$demo/content/temple.ini"
	build/gopura-content build "$demo/content" --out "$demo/release" --keys "$demo/keys"
}

. tests/e2e/lib-server.sh
trap stop_server EXIT

# serve RELEASE RUN [PORT]: calls start_server, or skips the test if nginx is missing; sets url, port and ca.
serve() {
	command -v nginx >/dev/null || skip "nginx is not installed"
	start_server "$@" || fail "nginx did not start"
	url=$server_url ca=$server_ca
	port=${url##*:} port=${port%/}
}

# wait_for SECONDS WHAT COMMAND...: waits until the command succeeds.
wait_for() {
	local until=$((SECONDS + $1)) what=$2
	shift 2
	until "$@" >/dev/null 2>&1; do
		[ "$SECONDS" -lt "$until" ] || fail "no $what"
		sleep 0.2
	done
}
