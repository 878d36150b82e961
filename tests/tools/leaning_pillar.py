"""leaning_pillar.py FOLDER LEAN: writes FOLDER/pillar.obj, .mtl and .png, a textured pillar 4 m high on a slab, off its
foot by LEAN metres for each metre of height."""
import math
import struct
import sys
import zlib

SIDES, RINGS, SIDE_PX = 48, 33, 256


def png(side, colour_at):
    rows = b"".join(
        b"\0" + b"".join(bytes(colour_at(x, y)) for x in range(side)) for y in range(side)
    )

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def bricks(x, y):
    """Courses of bricks with dark joints, each of its own shade."""
    course = y // 16
    column = (x + 16 * (course % 2)) // 32
    if y % 16 < 2 or (x + 16 * (course % 2)) % 32 < 2:
        return 60, 50, 45
    shade = (course * 37 + column * 91) % 80
    return 150 + shade, 90 + shade // 2, 60 + shade // 4


def main(folder, lean):
    lines = ["mtllib pillar.mtl", "usemtl bricks"]
    corners = []
    for ring in range(RINGS):
        z = 4 * ring / (RINGS - 1)
        for side in range(SIDES + 1):
            turn = 2 * math.pi * side / SIDES
            corners.append((0.6 * math.cos(turn) + lean * z, 0.6 * math.sin(turn), z, side / SIDES, z / 4))
    top = len(corners)
    for side in range(SIDES):
        turn = 2 * math.pi * side / SIDES
        corners.append((0.6 * math.cos(turn) + 4 * lean, 0.6 * math.sin(turn), 4, side / SIDES, 0.99))
    slab = len(corners)
    corners += [(x, y, 0, 0.5 + x / 6, 0.5 + y / 6) for y in (-2, 2) for x in (-2, 2)]
    lines += [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z, _, _ in corners]
    lines += [f"vt {u:.6f} {v:.6f}" for _, _, _, u, v in corners]
    faces = []
    for ring in range(RINGS - 1):
        for side in range(SIDES):
            a = ring * (SIDES + 1) + side
            faces.append((a, a + 1, a + SIDES + 2, a + SIDES + 1))
    faces.append(tuple(range(top, top + SIDES)))
    faces.append((slab, slab + 1, slab + 3, slab + 2))
    lines += ["f " + " ".join(f"{n + 1}/{n + 1}" for n in face) for face in faces]
    with open(f"{folder}/pillar.obj", "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")
    with open(f"{folder}/pillar.mtl", "w", encoding="ascii") as file:
        file.write("newmtl bricks\nKd 1 1 1\nmap_Kd pillar.png\n")
    with open(f"{folder}/pillar.png", "wb") as file:
        file.write(png(SIDE_PX, bricks))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]))
