"""60 views round any model, from its box: around.py LOW_X LOW_Y LOW_Z HIGH_X HIGH_Y HIGH_Z

A line a view: eye x y z, target x y z, vertical field of view (metres, z up). 24 of an orbit, 20
from nearer, 16 close to the upper half, where statues have their faces."""
import math
import sys

low, high = (list(map(float, sys.argv[1 + i : 4 + i])) for i in (0, 3))
size = max(h - l for l, h in zip(low, high))
middle = [(l + h) / 2 for l, h in zip(low, high)]
girth = max(high[i] - low[i] for i in (0, 1)) / 2


def arc(count, first_deg, step_deg, away, rise, look):
    """away: of the eye from the axis, rise and look: of eye and target over the foot; in sizes."""
    for i in range(count):
        turn = math.radians(first_deg + step_deg * i)
        lift = rise + 0.12 * math.sin(0.55 * i)
        eye = (middle[0] + away * size * math.cos(turn), middle[1] + away * size * math.sin(turn), low[2] + lift * size)
        target = (middle[0], middle[1], low[2] + look * (high[2] - low[2]))
        print("%.4f %.4f %.4f  %.4f %.4f %.4f  45" % (*eye, *target))


arc(24, -97.0, 9.3, 1.7, 0.7, 0.5)
arc(20, -131.0, 5.1, 0.8 + girth / size / 2, 0.65, 0.6)
arc(16, -113.0, 3.7, 0.35 + girth / size, 0.85, 0.8)
