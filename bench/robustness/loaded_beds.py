#!/usr/bin/python3
"""Loaded stacks of spheres at rest, by the restitution of their contacts: overlap and stored energy of the law, no energy lost.

    /usr/bin/python3 bench/robustness/loaded_beds.py build/barchan

Six stacks of ten grains of 1 mm, each under a grain twenty times as heavy, begin with the overlaps that their loads ask for (linear springs, Hertz). For 0.2 s
nothing may move: the overlap stays that of F/K, or of Hertz's law, within 1e-4, the stored energy that of the law within 1e-3, and the energy that contacts lost is
flat to 1e-9 of what is stored a second. Restitution 0.05 to 0.99. Exit status 1 when a figure misses its bound. Some seconds.
"""

import argparse
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import frame, run, table  # noqa: E402

D, RHO, G, STACKS, HIGH, LOAD, K, YOUNG, POISSON, END = 1e-3, 2650, 9.81, 6, 10, 20, 500., 1e7, .25, .2
MASS = RHO * math.pi / 6 * D**3
RESTITUTIONS = (.05, .1, .2, .3, .5, .7, .9, .95, .99)
# N: on the floor, and on each grain from the lowest on. A floor is as hard as the grains, and plane.
FORCES = [(HIGH - i + LOAD) * MASS * G for i in range(HIGH + 1)]
SCENE = """spacing = 1e-3
[domain]
size = [0.008, 0.02]
gravity = [0, -{g}]
{phases}
[phases.floor]
kind = "wall"
[interactions]
sand-sand = {{ law = "{law}" }}
load-sand = {{ law = "{law}" }}
sand-floor = {{ law = "{law}" }}
load-load = false
load-floor = false
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"] }}
[[fill]]
phase = "sand"
shape = {{ points = {sand} }}
[[fill]]
phase = "load"
shape = {{ points = {load} }}
[time]
end = {end}
largest-speed = 0.2
[output]
every = 0.02
history-every = 4e-3
"""


def overlap(law, force, floor):
    """m."""
    if law == "linear":
        return force / K
    return (force / (4 / 3 * YOUNG / (2 * (1 - POISSON**2)) * math.sqrt(D / (2 if floor else 4)))) ** (2 / 3)


def scene(law, restitution):
    heights = [.5 * D - overlap(law, FORCES[0], True)]
    for force in FORCES[1:]:
        heights.append(heights[-1] + D - overlap(law, force, False))
    spring = f"stiffness = {K}" if law == "linear" else f"young = {YOUNG}\npoisson = {POISSON}"
    phases = "\n".join(f'[phases.{name}]\nkind = "grains"\ndensity = {rho}\ndiameter = {D}\nrestitution = {restitution}\n{spring}' for name, rho in
                       (("sand", RHO), ("load", LOAD * RHO)))
    places = [(i + .5) * 1.2 * D for i in range(STACKS)]
    return SCENE.format(g=G, law=law, end=END, phases=phases, sand=[[x, y] for x in places for y in heights[:-1]], load=[[x, heights[-1]] for x in places])


def measure(program, law, restitution):
    with tempfile.TemporaryDirectory() as out:
        done = run.scene(program, scene(law, restitution), out)
        time, file = done.series()[-1]
        sand, load = (frame.Frame(file, time, phase).x for phase in ("sand", "load"))
        history = done.history()
    worst = 0.
    for x in sorted(set(load[:, 0].round(5))):
        heights = sorted([y for q, y, _ in sand if abs(q - x) < .1 * D] + [y for q, y, _ in load if abs(q - x) < .1 * D])
        for below, above, force in zip(heights, heights[1:], FORCES[1:]):
            worst = max(worst, abs((D - above + below) / overlap(law, force, False) - 1))
    stored = history["contacts_stored_energy"][-1] * D   # J, in 2D of a slab as thick as a grain
    share = .5 if law == "linear" else .4
    expected = STACKS * sum(share * force * overlap(law, force, i == 0) for i, force in enumerate(FORCES))
    lost = history["contacts_lost_energy"]
    half = len(lost) // 2
    rate = abs(lost[-1] - lost[half]) / (history["time [s]"][-1] - history["time [s]"][half]) * D / stored
    name = f"loaded stacks, {law}"
    table.report(name, f"restitution {restitution:g}", HIGH, "overlap over the law's, error", worst, 1e-4, done.seconds)
    table.report(name, f"restitution {restitution:g}", HIGH, "stored energy over the law's, error", abs(stored / expected - 1), 1e-3, done.seconds)
    table.report(name, f"restitution {restitution:g}", HIGH, "energy lost a second over that stored", rate, 1e-9, done.seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    program = parser.parse_args().program.resolve()
    print(table.HEAD)
    for law in ("linear", "hertz"):
        for restitution in RESTITUTIONS:
            measure(program, law, restitution)
    return 0 if all(row["good"] for row in table.rows) else 1


if __name__ == "__main__":
    sys.exit(main())
