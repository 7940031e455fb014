#!/usr/bin/python3
"""What enters the wind tunnel: the grains in flight and the wind of a saturated column (scenes/saltation.toml).

    /usr/bin/python3 bench/saltation/feed.py build/barchan       runs the column (3 minutes) and writes scenes/dune_influx.vtp and scenes/dune_wind.csv
    /usr/bin/python3 bench/saltation/feed.py none --out DIR      of a run that is there

The column has the grains and the air of scenes/dune.toml and u* = 0.5 m/s. All frames from 0.6 s on are joined into one: their grains that go along the wind, a diameter
and more over the bed. They are drawn with a weight that is their speed ([[influx]]), so that their flux by height is that of the column. Heights are those over the bed of the
tunnel. The wind is the column's mean, over its top the logarithmic one of u* = 0.5 m/s.
"""
import argparse
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run  # noqa: E402
from barchan_bench.frame import Frame, series, table, write_particles  # noqa: E402

BED, HEIGHT, START, FRICTION_VELOCITY, DIAMETER = 0.0065, 0.25, 0.6, 0.5, 2.5e-4  # m: of the tunnel; s; m/s; m
KEYS = {"phases.air.friction-velocity": FRICTION_VELOCITY, "phases.air.density": 1.225, "phases.air.viscosity": 1.48e-5, "phases.sand.density": 2650,
        "phases.sand.diameter": "{ mean = 2.5e-4, spread = 0.15 }", "phases.sand.restitution": 0.7, "phases.sand.friction": 0.3,
        "phases.sand.rolling-friction": 1.0, "interactions.air-sand.magnus": "true", "phases.floor.density": 2650, "phases.floor.diameter": 2.5e-4, "fill.0.shape": "{ bed = 2.5e-4 }",
        "fill.1.shape": "{ bed = 2.9e-3, from = 2.5e-4 }", "output.every": 0.01, "output.fields": '["radius"]'}


def grains(folder):
    """Places, velocities and radii of the grains in flight of all frames from START on, heights over the bed of the tunnel."""
    bed = table(folder / "history.csv")
    x, velocity, radius = [], [], []
    for time, path in series(folder / "saltation.pvd"):
        if time < START:
            continue
        frame = Frame(path, phase="sand")
        height = frame.x[:, 1] - np.interp(time, bed["time"], bed["sand_bed"])
        flies = (height > DIAMETER) & (frame["velocity"][:, 0] > 0.1)
        x.append(np.column_stack([frame.x[flies, 0], height[flies] + BED, 0 * height[flies]]))
        velocity.append(frame["velocity"][flies])
        radius.append(frame["radius"][flies])
    return (np.concatenate(values) for values in (x, velocity, radius))


def wind(folder):
    """y (m) and speed (m/s) over the bed of the tunnel."""
    column = table(folder / "saltation_sand.csv")
    height, speed = column["height_over_bed"], column["air_speed"]
    kept = (height > 0) & (height < 0.09)
    height, speed = height[kept][::2], speed[kept][::2]
    fit = height > 0.06
    friction = np.polyfit(np.log(height[fit]), speed[fit], 1)[0] * 0.4
    print(f"in the upper third of the column the wind is logarithmic with u* = {friction:.3f} m/s")
    above = np.geomspace(height[-1] * 1.05, HEIGHT, 12)
    return np.append(height, above) + BED, np.append(speed, speed[-1] + FRICTION_VELOCITY / 0.4 * np.log(above / height[-1]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("barchan")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/barchan_feed"))
    parser.add_argument("--to", type=pathlib.Path, default=ROOT / "scenes")
    options = parser.parse_args()
    if options.barchan != "none":
        run.scene(options.barchan, ROOT / "scenes/saltation.toml", options.out, [f"{key}={value}" for key, value in KEYS.items()])
    x, velocity, radius = grains(options.out)
    write_particles(options.to / "dune_influx.vtp", x.astype(np.float32), "sand", velocity=velocity.astype(np.float32), radius=radius.astype(np.float32))
    print(f"{len(x)} grains in flight, mean speed along the wind {velocity[:, 0].mean():.2f} m/s, mean height {x[:, 1].mean() - BED:.4f} m")
    lines = ["y [m],velocity_x [m/s]", *(f"{y:.6g},{u:.6g}" for y, u in zip(*wind(options.out)))]
    (options.to / "dune_wind.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
