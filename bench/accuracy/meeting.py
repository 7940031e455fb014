#!/usr/bin/python3
"""Where a fluid meets another thing: still water between slanted walls, two fluids in Couette's flow, a plate that swings in water.

    /usr/bin/python3 bench/accuracy/meeting.py build/barchan [tanks] [couette] [wet-plate] [--runs DIR]

tanks: water at rest for 4 s between sides of 20, 45 and 60 degrees, in a box turned by 17 degrees, in half a disc, with 15 and 30 rows, both slips; in 3D once (45
degrees, 12 rows, 1.5 s). Prints the largest speed over sqrt(g H) in each quarter of the time. The bound is 5e-3 in the last, falling with the rows.

couette: two fluids of one density, viscosities of ratio 2, 10, 100, from the exact profile and with places disturbed by 0.1 spacings: the speed of the interface over
1/(1 + ratio), and the mean error of the velocity in each fluid, at 2 s. The bound is 2 %, and an error that falls with the rows.

wet-plate: a periodic plate (1 m, 4 cm, 1000 kg/m3) between two layers of 0.3 m of water in free slip. Its frequency wet and dry gives the added mass, which is
2 rho/(k tanh(k d)) by potential flow (Lamb 1932, section 228); the plate's own inertia with and without that of its turning. The bound is 2 % with 15 spacings of water (0.02 m), 0.5 % with 30.
"""

import argparse
import math
import pathlib
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import frame, run as runs, table  # noqa: E402

G, DEPTH = 9.81, .3


def polygon(corners):
    return "{ polygon = [" + ", ".join(f"[{x:.12g}, {y:.12g}]" for x, y in corners) + "] }"


def slanted(angle, thick):
    """Wall and water of a trough 0.6 m wide on its floor."""
    th, half, rise = math.radians(angle), .3, 1.4 * DEPTH
    out, up, mitre = thick * math.sin(th), -thick * math.cos(th), thick * math.tan(th / 2)
    far, side = half + rise / math.tan(th), half + DEPTH / math.tan(th)
    wall = [(-half, 0), (half, 0), (far, rise), (far + out, rise + up), (half + mitre, -thick), (-half - mitre, -thick), (-far - out, rise + up), (-far, rise)]
    return wall, [(-half, 0), (half, 0), (side, DEPTH), (-side, DEPTH)]


def turned(angle, thick):
    """A box 0.6 m wide, turned; water to the height DEPTH over its lowest corner's level."""
    c, s, half, high = math.cos(math.radians(angle)), math.sin(math.radians(angle)), .3, .8

    def turn(x, y):
        return x * c - y * s, x * s + y * c

    def level(p, q):
        return p[0] + (DEPTH - p[1]) / (q[1] - p[1]) * (q[0] - p[0]), DEPTH
    wall = [turn(*p) for p in ((-half, 0), (half, 0), (half, high), (half + thick, high), (half + thick, -thick), (-half - thick, -thick), (-half - thick, high), (-half, high))]
    a, b, d, e = (turn(*p) for p in ((-half, high), (-half, 0), (half, 0), (half, high)))
    return wall, [level(a, b), b, d, level(d, e)]


def bowl(thick):
    """Half a disc of the radius DEPTH full of water; its wall goes on above."""
    begin, end = math.pi - math.asin(.6), 2 * math.pi + math.asin(.6)

    def arc(r, a, b, n):
        return [(r * math.cos(a + (b - a) * k / n), r * math.sin(a + (b - a) * k / n)) for k in range(n + 1)]
    return arc(DEPTH, begin, end, 96) + arc(DEPTH + thick, begin, end, 96)[::-1], arc(DEPTH, math.pi, 2 * math.pi, 64)


