#!/bin/bash
# How much each unit is exposed, by systemd's own measure, and what must not be in any of them.
set -eu
cd "$(dirname "$0")/../.."
command -v systemd-analyze >/dev/null || { echo "systemd-analyze is not installed"; exit 77; }
failed=0

# most UNIT TENTHS: exposed at most so much
most() {
	local tenths
	tenths=$(systemd-analyze security --offline=true "systemd/$1" 2>/dev/null |
		sed -n 's/.*Overall exposure level.*: \([0-9]*\)\.\([0-9]\).*/\1\2/p')
	echo "$1: $tenths tenths (at most $2)"
	[ -n "$tenths" ] && [ "$((10#$tenths))" -le "$2" ] || failed=1
}
most gopura-kiosk.service 10
most gopura-fetch.service 15
most gopura-safe.service 15
most gopura-health.service 5

# Filters of system calls are what systemd calls a service's, less an explicit list.
for unit in systemd/*.service; do
	grep -q '^SystemCallFilter=@system-service$' "$unit" || grep -q '^Type=oneshot$' "$unit" ||
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
for unit in $(grep -l -e '--figures' systemd/*.service); do
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
# The self-test looks at the terminal that will run: both have the same options.
options() { grep "^$1=" systemd/gopura-kiosk.service | grep -oE -e '--[a-z]+ [^ ]+' | grep -vE -e '--(figures|visits)'; }
[ "$(options ExecStartPre)" = "$(options ExecStart)" ] ||
	{ echo "gopura-kiosk.service: its self-test and its kiosk have other options"; failed=1; }
exit $failed
