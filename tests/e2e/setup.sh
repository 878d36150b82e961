#!/bin/bash
# gopura-setup as an engineer and as a unit call it: a check at a desk, the first file that exists, no file at all.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/setup
rm -rf "$work"
mkdir -p "$work/stick"
setup=build/gopura-setup

# status COMMAND...: prints its exit status; its output is in $work/said.
status() { "$@" >"$work/said" 2>&1 && echo 0 || echo $?; }

cp system/gopura.conf.example "$work/gopura.conf"
touch "$work/1.json" "$work/ca.pem"
[ "$(status $setup --check "$work/gopura.conf" --boards board)" = 0 ] || fail "the example has faults: $(cat "$work/said")"
sed -i 's/^rotation.*/rotation = 45/' "$work/gopura.conf"
[ "$(status $setup --check "$work/gopura.conf")" = 1 ] || fail "a fault was not found"
line=$(grep -n '^rotation' "$work/gopura.conf" | cut -d: -f1)
grep -qx "$work/gopura.conf: line $line: rotation must be 0, 90, 180 or 270, not '45'" "$work/said" || fail "said: $(cat "$work/said")"
[ "$(status $setup --check "$work/none")" = 1 ] || fail "a file that is not there is right"

# The first file that exists is used, and its errors stop nothing.
printf '[terminal]\nname = Stick\n' >"$work/stick/gopura.conf"
[ "$(status $setup --conf "$work/none" --conf "$work/gopura.conf" --conf "$work/stick/gopura.conf" --boards board \
	--out "$work/out")" = 0 ] || fail "$(cat "$work/said")"
[ "$(cat "$work/out/hostname")" = east-gate ] || fail "the wrong file was taken"
grep -q "^line $line: rotation" "$work/out/faults" || fail "the faults are not written"
[ -z "$(find "$work/out" -name '*.[A-Za-z0-9][A-Za-z0-9][A-Za-z0-9][A-Za-z0-9][A-Za-z0-9][A-Za-z0-9]' -type f)" ] ||
	fail "a temporary file is left"
# What a unit reads of it is what systemd takes for words.
sh -c '. "$1"; [ "$RELEASE_URL" = https://museum.example/temple/ ] && case $FETCH_OPTIONS in *"--ca $2/out/conf/ca.pem"*) ;; *) exit 1 ;; esac' \
	sh "$work/out/fetch.env" "$(realpath "$work")" || fail "fetch.env: $(cat "$work/out/fetch.env")"
cp -r board "$work/boards"
printf '[cache]\nmib = 300\n' >>"$work/boards/generic.ini"
[ "$(status $setup --conf "$work/gopura.conf" --boards "$work/boards" --out "$work/out")" = 0 ] || fail "$(cat "$work/said")"
grep -q -- '--cache-budget 300 ' "$work/out/fetch.env" || fail "the profile's cache does not hold: $(cat "$work/out/fetch.env")"
cmp "$work/ca.pem" "$work/out/conf/ca.pem" || fail "the authority is gone with the stick that it came from"
[ "$(stat -c %a "$work/out/iwd")" = 700 ] || fail "the Wi-Fi's passphrase is everybody's"

# A folder whose name would say more to the service manager than a name.
evil=$work/$(printf 'x"\nLD_PRELOAD=evil.so\n#"')
mkdir -p "$evil"
cp "$work/gopura.conf" "$work/1.json" "$work/ca.pem" "$evil/"
[ "$(status $setup --conf "$evil/gopura.conf" --boards board --out "$work/out")" = 2 ] || fail "taken: a folder's name with quotes"
grep -q 'rename the file' "$work/said" || fail "said: $(cat "$work/said")"
[ "$(status $setup --conf "$work/gopura.conf" --boards board --out "$evil/out")" = 2 ] || fail "taken: a folder's name with quotes"
! grep -rq LD_PRELOAD "$work/out" || fail "a folder's name became a line of fetch.env"

# No file: DHCP is used, and a message says what to do. Results of an earlier file are gone.
[ "$(status $setup --conf "$work/none" --out "$work/out")" = 0 ] || fail "$(cat "$work/said")"
grep -q DHCP=yes "$work/out/network/10-wired.network" || fail "no DHCP without a file"
grep -q "$work/none does not exist: create it" "$work/out/faults" || fail "nobody is told"
[ ! -e "$work/out/network/20-wifi.network" ] || fail "the radio network of an earlier file is left"

for wrong in "" "--check a --conf b" "--conf a" "--out a" "--nonsense" "--check a b" "--checksum a --conf b" "--checksum a --check b" "--sum a"; do
	# shellcheck disable=SC2086
	[ "$(status $setup $wrong)" = 2 ] || fail "taken: '$wrong'"
done
echo "gopura-setup: checked, applied, without a file"
