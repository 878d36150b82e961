"""tools.py FOLDER: what the tools do to the pictures of tools.sh. Means over the part of the panel where
neither labels nor controls are."""
import struct
import sys
import zlib

LEFT, TOP, RIGHT, BOTTOM = 200, 60, 600, 480
SECTION = (158, 71, 38)


def pixels(name):
    data = open(f"{sys.argv[1]}/{name}.png", "rb").read()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if kind == b"IHDR":
            width, _, depth, colour = struct.unpack(">IIBB", body[:10])
            assert depth == 8
            each = {2: 3, 6: 4}[colour]
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    raw, stride, rows, above = zlib.decompress(packed), width * each, [], bytes(width * each)
    for start in range(0, len(raw), stride + 1):
        how, row = raw[start], bytearray(raw[start + 1:start + 1 + stride])
        for i in range(stride if how else 0):
            a = row[i - each] if i >= each else 0
            b, c = above[i], above[i - each] if i >= each else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            row[i] = (row[i] + (0, a, b, (a + b) // 2, paeth)[how]) & 255
        rows.append(row)
        above = row
    return [tuple(rows[y][each * x:each * x + 3]) for y in range(TOP, BOTTOM) for x in range(LEFT, RIGHT)]


def off(a, b):
    return sum(abs(p - q) for x, y in zip(a, b) for p, q in zip(x, y)) / len(a) / 3


def cut(picture):
    return sum(all(abs(p - q) < 10 for p, q in zip(pixel, SECTION)) for pixel in picture) / len(picture)


names = ("light", "lower", "whole-again", "section", "pushed", "turned", "whole-at-last", "both", "nobody")
seen = {name: pixels(name) for name in names}
for name in names:
    print(f"{name}: {off(seen[name], seen['whole-again']):.1f} of 255 off what it was, {cut(seen[name]):.3f} of section")
assert off(seen["whole-at-last"], seen["whole-again"]) < 2.5
for name in ("light", "lower", "section", "pushed", "turned", "both"):
    assert off(seen[name], seen["whole-again"]) > 5, name
assert off(seen["light"], seen["lower"]) > 5 and off(seen["section"], seen["pushed"]) > 5
assert off(seen["pushed"], seen["turned"]) > 5
for name in names:
    holds_section = name in ("section", "pushed", "turned", "both")
    assert (cut(seen[name]) > 0.02) == holds_section and (holds_section or cut(seen[name]) < 0.005), name
