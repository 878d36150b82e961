#!/bin/bash
# A visitor listens to a page: what ALSA's file device gets is speech and lasts as long as it is listened to, the words
# follow it, a touch on the model ends it; without gopura.conf's leave there is no control and no thread; without a
# device the control goes, and the kiosk goes on.
set -eu
cd "$(dirname "$0")/../.."
. tests/e2e/lib.sh
work=build/e2e/sound
rm -rf "$work"
mkdir -p "$work"
small_release
printf '%s\n' '10000 1-page' '13500 2-words' '22500 3-ended' >"$work/at.shots"
printf 'pcm.nothing { type null }\npcm.!default { type file slave.pcm "nothing" file "%s" format "raw" }\n' \
	"$PWD/$work/heard.raw" >"$work/file.conf"
printf 'pcm.!default { type hw card 31 }\n' >"$work/none.conf"
printf '[visit]\nloudness = 60\n' >"$work/gopura.conf"

# visit NAME ALSA OPTION...: plays the touches
visit() {
	local name=$1 alsa=$2
	shift 2
	ALSA_CONFIG_PATH=$PWD/$work/$alsa.conf timeout 120 build/gopura-kiosk --display headless --size 1280x720 \
		--release "$small/release" --trust "$small/release/root/1.json" --state "$work/state" --log debug \
		--touch-replay tests/e2e/sound.touch --quit-after-replay --shots "$work/at.shots" \
		--capture "$work/$name" "$@" 2>"$work/$name.log" || { tail -n 30 "$work/$name.log"; fail "$name"; }
}
said() { grep -oE 'page of .*|listening .*|words [1-9] of .*' "$work/$1.log" | tr '\n' ' '; }

visit heard file --conf "$work/gopura.conf"
# How many sentences it comes to in ten seconds depends on how busy the machine is.
said heard | grep -qE '^page of central-tower listening begins words 1 of 6 words 2 of 6 (words [3-6] of 6 )*listening ends $' ||
	fail "heard: $(said heard)"
python3 - "$work/heard.raw" <<'P'
import array
import sys
samples = array.array("h", open(sys.argv[1], "rb").read())
seconds = len(samples) / 2 / 48000
loud = sum(abs(s) for s in samples[::7]) / len(samples[::7])
print(f"heard {seconds:.1f} s, mean amplitude {loud:.0f}")
assert 3 < seconds < 13, "it is listened to for about ten seconds"
assert loud > 100, "there is speech"
P

visit silent file
[ "$(said silent)" = "page of central-tower " ] || fail "silent: $(said silent)"
cmp -s "$work/heard/1-page.png" "$work/silent/1-page.png" && fail "the page looks the same with and without sound"

visit broken none --loudness 100
# The first words may be shown before the device was asked.
said broken | grep -qE '^page of central-tower listening begins (words 1 of 6 )?listening ends $' ||
	fail "broken: $(said broken)"
grep -q 'board bug: the sound device' "$work/broken.log" || fail "the log does not name the device"