def tank(shapes, dx, slip, end, deep=False):
    wall, water = shapes
    low, high = ([f(p[k] for p in wall) + sign * dx for k in (0, 1)] for f, sign in ((min, -1), (max, 1)))
    size, radius = [h - a for a, h in zip(low, high)], 2.1 if deep else 2.6
    third = ([0.], [8 * dx], [0.]) if deep else ([], [], [])
    return f"""dimensions = {3 if deep else 2}
spacing = {dx:.12g}
[domain]
origin = {low + third[0]}
size = {size + third[1]}
gravity = {[0., -G] + third[2]}
{'periodic = ["z"]' if deep else ''}
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = {20 * math.sqrt(G * DEPTH):.6g}
[phases.tank]
kind = "wall"
slip = "{slip}"
[interactions]
water-water = {radius}
water-tank = {radius}
[[fill]]
phase = "tank"
shape = {polygon(wall)}
packing = "relaxed"
[[fill]]
phase = "water"
shape = {polygon(water)}
pressure = "hydrostatic"
packing = "relaxed"
[time]
end = {end}
largest-speed = 0.2
[output]
every = {end}
history-every = 0.01
"""


def tanks(start):
    cases = {f"sides of {a} degrees": lambda t, a=a: slanted(a, t) for a in (20, 45, 60)} | {"box turned by 17 degrees": lambda t: turned(17, t), "half a disc": bowl}
    every = [(name, make, rows, slip, False) for rows in (15, 30) for name, make in cases.items() for slip in ("no-slip", "free-slip")]
    print(table.head("tank", "rows", "slip", "largest speed over sqrt(g H), by quarters of the time"))
    for name, make, rows, slip, deep in [*every, ("3D, sides of 45 degrees", lambda t: slanted(45, t), 12, "no-slip", True)]:
        dx = DEPTH / rows
        history = start(f"tank {name} {rows} {slip}", tank(make(5 * dx), dx, slip, 1.5 if deep else 4., deep)).history()
        parts = numpy.array_split(history["water_largest_speed"] / math.sqrt(G * DEPTH), 4)
        print(table.row(name, rows, slip, ", ".join(f"{part.max():.2g}" for part in parts)), flush=True)


def two_layers(rows, ratio, disturbed):
    dx, speed = 1 / rows, 1 / (1 + ratio)
    fluids = "".join(f'[phases.{name}]\nkind = "fluid"\ndensity = 1000\nviscosity = {nu!r}\nsound-speed = 15\n' for name, nu in (("a", .01 * ratio), ("b", .01)))
    perturb = f"perturb = {disturbed}\n" if disturbed else ""
    return f"""spacing = {dx!r}
[domain]
size = [{8 * dx!r}, 1]
periodic = ["x"]
{fluids}[phases.floor]
kind = "wall"
[phases.lid]
kind = "wall"
velocity = [1, 0]
[interactions]
a-a = 2.6
b-b = 2.6
a-b = 2.6
a-floor = 2.6
b-lid = 2.6
a-lid = false
b-floor = false
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"] }}
[[fill]]
phase = "lid"
shape = {{ sides = ["top"] }}
[[fill]]
phase = "a"
shape = {{ box = {{ min = [0, 0], max = [{8 * dx!r}, 0.5] }} }}
velocity = ["{2 * speed!r}*y", 0]
{perturb}[[fill]]
phase = "b"
shape = {{ box = {{ min = [0, 0.5], max = [{8 * dx!r}, 1] }} }}
velocity = ["{speed!r}+(2*y-1)*{1 - speed!r}", 0]
{perturb}[time]
end = 2
largest-speed = 1
[output]
every = 2
"""


def couette(start):
    print(table.head("places", "ratio of viscosities", "rows", "speed of the interface over the exact one, from below and above", "mean error of the velocity"))
    for disturbed in (0, .1):
        for ratio in (2, 10, 100):
            for rows in (20, 40):
                ended, speed, found, errors = start(f"couette {disturbed} {ratio} {rows}", two_layers(rows, ratio, disturbed)), 1 / (1 + ratio), [], []
                for name, exact in (("a", lambda y: 2 * speed * y), ("b", lambda y: speed + (2 * y - 1) * (1 - speed))):
                    last = frame.Frame(list(ended.series())[-1][1], phase=name)
                    y, u = last.x[:, 1], last["velocity"][:, 0]
                    near = numpy.abs(y - .5) < .2
                    found.append(numpy.polyfit(y[near] - .5, u[near], 1)[1] / speed)
                    errors.append(numpy.abs(u - exact(y)).mean())
                print(table.row("disturbed" if disturbed else "rows", ratio, rows, f"{found[0]:.4f}, {found[1]:.4f}", f"{errors[0]:.1e}, {errors[1]:.1e}"), flush=True)


