"""points_of_a_ball.py FILE.ply: a cloud of 600 points with normals, spread evenly over a ball of 1 m."""
import math
import sys

COUNT = 600
with open(sys.argv[1], "w", encoding="ascii") as out:
    out.write(f"ply\nformat ascii 1.0\nelement vertex {COUNT}\n")
    out.write("".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz")) + "end_header\n")
    for i in range(COUNT):
        z = 1 - (2 * i + 1) / COUNT
        angle = i * math.pi * (3 - math.sqrt(5))  # the golden angle
        at = math.sqrt(1 - z * z) * math.cos(angle), math.sqrt(1 - z * z) * math.sin(angle), z
        out.write(" ".join(f"{x:.6f}" for x in at + at) + "\n")
