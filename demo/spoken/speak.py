#!/usr/bin/env python3
"""Makes the spoken pages of the demo: demo/content/pages/ID.LANGUAGE.opus and .vtt.

    demo/spoken/speak.py

Each file ID.LANGUAGE.txt beside this script has the voice in its first line, and then a line for
each cue. espeak-ng speaks them, opusenc encodes (Debian's espeak-ng and opus-tools). The results
are part of the repository, so that a build needs neither."""
import glob
import io
import os
import subprocess
import wave

HERE = os.path.dirname(os.path.abspath(__file__))
PAGES = os.path.join(HERE, "..", "content", "pages")
PAUSE_S = 0.35


def say(voice, text):
    """Returns the samples of a line and their rate."""
    wav = subprocess.run(["espeak-ng", "-v", voice, "-s", "150", "--stdout", text], check=True, capture_output=True).stdout
    # espeak-ng cannot know the length when it writes the head.
    with wave.open(io.BytesIO(wav)) as file:
        return wav[44:], file.getframerate()


def moment(seconds):
    return f"{int(seconds // 60):02}:{seconds % 60:06.3f}"


for path in sorted(glob.glob(os.path.join(HERE, "*.txt"))):
    with open(path, encoding="utf-8") as file:
        voice, *lines = file.read().splitlines()
    samples, cues, rate = b"", "WEBVTT\n", 22050
    for line in lines:
        said, rate = say(voice, line)
        begin = len(samples) / 2 / rate
        samples += said
        cues += f"\n{moment(begin)} --> {moment(len(samples) / 2 / rate)}\n{line}\n"
        samples += bytes(2 * int(PAUSE_S * rate))
    name = os.path.join(PAGES, os.path.basename(path)[: -len(".txt")])
    with open(name + ".vtt", "w", encoding="utf-8") as file:
        file.write(cues)
    subprocess.run(["opusenc", "--quiet", "--raw", "--raw-rate", str(rate), "--raw-chan", "1", "--bitrate", "18",
                    "--framesize", "60", "--serial", "1", "--discard-comments", "-", name + ".opus"], input=samples, check=True)
    print(f"{name}.opus: {os.path.getsize(name + '.opus')} bytes, {len(samples) / 2 / rate:.1f} s")
