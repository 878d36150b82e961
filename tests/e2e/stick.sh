#!/bin/bash
# Releases from a USB stick: a terminal that never had a network gets its first release and an update; an older or
# unsigned release is refused with the reason; beside a server the newer release wins, and objects that are damaged on
# the stick come from the server.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
. tests/e2e/lib-kiosk.sh
work=build/e2e/stick
begin_release
mkdir "$work/mount"
start_kiosk() { # LOG URL OPTION...
	run_kiosk "$1" --release "$2" --stick "$work/mount" --trust "$small/release/root/1.json" "${@:3}"
}
plug() { # RELEASE [BELOW]: whole at once, as a mount is: what is looked for comes last
	local to=$work/mount${2:-}
	mkdir -p "$to"
	tar -c -C "$1" --exclude=./timestamp.json . | tar -x -C "$to"
	cp "$1/timestamp.json" "$work/stamp"
	mv "$work/stamp" "$to/timestamp.json"
}
pull() { rm -rf "${work:?}/mount/"*; }
nowhere=https://localhost:1/

# ---- without a network: the stick is plugged in while the kiosk waits
start_kiosk "$work/first.log" $nowhere
wait_for 30 "word that there is no network" says 'offline'
plug "$work/release" /release
wait_for 30 "the stick's release" says 'release 1 is on the stick'
wait_for 90 "release 1" says 'release 1 is shown'
wait_for 90 "whole picture" says 'picture has settled'
pull
wait_for 30 "notice that it was pulled out" says 'stick was removed'

# ---- an update from another stick
publish Second
cp -a "$work/release" "$work/release2"
plug "$work/release2"
wait_for 90 "release 2 of a stick" says 'release 2 is shown'

# ---- an older one, and one that somebody wrote into
pull
plug "$small/release"
wait_for 30 "refusal of an older stick" says 'refused timestamp.json of the stick: .*older'
pull
publish Third
cp -a "$work/release" "$work/forged"
python3 - "$work/forged/release.json" <<'P'
import base64, json, sys
envelope = json.load(open(sys.argv[1]))
payload = base64.b64decode(envelope["payload"]).replace(b'"sequence":3', b'"sequence":9')
envelope["payload"] = base64.b64encode(payload).decode()
json.dump(envelope, open(sys.argv[1], "w"))
P
plug "$work/forged"
wait_for 30 "refusal of a forged stick" says 'refused release.json of the stick: fewer valid signatures'
! says 'release 9 is' || fail "a forged release was begun"
end_kiosk
pull

# ---- without stick and network all is there
start_kiosk "$work/alone.log" $nowhere
wait_for 60 "picture from the cache" says 'first picture'
end_kiosk

# ---- the server has release 3, a stick 4, whose packs are damaged; then the server has 4 too
cp -a "$work/release" "$work/release3"
serve "$work/release3" "$work/server"
publish Fourth
plug "$work/release"
python3 - "$work"/mount/packs/* <<'P'
import sys
for name in sys.argv[1:]:
    pack = bytearray(open(name, "rb").read())
    for at in range(0, len(pack), 500):
        pack[at] ^= 1
    open(name, "wb").write(pack)
P
start_kiosk "$work/both.log" "$url" --ca "$ca"
wait_for 60 "release 4 of the stick" says 'release 4 is on the stick'
wait_for 30 "notice of the damage" says 'object .* from the stick is damaged'
! says 'release 4 is shown' || fail "a damaged stick was shown"
cp -a "$work/release/." "$work/release3/"
wait_for 90 "release 4, from the server" says 'release 4 is shown'
end_kiosk