def plate(dx, own, wet):
    k, floor, top, deep = 2 * math.pi, .3, .34, .3
    amplitude = .01 / math.sinh(k * deep)
    water = f"""[phases.water]
kind = "fluid"
density = 1000
sound-speed = 40
[phases.wall]
kind = "wall"
slip = "free-slip"
""" if wet else ""
    pairs = "water-water = {}\nwater-plate = {}\nwater-wall = {}\nplate-wall = false\n" if wet else ""
    fills = '[[fill]]\nphase = "wall"\nshape = { sides = ["bottom", "top"] }\n' if wet else ""
    for low, high, sign, y in ((0, floor, 1, "y"), (top, top + deep, -1, f"({top + deep}-y)")) if wet else ():
        fills += (f'[[fill]]\nphase = "water"\nshape = {{ box = {{ min = [0, {low}], max = [1, {high}] }} }}\n'
                  f'velocity = ["{sign * amplitude!r}*cosh({k!r}*{y})*cos({k!r}*x)", "{amplitude!r}*sinh({k!r}*{y})*sin({k!r}*x)"]\n')
    return f"""spacing = {dx}
[domain]
size = [1, {top + deep}]
periodic = ["x"]
[phases.plate]
kind = "elastic"
spacing = {own}
density = 1000
young = 4.08e6
poisson = 0.3
{water}[interactions]
plate-plate = {{}}
{pairs}[[fill]]
phase = "plate"
shape = {{ box = {{ min = [0, {floor}], max = [1, {top}] }} }}
velocity = [0, "0.01*sin({k!r}*x)"]
{fills}[[marker]]
name = "mid"
phase = "plate"
box = {{ min = [0.24, {floor}], max = [0.26, {top}] }}
[time]
end = 2
largest-speed = 0.02
[output]
every = 2
history-every = 0.002
walls = false
"""


def frequency(history):
    """rad/s, of the swing of the middle of the plate: least squares of a sine, a cosine and a drift."""
    t, y = history["time"], history["mid_y"] - history["mid_y"][0]

    def left(w):
        terms = numpy.stack([numpy.sin(w * t), numpy.cos(w * t) - 1, t], 1)
        return ((terms @ numpy.linalg.lstsq(terms, y, rcond=None)[0] - y) ** 2).sum()
    low, high = 3., 60.
    for _ in range(5):
        tried = numpy.linspace(low, high, 800)
        best = int(numpy.argmin([left(w) for w in tried]))
        low, high = tried[max(best - 1, 0)], tried[min(best + 1, len(tried) - 1)]
    return .5 * (low + high)


def wet_plate(start):
    k, mass, thick = 2 * math.pi, 40., .04
    exact = 2 * 1000 / (k * math.tanh(k * .3))
    print(table.head("spacing of water, m", "of the plate, m", "wet, rad/s", "dry, rad/s", "added mass over potential flow's", "the same, inertia of turning left out"))
    for dx, own in ((.02, .01), (.01, .01), (.01, .005)):
        wet, dry = (frequency(start(f"plate {dx} {own} {wet}", plate(dx, own, wet)).history()) for wet in (True, False))
        plain = mass * ((dry / wet) ** 2 - 1) / exact
        print(table.row(dx, own, f"{wet:.4f}", f"{dry:.4f}", f"{plain * (1 + (k * thick) ** 2 / 12):.4f}", f"{plain:.4f}"), flush=True)


CASES = {"tanks": tanks, "couette": couette, "wet-plate": wet_plate}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", nargs="*", choices=[*CASES, []], default=[])
    parser.add_argument("--runs", metavar="DIR")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as own:
        def start(name, text):
            folder = pathlib.Path(options.runs or own) / name.replace(" ", "_").replace(",", "")
            return runs.scene(options.program, text, folder)
        for name in options.cases or CASES:
            CASES[name](start)


if __name__ == "__main__":
    main()
