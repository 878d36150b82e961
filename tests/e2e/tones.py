"""tones.py PNG LEAST: fails unless the picture holds at least LEAST different colours: a blank or
plain one does not."""
import struct
import sys
import zlib


def colours(path):
    data = open(path, "rb").read()
    at, packed, width, bytes_per_pixel = 8, b"", 0, 4
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, _, _, colour = struct.unpack(">IIBB", body[:10])
            bytes_per_pixel = {2: 3, 6: 4}[colour]
        elif kind == b"IDAT":
            packed += body
        at += size + 12
    raw = zlib.decompress(packed)
    # Filtered bytes serve as well as colours: a plain picture filters to a handful of values.
    stride = width * bytes_per_pixel + 1
    return len({raw[y + x : y + x + bytes_per_pixel] for y in range(0, len(raw), stride * 3)
                for x in range(1, stride, bytes_per_pixel * 2)})


found = colours(sys.argv[1])
print(f"{sys.argv[1]}: {found} tones")
sys.exit(0 if found >= int(sys.argv[2]) else 1)
