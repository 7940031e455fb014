#!/usr/bin/python3
"""Masses of twelve shapes at eight spacings that do not divide their sizes, of fluids, elastic and rigid bodies, compared with density times volume.

    masses.py PROGRAM

Rows of a fluid or an elastic body have the mass of the shape within 1e-3, or a warning states by how much they miss it: within 1e-3 of the mass, too. A rigid
body has mass, centre of mass and angular momentum of its shape within 1e-3 (of the size, of the largest component). Prints a line for each failure and
a table; status 1 on failures.
"""
import math
import pathlib
import re
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import run, table  # noqa: E402

BOUND = 1e-3
PARTS = (7.3, 9.1, 10.3, 12.7, 15.3, 20.6, 24.9, 33.3)  # spacings in a metre
DEPTH = 1.1  # m, of the domain along z: shapes of a plane are as long in 3D
KINDS = {"fluid": "sound-speed = 10", "elastic": "young = 1e6\npoisson = 0.3\nformulation = \"updated-lagrangian\"", "rigid": ""}
OMEGA = (1.0, 2.0, 3.0)
TRIANGLE = [(0.513, 0.471), (1.537, 0.613), (0.871, 1.493)]
ELL = [(0.513, 0.471), (1.517, 0.471), (1.517, 0.877), (0.913, 0.877), (0.913, 1.469), (0.513, 1.469)]
SCENE = """dimensions = {dimensions}
spacing = {spacing!r}
domain.size = [{size}]
interactions.a-a = {entry}
time = {{ end = 1e-9, largest-speed = 1 }}
[phases.a]
kind = "{kind}"
density = 1000
{keys}
[[fill]]
phase = "a"
shape = {{ {shape} }}
{motion}
"""


def content(corners):
    """Area, centre and second moments (xx, yy, xy) about it of a polygon, by Green's theorem."""
    x, y = numpy.array(corners).T
    p, q = numpy.roll(x, -1), numpy.roll(y, -1)
    c = x * q - p * y
    area = c.sum() / 2
    at = numpy.array([((x + p) * c).sum(), ((y + q) * c).sum()]) / (6 * area)
    xx, yy = ((x * x + x * p + p * p) * c).sum() / 12, ((y * y + y * q + q * q) * c).sum() / 12
    xy = ((x * q + 2 * x * y + 2 * p * q + p * y) * c).sum() / 24
    return area, at, numpy.array([xx - area * at[0]**2, yy - area * at[1]**2, xy - area * at[0] * at[1]])


def turning(angle):
    return numpy.array([[math.cos(angle), -math.sin(angle), 0], [math.sin(angle), math.cos(angle), 0], [0, 0, 1]])


def brick(sides=(1.0, 0.7, 0.53), angle=0.5):
    """Corners and triangles of a brick that is turned about z, and its content."""
    unit = numpy.array([[k & 1, k >> 1 & 1, k >> 2] for k in range(8)]) - 0.5
    turn = turning(angle)
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    text = "".join("v {!r} {!r} {!r}\n".format(*map(float, p)) for p in unit * sides @ turn.T + [1, 1, 0.55]) + "".join(
        f"f {f[0] + 1} {f[i] + 1} {f[i + 1] + 1}\n" for f in faces for i in (1, 2))
    volume = math.prod(sides)
    return text, (volume, numpy.array([1, 1, 0.55]), turn @ numpy.diag(numpy.square(sides)) @ turn.T * volume / 12)


