#!/usr/bin/python3
"""The dune in a storm (scenes/dune_box.toml): momentum along x of all that moves, erosion and deposition, winds.

    /usr/bin/python3 bench/saltation/storm.py build/barchan --out /tmp/storm      runs the scene (some minutes), writes results/storm.csv
    /usr/bin/python3 bench/saltation/storm.py none --out /tmp/storm               measures a run that is there

Momentum: what the held bulk speed and the stress of the lid put in, less what air and grains have more of at the end, less what the core (fixed spheres)
and the lid got from grains, is what the ground got from the pressure of the air. That is measured by itself: the pressure of the air's first row (half a spacing over
the ground) along the ground, 250 frames. The friction of the wind on the ground needs no term: the layers near the ground hand it to the grains or, through these, to the core.
Left out: the momentum that the air of these layers gains (below 0.01 N s), and on slopes the reaction of lift on grains of the bed.
"""
import argparse
import json
import math
import pathlib
import sys
import tomllib

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402

RESULT = ROOT / "bench/saltation/results/storm.csv"
SCENE = ROOT / "scenes/dune_box.toml"

WATCHED = 'force=[{ name = "core", phase = "core", by = "sand" }, { name = "lid", phase = "lid", by = "sand" }]'
PLACES = {"windward side, x = 9 to 16 cm": (.09, .16), "crest, 16 to 20 cm": (.16, .20), "slip face, 20 to 24.7 cm": (.20, .247),
          "flat bed behind it, to 40.2 cm": (.247, .402)}


class Ground:
    """Height and slope of the ground: the bed with its asymmetric dune."""

    def __init__(self, scene):
        shape = next(f["shape"] for f in scene["fill"] if f["phase"] == "ground")
        dune = shape["dune"]
        self.width, self.bed, self.at, self.top = scene["domain"]["size"][0], shape["bed"], dune["at"], dune["height"]
        self.lee = self.top / math.tan(math.radians(dune["slip-face-angle"]))
        self.windward = dune["length"] - self.lee

    def along(self, x):
        s = x - self.at
        return s - self.width * np.round(s / self.width)

    def height(self, x):
        s = self.along(x)
        side = np.where(s > -self.windward, self.top / 2 * (1 + np.cos(np.pi * s / self.windward)), 0)
        return self.bed + np.where(s >= 0, np.where(s < self.lee, self.top * (1 - s / self.lee), 0), side)

    def slope(self, x):
        s = self.along(x)
        side = np.where(s > -self.windward, -self.top / 2 * np.pi / self.windward * np.sin(np.pi * s / self.windward), 0)
        return np.where(s >= 0, np.where(s < self.lee, -self.top / self.lee, 0), side)


def over(ground, x):
    """Distance to the ground, m, by its slope below."""
    return (x[:, 1] - ground.height(x[:, 0])) / np.hypot(1, ground.slope(x[:, 0]))


def form_drag(air, ground, spacing):
    """N/m: sum of p dh/dx over cells of 1 mm, p the mean of the first row's particles within 2.5 mm."""
    first = over(ground, air.x) < spacing
    x, p = air.x[first, 0] % ground.width, air["pressure"][first]
    order = np.argsort(x)
    x, p = np.concatenate([x[order] + k * ground.width for k in (-1, 0, 1)]), np.tile(p[order], 3)
    cells = np.arange(0, ground.width, 1e-3) + 5e-4
    sums = np.concatenate([[0], np.cumsum(p)])
    low, high = np.searchsorted(x, cells - 2.5e-3), np.searchsorted(x, cells + 2.5e-3)
    return float(((sums[high] - sums[low]) / np.maximum(high - low, 1) * ground.slope(cells)).sum() * 1e-3)


def summed(t, values):
    return np.concatenate([[0], np.cumsum(np.diff(t) * (values[1:] + values[:-1]) / 2)])


def measure(folder):
    scene = tomllib.loads(SCENE.read_text())
    ground, spacing = Ground(scene), scene["spacing"]
    column = table(folder / "history.csv").__getitem__
    report = json.loads((folder / "run.json").read_text())
    t = column("time [s]")
    paths = [path for _, path in series(folder / "dune_box.pvd")]
    times = np.linspace(0, t[-1], len(paths))
    frames = [Frame(path, time) for path, time in zip((paths[0], paths[-1]), (0, t[-1]))]
    airs = []
    drag = []
    for path, time in zip(paths, times):
        air = Frame(path, time, "air")
        drag.append(form_drag(air, ground, spacing))
        if time > .8 * t[-1]:
            airs.append(air)
    mass = report["particles"]["air"] * scene["phases"]["air"]["density"] * spacing**2
    put = mass * summed(t, column("air_held_acceleration_x [m/s2]")) + scene["phases"]["lid"]["shear-stress"][0] * ground.width * t
    gained = column("momentum_x")
    by_grains = column("core_impulse_x"), column("lid_impulse_x")
    pressure = np.interp(t, times, summed(times, np.array(drag)))
    rest = put - (gained - gained[0]) - by_grains[0] - by_grains[1] - pressure
    sand = [frame["phase"] == frame.names.index("sand") for frame in frames]
    count = lambda k, low, high: int(((frames[k].x[sand[k], 0] >= low) & (frames[k].x[sand[k], 0] < high)).sum())
    height = over(ground, frames[1].x[sand[1]])

    def wind(low, high, top, bottom=0):
        chosen = [a["velocity"][(a.x[:, 0] >= low) & (a.x[:, 0] < high) & (over(ground, a.x) < top) & (over(ground, a.x) >= bottom), 0] for a in airs]
        return float(np.concatenate(chosen).mean())

    return {"put": float(put[-1]), "gained": float(gained[-1] - gained[0]), "core": float(by_grains[0][-1]), "lid": float(by_grains[1][-1]),
            "pressure": float(pressure[-1]), "rest": float(rest[-1]), "share": float(rest[-1] / put[-1]), "largest": float(np.abs(rest).max() / put[-1]),
            "places": {name: [count(0, *x), count(1, *x)] for name, x in PLACES.items()}, "grains": [int(s.sum()) for s in sand],
            "flying": int((height > 5e-4).sum()), "lee": wind(.20, .247, 8e-3), "crest": wind(.18, .20, 8e-3, 1e-3), "far": wind(.33, .40, 8e-3, 1e-3),
            "stress": [float(column("air-sand_ground_stress [Pa]")[k]) for k in (0, -1)], "density": float(column("largest_density_error").max()),
            "fastest": float(column("sand_largest_speed [m/s]").max()), "deepest": float(column("contacts_deepest")[-1]), "steps": report["steps"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--threads", default="2")
    options = parser.parse_args()
    if options.program != "none":
        sets = [WATCHED, "output.every=2e-3", "output.history-every=1e-4", "output.walls=false"]
        run.scene(options.program, SCENE, options.out, sets, threads=options.threads, shown=True)
    result = measure(options.out)
    store.keep(RESULT, result)
    print(json.dumps(result, indent=1))


if __name__ == "__main__":
    main()
