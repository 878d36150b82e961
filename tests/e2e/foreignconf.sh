#!/bin/bash
# A gopura.conf that is a pipe, a device or a link, or that names one: gopura-setup, kiosk, self-test and safe page
# report it and continue. None waits for it or reads it.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=$PWD/build/e2e/foreignconf
rm -rf "$work"
mkdir -p "$work"/{pipe,device,named,bin,efi}
mkfifo "$work/pipe/gopura.conf"
ln -s /dev/zero "$work/device/gopura.conf"
printf '[release]\nurl = https://museum.example/\ntrust = 1.json\nca = ca.pem\n' >"$work/named/gopura.conf"
mkfifo "$work/named/1.json"
ln -s ../../../../../../../../dev/zero "$work/named/ca.pem"

# ends NAME COMMAND...: checks that it exits, with any status; its output is in NAME.log.
ends() {
	local name=$1 status=0
	shift
	timeout 120 "$@" >"$work/$name.log" 2>&1 || status=$?
	[ "$status" != 124 ] || fail "$name hangs"
	[ "$status" -lt 126 ] || fail "$name ended with $status: $(cat "$work/$name.log")"
}
says() { grep -q -- "$2" "$work/$1.log" || fail "$1 does not say '$2': $(cat "$work/$1.log")"; }
pipe="it is not a regular file but a pipe" link="it is a link"

# ---- gopura-setup
ends check-pipe build/gopura-setup --check "$work/pipe/gopura.conf"
says check-pipe "$pipe"
ends check-device build/gopura-setup --check "$work/device/gopura.conf"
says check-device "$link"
ends check-named build/gopura-setup --check "$work/named/gopura.conf"
says check-named "line 3: 1.json beside gopura.conf cannot be read: $pipe"
says check-named "line 4: ca.pem beside gopura.conf cannot be read: $link"
printf '[release]\nurl = https://museum.example/\ntrust = ../../dev/zero\n' >"$work/efi/outside.conf"
ends check-outside build/gopura-setup --check "$work/efi/outside.conf"
says check-outside "outside.conf: line 3: trust must be the name of a file beside this one, without folders"
for which in pipe device named; do
	ends "setup-$which" build/gopura-setup --conf "$work/$which/gopura.conf" --out "$work/out-$which"
	[ -s "$work/out-$which/faults" ] && [ -s "$work/out-$which/hostname" ] || fail "$which: the system is not set up"
	! grep -q -- --ca "$work/out-$which/fetch.env" || fail "$which: the fetcher gets what cannot be read"
	ends "sum-$which" build/gopura-setup --checksum "$work/$which/gopura.conf"
done

# ---- the appliance's script, as root, when such a stick is plugged in
ln -s "$PWD/build/gopura-setup" "$work/bin/gopura-setup"
printf '#!/bin/sh\n' >"$work/bin/systemctl"
chmod +x "$work/bin/systemctl"
for which in pipe device named; do
	for verb in note apply; do
		ends "$verb-$which" env PATH="$work/bin:$PATH" image/root/usr/lib/gopura/gopura-conf "$verb" \
			"$work/efi/gopura.conf" "$work/$which/gopura.conf" "$work/out-$which"
	done
	[ "$(stat -c %a "$work/out-$which/conf.sum")" = 600 ] || fail "the sum of a file with a passphrase is everybody's"
done
printf '[terminal]\nname = Disk\n' >"$work/efi/gopura.conf"
ends apply-second env PATH="$work/bin:$PATH" image/root/usr/lib/gopura/gopura-conf apply "$work/efi/gopura.conf" \
	"$work/pipe/gopura.conf" "$work/out-pipe"

# ---- kiosk, self-test and safe page
printf '1500 down 0 2 2\n1550 up 0 2 2\n' >"$work/touch"
for which in pipe device named; do
	ends "safe-$which" build/gopura-kiosk --safe-page --display headless --size 320x200 --boards board \
		--conf "$work/$which/gopura.conf" --capture "$work/safe-$which"
	[ -s "$work/safe-$which/safe-0.png" ] || fail "no safe page with $which: $(cat "$work/safe-$which.log")"
	ends "kiosk-$which" build/gopura-kiosk --boards board --display headless --size 320x200 --state "$work/state-$which" \
		--touch-replay "$work/touch" --quit-after-replay --capture "$work" --conf "$work/$which/gopura.conf"
	says "kiosk-$which" "set-up bug: .*cannot be read: it is"
	ends "self-test-$which" build/gopura-kiosk --self-test --boards board --display headless --size 320x200 \
		--state "$work/state-$which" --conf "$work/$which/gopura.conf"
done
echo "pipes, devices and links as gopura.conf and beside it: told, and nobody waits"
