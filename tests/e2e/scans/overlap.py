"""Cuts a scan into two that overlap, as a site is recorded: overlap.py SCAN.ply FOLDER. The first is binary, of the
other byte order; the second was recorded far away, lying on its side and mirrored. FOLDER/site.aln and FOLDER/site.mlp
place them where they were, but for the error that no alignment is without."""
import struct
import sys

scan, folder = sys.argv[1:]
OVERLAP_M = 0.02
ERROR_M = 0.0002
# From the place of the second scan to that of the first: mirrored in x, a quarter turn about x, and a shift.
MATRIX = [[-1, 0, 0, 1000], [0, 0, -1, -2000], [0, 1, 0, 500], [0, 0, 0, 1]]
STAY = [[float(row == column) for column in range(4)] for row in range(4)]


def read(path):
    lines = open(path)
    counts = {}
    for line in lines:
        words = line.split()
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        if words[0] == "end_header":
            break
    vertices = [tuple(map(float, next(lines).split()[:3])) for _ in range(counts["vertex"])]
    return vertices, [tuple(map(int, next(lines).split()[1:4])) for _ in range(counts["face"])]


def write(path, vertices, faces, coordinate):
    with open(path, "wb") as out:
        kind = {"f": "float", "d": "double"}[coordinate]
        out.write(f"ply\nformat binary_big_endian 1.0\nelement vertex {len(vertices)}\n".encode())
        out.write("".join(f"property {kind} {axis}\n" for axis in "xyz").encode())
        out.write(f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
        for vertex in vertices:
            out.write(struct.pack(f">3{coordinate}", *vertex))
        for face in faces:
            out.write(struct.pack(">B3i", 3, *face))


def undo(vertex):
    x, y, z = (vertex[k] - MATRIX[k][3] for k in range(3))
    return -x, z, -y


vertices, faces = read(scan)
middle = sum(v[0] for v in vertices) / len(vertices)
left = [f for f in faces if min(vertices[k][0] for k in f) < middle + OVERLAP_M / 2]
right = [f for f in faces if max(vertices[k][0] for k in f) > middle - OVERLAP_M / 2]
write(f"{folder}/left.ply", vertices, left, "f")
write(f"{folder}/right.ply", [undo(v) for v in vertices], [(a, c, b) for a, b, c in right], "d")


def rows(matrix):
    return "".join(" ".join(f"{number:.10g}" for number in row) + " \n" for row in matrix)


aligned = [row[:3] + [row[3] + (ERROR_M if k < 3 else 0)] for k, row in enumerate(MATRIX)]
places = {"left.ply": STAY, "right.ply": aligned}
with open(f"{folder}/site.aln", "w") as out:
    out.write("2\n" + "".join(f"{name}\n#\n{rows(matrix)}" for name, matrix in places.items()) + "0\n")
with open(f"{folder}/site.mlp", "w") as out:
    out.write("<!DOCTYPE MeshLabDocument>\n<MeshLabProject>\n <MeshGroup>\n")
    for name, matrix in places.items():
        out.write(f'  <MLMesh label="{name}" visible="1" filename="{name}">\n   <MLMatrix44>\n{rows(matrix)}'
                  "</MLMatrix44>\n  </MLMesh>\n")
    out.write(" </MeshGroup>\n <RasterGroup/>\n</MeshLabProject>\n")
