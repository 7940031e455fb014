#!/usr/bin/python3
"""Bodies that sink in a pool with the keys that a scene has by itself: none may end the run or send it back.

    /usr/bin/python3 bench/robustness/sinking.py build/barchan [--only NAME] [--runs DIR]

A disc (radius 6 spacings, 2650 kg/m3) from six heights, with its walls of both slips; boxes; twelve discs that fall into the pool from above; a sphere in 3D; in both
schemes. Prints for each: status, steps, how often the run went back, largest error of the density after the first 20 ms, the speed after a way of one radius over that of an ideal fluid
without bound, and the largest overlap. Exits with 1 where a run ends or goes back.
"""

import argparse
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import run as runs, table  # noqa: E402

RADII = {"consistent": 2.6, "plain": 3.0}
HEIGHTS = (.12, .18, .25, .31, .37, .43)


def scene(scheme, fills, size, depth, end, slip="no-slip", dx=.01, sound=30):
    """fills: of the bodies, TOML; size: of the tank (m); depth: of the water (m)."""
    r, dimensions = RADII[scheme], len(size)
    sides = '["bottom", "left", "right"]' if dimensions == 2 else '["bottom", "left", "right", "back", "front"]'
    low, high = ([0] * dimensions, [*size[:-1], depth])
    gravity = [0] * (dimensions - 1) + [-9.81]
    if dimensions == 3:  # y is up
        high, gravity = [size[0], depth, size[2]], [0, -9.81, 0]
    return f"""dimensions = {dimensions}
spacing = {dx}
[domain]
size = {list(size)}
gravity = {gravity}
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = {sound}
scheme = "{scheme}"
[phases.tank]
kind = "wall"
slip = "{slip}"
[phases.body]
kind = "rigid"
density = 2650
[interactions]
water-water = {r}
water-tank = {r}
water-body = {r}
body-tank = {{}}
body-body = {{}}
[[fill]]
phase = "tank"
shape = {{ sides = {sides} }}
{fills}
[[fill]]
phase = "water"
shape = {{ box = {{ min = {low}, max = {high} }} }}
pressure = "hydrostatic"
leave-out = "earlier-fills"
[time]
end = {end}
largest-speed = {sound / 10}
[output]
every = 0.1
history-every = 0.005
"""


def body(shape, more=""):
    return f'[[fill]]\nphase = "body"\nshape = {{ {shape} }}\n{more}'


def disc(x, y, r=.06):
    return body(f"disc = {{ centre = [{x}, {y}], radius = {r} }}")


def box(x, y, w, h):
    return body(f"box = {{ min = [{x - w / 2}, {y}], max = [{x + w / 2}, {y + h}] }}")


def cases():
    """Name: (scene, radius of the fall that is measured or None)."""
    pool = (.6, .8)
    for scheme in RADII:
        for slip in ("no-slip", "free-slip"):
            for h in HEIGHTS:
                yield f"disc {h} m, {slip}, {scheme}", scene(scheme, disc(.3, .06 + h), pool, .6, 1., slip), .06
        for name, (w, h) in {"flat": (.16, .06), "square": (.1, .1), "tall": (.06, .2)}.items():
            yield f"{name} box, {scheme}", scene(scheme, box(.3, .3, w, h), pool, .6, 1.), None
        twelve = "".join(disc(.09 + .11 * (k % 4) + .03 * (k // 4), .58 + .11 * (k // 4), .04) for k in range(12))
        yield f"twelve discs, {scheme}", scene(scheme, twelve, (.6, 1.2), .5, 1.5), None
        yield (f"sphere, {scheme}", scene(scheme, body("sphere = { centre = [0.2, 0.25, 0.2], radius = 0.06 }"), (.4, .5, .4), .4, .8, dx=.02), .06)


def speed_of_fall(history, radius, dimensions):
    """Speed after a way of one radius over that of an ideal fluid without bound, whose added mass is that of the displaced fluid (2D) or half of it (3D)."""
    ideal = math.sqrt(2 * 9.81 * 1.65 / (2.65 + (1. if dimensions == 2 else .5)) * radius)
    way, last = 0., (0., 0.)
    for t, v in zip(history["time [s]"], history["body_largest_speed [m/s]"]):
        way += .5 * (v + last[1]) * (t - last[0])
        last = t, v
        if way >= radius:
            return v / ideal
    return math.nan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--only", default="")
    parser.add_argument("--runs", metavar="DIR")
    options = parser.parse_args()
    good = True
    print(table.head("case", "status", "steps", "went back", "density off", "speed after one radius/ideal", "overlap, m"))
    with tempfile.TemporaryDirectory() as own:
        for name, text, radius in cases():
            if options.only not in name:
                continue
            folder = pathlib.Path(options.runs or own) / name.replace(" ", "_").replace(",", "")
            ended = runs.scene(options.program, text, folder, check=False)
            back = "went back" in ended.stdout + ended.stderr
            good = good and ended.status == 0 and not back
            history = ended.history()
            late = history["time [s]"] > .02
            speed = speed_of_fall(history, radius, 3 if "sphere" in name else 2) if radius else math.nan
            overlap = max((history[key].max() for key in history if "overlap" in key), default=math.nan)
            print(table.row(name, ended.status, int(history["step"][-1]), "yes" if back else "no", f"{history['largest_density_error'][late].max():.3f}", f"{speed:.3f}",
                            f"{overlap:.2g}"), flush=True)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
