#!/bin/bash
# The exposure of each unit by systemd-analyze security, and settings that no unit may have.
set -eu
cd "$(dirname "$0")/../.."
command -v systemd-analyze >/dev/null || { echo "systemd-analyze is not installed"; exit 77; }
failed=0

# Every unit, and lower where one meets strangers' bytes with nothing in between.
usual=15
declare -A lower=([gopura-kiosk]=10 [gopura-fetch]=15 [gopura-safe]=15 [gopura-health]=5 [gopura-setup]=10 [gopura-conf]=10 [gopura-bundle]=10 [gopura-curator]=15 [gopura-publisher]=15)
work=build/e2e/units
rm -rf "$work"
mkdir -p "$work"
# exposed UNIT FILE...: its exposure in tenths; a template is judged as its instance x
exposed() {
	local unit=$1
	shift
	cat "$@" >"$work/${unit/@/@x}"
	systemd-analyze security --offline=true "$work/${unit/@/@x}" 2>/dev/null |
		sed -n 's/.*Overall exposure level.*: \([0-9]*\)\.\([0-9]\).*/\1\2/p'
}
# most UNIT TENTHS FILE...: exposed at most so much
most() {
	local unit=$1 limit=$2 tenths
	shift 2
	tenths=$(exposed "$unit" "$@")
	echo "$unit: $tenths tenths (at most $limit)"
	[ -n "$tenths" ] && [ "$((10#$tenths))" -le "$limit" ] || failed=1
}
for file in systemd/*.service; do
	unit=${file##*/} name=${file##*/}
	name=${name%%[.@]*}
	most "$unit" "${lower[$name]:-$usual}" "$file"
done
# RAUC's own, by what the image lays over it.
printf '[Service]\nType=dbus\nBusName=de.pengutronix.rauc\nExecStart=/usr/bin/rauc service\n' >"$work/rauc.packaged"
most rauc.service 20 "$work/rauc.packaged" image/root/etc/systemd/system/rauc.service.d/gopura.conf
# A command line with all privileges is not covered by the measure.
! grep -nE '^Exec[A-Za-z]+=[-@:|]*[+!]' systemd/*.service || { echo "a command runs outside its unit's confinement"; failed=1; }
# Who takes text from a stick, a network or a finger has a user without privileges, and none of them is root.
for name in kiosk fetch safe health setup conf bundle curator publisher; do
	grep -qE '^(User=gopura-|DynamicUser=yes)' "systemd/gopura-$name.service" || { echo "gopura-$name.service runs as root"; failed=1; }
done
# Everyone has a ceiling for memory and tasks.
for file in systemd/*.service; do
	grep -q '^MemoryMax=' "$file" && grep -q '^TasksMax=' "$file" || { echo "$file: no MemoryMax= or TasksMax="; failed=1; }
done

# What a loose contact or a request from the network starts is never refused for having started often; and a health
# page that fails takes a pause.
for name in stick@ conf bundle apply firmware health; do
	grep -qx 'StartLimitIntervalSec=0' "systemd/gopura-$name.service" || { echo "gopura-$name.service: it does not start often"; failed=1; }
done
grep -qx 'TriggerLimitIntervalSec=0' systemd/gopura-health.socket && grep -qE '^RestartSec=[1-9]' systemd/gopura-health.service ||
	{ echo "gopura-health.socket: it ends for good"; failed=1; }

# Filters of system calls are what systemd calls a service's, less an explicit list.
for unit in systemd/*.service; do
	grep -q '^SystemCallFilter=@system-service$' "$unit" ||
		{ echo "$unit: no filter of system calls"; failed=1; }
done
# What a unit starts is in the image's packages or in this tree.
for program in $(sed -nE 's/^Exec[A-Za-z]+=[+!-]*([^ ]+).*/\1/p' systemd/*.service | sort -u); do
	case $program in
	/usr/lib/gopura/*) [ -x "image/root$program" ] || { echo "$program is not in image/root"; failed=1; } ;;
	/usr/bin/gopura-*) grep -q "${program##*/}" Makefile || { echo "$program is not built"; failed=1; } ;;
	esac
done
# gopura-health, which has no user or group of its own, reaches the figures, and a restart does not
# forget how many there were.
for unit in $(grep -l -e '--metrics' systemd/*.service); do
	! grep -q '^RuntimeDirectoryMode=' "$unit" || grep -q '^RuntimeDirectoryMode=07[15][15]$' "$unit" ||
		{ echo "$unit: its RuntimeDirectoryMode= keeps gopura-health out: 0755 (sockets have modes of their own)"; failed=1; }
	grep -q '^RuntimeDirectoryPreserve=yes$' "$unit" ||
		{ echo "$unit: without RuntimeDirectoryPreserve=yes its starts are not counted"; failed=1; }
done
# The Wi-Fi's passphrase in /efi/gopura.conf: the loader's partition is of a group of its own, which the kiosk has and the
# fetcher has not, and the fetcher does not see the folder.
group=gopura-conf
grep -q "^group=.*\^$group:" image/init || { echo "image/init: /efi is not of the group $group"; failed=1; }
grep -q "^g $group " image/root/usr/lib/sysusers.d/gopura.conf || { echo "sysusers.d: no group $group"; failed=1; }
! grep -q "^m .* $group$" image/root/usr/lib/sysusers.d/gopura.conf || { echo "sysusers.d: $group is for units to name, not for users"; failed=1; }
for unit in kiosk safe fetch; do
	has=no wants=yes
	! grep -qE "^(Supplementary)?Groups?=.*\b$group\b" "systemd/gopura-$unit.service" || has=yes
	[ "$unit" != fetch ] || wants=no
	[ "$has" = "$wants" ] || { echo "gopura-$unit.service: in the group $group: $has, not $wants"; failed=1; }
done
grep -qE '^InaccessiblePaths=.*-?/efi( |$)' systemd/gopura-fetch.service || { echo "gopura-fetch.service: it sees /efi"; failed=1; }
# The signing keys are the publisher's: the page's process neither is its user nor sees the folder.
keys=$(sed -nE 's|^ExecStart=.* --keys (/[^ ]*)/keys$|\1|p' systemd/gopura-publisher.service)
grep -q "^StateDirectory=${keys#/var/lib/}$" systemd/gopura-publisher.service && grep -q '^StateDirectoryMode=0700$' systemd/gopura-publisher.service ||
	{ echo "gopura-publisher.service: others may read the keys"; failed=1; }
grep -q "^InaccessiblePaths=-$keys$" systemd/gopura-curator.service || { echo "gopura-curator.service: it sees the keys"; failed=1; }
[ "$(grep '^User=' systemd/gopura-curator.service)" != "$(grep '^User=' systemd/gopura-publisher.service)" ] ||
	{ echo "the page's process is the publisher's user"; failed=1; }
# The self-test checks the terminal that will run, so both have the same options.
options() { grep "^$1=" systemd/gopura-kiosk.service | grep -oE -e '--[a-z]+ [^ ]+' | grep -vE -e '--(metrics|visits)'; }
[ "$(options ExecStartPre)" = "$(options ExecStart)" ] ||
	{ echo "gopura-kiosk.service: its self-test and its kiosk have other options"; failed=1; }
exit $failed
