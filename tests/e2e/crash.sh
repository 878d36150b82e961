#!/bin/bash
# How the appliance's own script counts the ends of a kiosk: which ends are crashes, how many bring up the safe page,
# and that a GPU that is lost again and again does so too.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=$PWD/build/e2e/crash
rm -rf "$work"
mkdir -p "$work"

# ended RESULT STATUS: as systemd tells ExecStopPost=
ended() {
	SERVICE_RESULT=$1 EXIT_STATUS=$2 RUNTIME_DIRECTORY=$work image/root/usr/lib/gopura/gopura-crash
	# As gopura-safe.path and gopura-safe.service do.
	[ ! -e "$work/safe-page" ] || { shown=$((shown + 1)) && rm "$work/safe-page"; }
}
safe_pages() { [ "$shown" = "$1" ]; }
begin() { rm -f "$work/crashes" "$work/losses" "$work/safe-page" && shown=0; }
# status_of NAME: as the kiosk has it
status_of() { sed -n "s/.*\<$1 = \([0-9]*\).*/\1/p" app/kiosk.h; }
anew=$(status_of KIOSK_STATUS_ANEW) lost=$(status_of KIOSK_STATUS_LOST_GPU)
[ -n "$anew" ] && [ -n "$lost" ] && [ "$anew" != "$lost" ] || fail "app/kiosk.h does not say its two statuses"

begin
for _ in $(seq 20); do
	ended success 0
	ended exit-code "$anew"
done
safe_pages 0 || fail "a kiosk that was stopped or began anew was taken for crashed"

ended exit-code 1
ended watchdog ABRT
safe_pages 0 || fail "two crashes brought the safe page"
ended core-dump SEGV
safe_pages 1 || fail "three crashes did not bring the safe page"
ended exit-code 1
ended exit-code 1
safe_pages 1 || fail "crashes were counted twice"

begin
now=$(cut -d. -f1 /proc/uptime)
printf '%d\n' $((now - 1900)) $((now - 1850)) >"$work/crashes"
ended exit-code 1
safe_pages 0 || fail "crashes of more than half an hour ago were counted"

# ---- the GPU
begin
for _ in 1 2 3 4; do ended exit-code "$lost"; done
[ ! -e "$work/crashes" ] || fail "a GPU that was lost four times was taken for a crash"
ended exit-code "$lost"
ended exit-code "$lost"
safe_pages 0 || fail "the safe page came too early"
ended exit-code "$lost"
safe_pages 1 || fail "a GPU that is lost again and again did not bring the safe page"
for _ in 1 2 3; do ended exit-code "$lost"; done
safe_pages 2 || fail "a GPU that is still ill after the safe page did not bring it back"

begin
for n in 1 2 3 4; do echo $((now - 1850)) >>"$work/losses"; done
for _ in 1 2 3 4; do ended exit-code "$lost"; done
[ ! -e "$work/crashes" ] || fail "losses of more than half an hour ago were counted"
