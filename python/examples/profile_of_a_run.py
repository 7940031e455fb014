#!/usr/bin/python3
"""The profile of a channel against theory: runs a scene that measures, reads what it measured, prints both.

    PYTHONPATH=python /usr/bin/python3 python/examples/profile_of_a_run.py
"""

import pathlib

import barchan

scenes = pathlib.Path(barchan.__file__).resolve().parents[2] / "scenes"  # of the source tree, or PREFIX/share/barchan/scenes
series = barchan.run(scenes / "verification/poiseuille.toml", out="out/poiseuille", threads=1)
profile = series.profiles["across"]
y, u = profile["y"], profile["velocity_mean_x"]
# steady flow between walls: u = a y (H - y)/(2 nu), with the acceleration a and the viscosity nu of the scene
scene = barchan.scene.load(scenes / "verification/poiseuille.toml")
height, nu = scene["domain"]["size"][1], scene["phases"]["water"]["viscosity"]
a = scene["forcing"][0]["acceleration"][0]
theory = a * y * (height - y) / (2 * nu)
print(f"{len(y)} points, {int(profile['samples'].max())} samples in time")
for k in range(0, len(y), max(len(y) // 8, 1)):
    print(f"y = {1e3 * y[k]:.3f} mm: {1e6 * u[k]:7.3f} um/s, in theory {1e6 * theory[k]:7.3f}")
print(f"largest difference {100 * abs(u - theory).max() / theory.max():.2f} % of the largest speed")