def shapes(folder):
    """Of each: name, dimensions, text, and what it holds: volume, centre, matrix of second moments."""
    def plane(name, text, corners, solid=False):
        (area, at, second), matrix, length = content(corners), numpy.zeros((3, 3)), DEPTH if solid else 1.0
        matrix[:2, :2] = numpy.array([[second[0], second[2]], [second[2], second[1]]]) * length
        matrix[2, 2] = area * DEPTH**3 / 12 if solid else 0
        return name, 3 if solid else 2, text, (area * length, numpy.array([*at, DEPTH / 2 if solid else 0]), matrix)

    angles = numpy.linspace(0, 2 * math.pi, 50001)
    round_one = lambda a, b: numpy.array([1 + a * numpy.cos(angles), 1 + b * numpy.sin(angles)]).T
    polygon = lambda corners: "polygon = [" + ", ".join(f"[{x!r}, {y!r}]" for x, y in numpy.array(corners).tolist()) + "]"
    box = [(0.513, 0.471), (1.513, 0.471), (1.513, 1.008), (0.513, 1.008)]
    turned = numpy.array([(-0.5, -0.3), (0.5, -0.3), (0.5, 0.3), (-0.5, 0.3)]) @ turning(0.4)[:2, :2].T + 1
    text, of_brick = brick()
    (folder / "brick.obj").write_text(text)
    ball, middle, sides = 4 / 3 * math.pi * 0.125, numpy.array([1, 1, 0.55]), numpy.array([1.0, 0.7, 0.53])
    return [plane("box", "box = { min = [0.513, 0.471], max = [1.513, 1.008] }", box),
            plane("disc", "disc = { centre = [1, 1], radius = 0.5 }", round_one(0.5, 0.5)),
            plane("triangle", polygon(TRIANGLE), TRIANGLE), plane("L", polygon(ELL), ELL), plane("turned box", polygon(turned), turned),
            plane("ring", "ring = { centre = [1, 1], inner = 0.23, outer = 0.5 }", numpy.vstack([round_one(0.5, 0.5), round_one(0.23, 0.23)[::-1]])),
            plane("ellipse by formula", 'formula = "1 - ((x - 1)/0.5)^2 - ((y - 1)/0.33)^2"', round_one(0.5, 0.33)),
            ("box 3D", 3, "box = { min = [0.513, 0.471, 0.3], max = [1.513, 1.171, 0.83] }", (0.371, numpy.array([1.013, 0.821, 0.565]), numpy.diag(sides**2) * 0.371 / 12)),
            ("ball", 3, "sphere = { centre = [1, 1, 0.55], radius = 0.5 }", (ball, middle, numpy.eye(3) * ball * 0.05)),
            plane("cylinder", "disc = { centre = [1, 1, 0], radius = 0.5 }", round_one(0.5, 0.5), solid=True), plane("L prism", polygon(ELL), ELL, solid=True),
            ("brick by file", 3, f'surface = "{folder}/brick.obj"', of_brick)]


def case(program, folder, shape, kind, parts):
    """Largest relative miss, what was stated of it (None: nothing), and whether all is well."""
    _, dimensions, text, (volume, centre, second) = shape
    motion = "velocity = [1, 0{}]\nangular-velocity = {}".format(*((", 0", list(OMEGA)) if dimensions == 3 else ("", OMEGA[2]))) if kind == "rigid" else ""
    scene = SCENE.format(dimensions=dimensions, spacing=1 / parts, size=", ".join(map(str, (2, 2, DEPTH)[:dimensions])), kind=kind, keys=KINDS[kind],
                         entry="false" if kind == "rigid" else "2.1", shape=text, motion=motion)
    if kind != "rigid":
        done = run.command([program, "plan", run.scene_file(scene, folder)], check=True)
        count = int(re.search(rf"^a +{kind} +(\d+)", done.stdout, re.M)[1])
        miss = count / parts**dimensions / volume - 1
        stated = re.search(r"([-+][\d.]+) % off", done.stdout + done.stderr)
        return abs(miss), stated and float(stated[1]) / 100, abs(miss) <= BOUND or bool(stated and abs(float(stated[1]) / 100 - miss) <= BOUND * (1 + miss))
    row = run.scene(program, scene, folder).history().rows()[0]
    mass, axes = row["momentum_x"], "xyz"[:dimensions]
    omega = numpy.array(OMEGA if dimensions == 3 else (0, 0, OMEGA[2]))
    momentum = 1000 * (numpy.trace(second) * numpy.eye(3) - second) @ omega
    found = [row[f"a_angular_momentum_{c}"] for c in axes] if dimensions == 3 else [0, 0, row["a_angular_momentum"]]
    misses = [abs(mass / volume / 1000 - 1), *(abs(row[f"a_{c}"] - centre[d]) for d, c in enumerate(axes)), *(abs(numpy.array(found) - momentum) / abs(momentum).max())]
    return max(misses), None, max(misses) <= BOUND


def main():
    program, failures = pathlib.Path(sys.argv[1]).resolve(), 0
    print(table.head("shape", "kind", "largest miss", "spacings above 1e-3", "of these stated", ""))
    with tempfile.TemporaryDirectory() as scratch:
        for shape in shapes(pathlib.Path(scratch)):
            for kind in KINDS:
                cases = [case(program, pathlib.Path(scratch) / "run", shape, kind, parts) for parts in PARTS]
                over = [c for c in cases if c[0] > BOUND]
                failures += sum(not c[2] for c in cases)
                print(table.row(shape[0], kind, f"{max(c[0] for c in cases):.2g}", len(over), sum(c[1] is not None for c in over), table.missed(all(c[2] for c in cases))), flush=True)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
