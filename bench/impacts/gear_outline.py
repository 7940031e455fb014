#!/usr/bin/python3
"""Outline of an involute gear, as a file of corners that a scene's `surface` reads: one corner "x,y" a line, in modules, about the origin.

    /usr/bin/python3 bench/impacts/gear_outline.py 20 > scenes/gears/gear_20.csv

Pressure angle 20 degrees, tip one module over the pitch circle, root 1.25 modules below it, each tooth thinner than half the pitch by a backlash of
0.04 modules. A tooth stands on the x axis. The flank below the base circle is radial.
"""

import math
import sys

POINTS, PRESSURE, BACKLASH = 24, math.radians(20), 0.04  # of a flank; rad; modules


def outline(teeth):
    pitch = teeth / 2
    base, tip, root = pitch * math.cos(PRESSURE), pitch + 1, pitch - 1.25
    involute = lambda radius: math.tan(math.acos(base / radius)) - math.acos(base / radius)
    half = lambda radius: (math.pi / 2 - BACKLASH / 2) / teeth + involute(pitch) - involute(max(radius, base))
    low = max(base, root)
    # Places evenly along the roll angle, which the contact goes through evenly.
    roll = lambda radius: math.sqrt((radius / base)**2 - 1)
    radii = [base * math.sqrt(1 + (roll(low) + (roll(tip) - roll(low)) * k / (POINTS - 1))**2) for k in range(POINTS)]
    flank = ([(root, half(low))] if root < low else []) + [(r, half(r)) for r in radii]
    corners = []
    for tooth in range(teeth):
        middle = 2 * math.pi * tooth / teeth
        corners += [(r, middle - angle) for r, angle in flank] + [(r, middle + angle) for r, angle in reversed(flank)]
    return [(r * math.cos(a), r * math.sin(a)) for r, a in corners]


if __name__ == "__main__":
    for x, y in outline(int(sys.argv[1])):
        print(f"{x:.9f},{y:.9f}")
