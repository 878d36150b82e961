#!/bin/bash
# A stick with a gopura.conf, plugged into a running terminal: the appliance's own script with the real gopura-setup;
# only the service manager is simulated. (tests/qemu/image.sh tests the whole in a virtual machine.)
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=$PWD/build/e2e/plugconf
rm -rf "$work"
mkdir -p "$work"/{bin,efi,stick,out}
script=$PWD/image/root/usr/lib/gopura/gopura-conf
conf=("$work/efi/gopura.conf" "$work/stick/gopura.conf")

sed "s#/run/gopura/#$work/out/#" "${script%conf}apply" >"$work/apply"

# What gopura-setup.service does when it is started; the others are only named.
cat >"$work/set-up" <<END
#!/bin/sh
set -e
PATH=$work/bin:\$PATH
"$script" write "${conf[0]}" "${conf[1]}" "$work/out"
"$script" note "${conf[0]}" "${conf[1]}" "$work/out"
END
cat >"$work/bin/systemctl" <<END
#!/bin/sh
echo "\$@" >>"$work/asked"
case "\$*" in
"restart gopura-setup.service")
	[ ! -e "$work/unable" ] || { "$work/unable"; exit 1; }
	exec "$work/set-up"
	;;
*iwd*) exit 1 ;; # whoever fails
esac
END
# With ILL=pulled the stick is gone when it is read, with ILL=N that call of open, read and others fails; while there
# are lines in failures, it fails and takes one away.
shim=$PWD/build/tests/tools/failing_calls.so
cat >"$work/bin/gopura-setup" <<END
#!/bin/sh
[ ! -s "$work/failures" ] || { sed -i 1d "$work/failures"; exit 1; }
case \$1 in --conf) set -- "\$@" --boards "$PWD/board" ;; esac
case "\${ILL:-}" in
pulled) mv "$work/stick/gopura.conf" "$work/pocket" ;;
[0-9]*) export LD_PRELOAD="$shim" FAIL_KIND=io FAIL_AT=\$ILL ;;
esac
exec "$PWD/build/gopura-setup" "\$@"
END
printf '#!/bin/sh\n' >"$work/bin/sleep"
chmod +x "$work/set-up" "$work"/bin/*

# plugged: as gopura-conf.service does when a stick came, and gopura-apply.service after it where its condition holds
plugged() {
	: >"$work/asked"
	PATH=$work/bin:$PATH "$script" apply "${conf[@]}" "$work/out" >"$work/said" 2>&1 || fail "apply: $(cat "$work/said")"
	[ ! -s "$work/asked" ] || fail "who reads the stick's text gives orders to the service manager: $(cat "$work/asked")"
	[ ! -e "$work/out/apply" ] || applied || fail "a new gopura.conf is not applied"
	[ ! -e "$work/out/apply" ] || fail "it would be applied again and again"
}
applied() { PATH=$work/bin:$PATH sh "$work/apply"; }
asked() { grep -q -- "$1" "$work/asked"; }
host() { cat "$work/out/hostname"; }

printf 'once\ntwice\nalways\n' >"$work/failures"
: >"$work/out/faults"
! "$work/set-up" 2>"$work/log" && [ ! -e "$work/out/faults" ] || fail "gopura-setup failed three times, and nobody knows"
printf 'once\ntwice\n' >"$work/failures"
"$work/set-up" 2>"$work/log" || fail "two failures left a terminal without settings"
[ "$(host)" = gopura ] || fail "a terminal without a gopura.conf is called $(host)"

cp system/gopura.conf.example "$work/stick/gopura.conf"
echo root >"$work/stick/1.json"
echo authority >"$work/stick/ca.pem"
plugged
[ "$(host)" = east-gate ] || fail "the stick's gopura.conf does not hold"
asked 'restart .*gopura-fetch.service' && asked 'restart .*gopura-kiosk.service' || fail "nobody is told: $(cat "$work/asked")"
asked '^restart .*systemd-networkd' || fail "the network is as it was"
[ "$(head -n 1 "$work/asked")" = "restart gopura-setup.service" ] || fail "others came before gopura-setup"

plugged
[ ! -s "$work/asked" ] || fail "the same stick once more disturbed: $(cat "$work/asked")"
# A call that fails once while the settings are read at the start: they hold all the same.
cp -r "$work/out" "$work/right"
for call in $(seq 60); do
	rm -f "$work/once"
	ILL=$call FAIL_ONCE=$work/once "$work/set-up" 2>"$work/log" || fail "call $call: $(cat "$work/log")"
	diff -r --no-dereference "$work/right" "$work/out" >"$work/differs" || fail "call $call: $(cat "$work/once" "$work/differs")"
done
# A loose contact: the stick is gone again while it is read.
ILL=pulled plugged
[ ! -s "$work/asked" ] && [ ! -e "$work/stick/gopura.conf" ] || fail "a stick that was pulled out took its settings along: $(cat "$work/asked")"
mv "$work/pocket" "$work/stick/gopura.conf"
for call in $(seq 40); do
	ILL=$call plugged
	[ ! -s "$work/asked" ] || fail "what cannot be read for a moment took the settings away: call $call: $(cat "$work/said")"
done
grep -q 'is in use already' "$work/said" || fail "there are more calls: $(cat "$work/said")"
echo another >"$work/stick/ca.pem"
plugged
asked gopura-kiosk.service || fail "another authority beside the same gopura.conf was not taken"

# gopura-setup fails, once and then always: the panel hears of it anyway.
for unable in "rm $work/unable" true; do
	echo "$unable" >"$work/unable"
	chmod +x "$work/unable"
	: >"$work/out/apply"
	: >"$work/asked"
	status=0
	applied || status=$?
	asked gopura-kiosk.service || fail "the panel cannot show why nothing was applied: $(cat "$work/asked")"
	[ "$(grep -c 'restart gopura-setup' "$work/asked")" = 2 ] || fail "what failed is not tried again: $(cat "$work/asked")"
	[ "$unable" = true ] || { [ $status = 0 ] && [ ! -e "$work/out/apply" ]; } || fail "the second try is not applied"
done
[ "$status" = 1 ] && [ -e "$work/out/apply" ] || fail "what failed counts as applied"
rm "$work/unable" "$work/out/apply"

# Its errors are reported, and its valid lines are applied.
sed -i -e 's/^name .*/name = West gate/' -e 's/^rotation .*/rotation = 45/' "$work/stick/gopura.conf"
plugged
[ "$(host)" = west-gate ] || fail "a fault kept the rest from holding"
grep -q 'rotation must be 0, 90, 180 or 270' "$work/out/faults" || fail "the fault is not told"
asked gopura-kiosk.service || fail "the panel does not show the fault"

# The disk's file has priority, and the log says so to the person who plugged in another one.
printf '[terminal]\nname = Disk\n' >"$work/efi/gopura.conf"
"$work/set-up" 2>"$work/log"
plugged
plugged
[ ! -s "$work/asked" ] && [ "$(host)" = disk ] || fail "the stick came before the disk"
[ "$(grep -c 'of the stick is not used' "$work/out/faults")" = 1 ] || fail "nobody is told: $(cat "$work/out/faults")"
# The stick is pulled out and the disk's file removed: no file is in use any more, and the same stick is applied again.
rm "$work/efi/gopura.conf"
mv "$work/stick" "$work/pocket"
"$work/set-up" 2>"$work/log"
[ "$(host)" = gopura ] && [ ! -e "$work/out/conf.sum" ] || fail "what is gone is in use"
mv "$work/pocket" "$work/stick"
plugged
[ "$(host)" = west-gate ] || fail "the stick does not hold again"
echo "a stick's gopura.conf: applied, told, not twice, not before the disk's"
