#!/usr/bin/env python3
"""Walls of one to five rows between water and free space, and between two waters; the dam gate at twenty spacings.

    bench/robustness/thin_walls.py build/barchan [--spacing 0.02] [--which vessel,plate,gate] [--scheme consistent,plain]

vessel: still water in a vessel of boxes with nothing behind its walls; force on it over the weight of the water.
plate: a plate between two depths of still water; force on it over rho g (h1^2 - h2^2)/2.
gate: scenes/dam_gate.toml; impulse on the gate until the water has left it, over the median of all spacings.
Each is within 5 % of its value, or the program refuses the wall. `told`: it warned of the wall.
"""

import argparse
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import run as runs, table  # noqa: E402

BOUND = 0.05
HEAD = """dimensions = 2
spacing = {dx}
[domain]
size = [1.2, 0.8]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
scheme = "{scheme}"
sound-speed = 30
artificial-viscosity = 0.1
enclosed = false
[phases.wall]
kind = "wall"
slip = "free-slip"
[interactions]
water-water = {radius}
water-wall = {radius}
[time]
end = 1.0
largest-speed = 1
[output]
every = 1.0
history-every = 2e-3
[[force]]
name = "wall"
phase = "wall"
"""
FILL = '[[fill]]\nphase = "{}"\nshape = {{ box = {{ min = [{}, {}], max = [{}, {}] }} }}\n{}\n'
SIDES = '[phases.tank]\nkind = "wall"\nslip = "free-slip"\n[[fill]]\nphase = "tank"\nshape = { sides = ["bottom", "left", "right"] }\n'


def water(dx, x, y, columns, rows):
    return FILL.format("water", x, y, x + columns * dx, y + rows * dx, 'pressure = "hydrostatic"')


def vessel(dx, rows, scheme):
    t, x, y, columns, depth = rows * dx, 10 * dx, 8 * dx, 30, 12
    width = columns * dx
    text = HEAD.format(dx=dx, radius=2.6 if scheme == "consistent" else 2.1, scheme=scheme)
    text += FILL.format("wall", x - t, y - t, x + width + t, y, "")
    text += FILL.format("wall", x - t, y, x, y + 20 * dx, "") + FILL.format("wall", x + width, y, x + width + t, y + 20 * dx, "")
    return text + water(dx, x, y, columns, depth), 1, -1000 * 9.81 * width * depth * dx


def plate(dx, rows, scheme):
    t, left, deep, shallow = rows * dx, 25, 20, 12
    x = left * dx
    text = HEAD.format(dx=dx, radius=2.6 if scheme == "consistent" else 2.1, scheme=scheme).replace("[1.2, 0.8]", f"[{(2 * left + rows) * dx!r}, 0.8]")
    text = text.replace("[time]", f"water-tank = {2.6 if scheme == 'consistent' else 2.1}\n[time]") + SIDES
    text += FILL.format("wall", x, 0, x + t, 30 * dx, "")
    text += water(dx, 0, 0, left, deep) + water(dx, x + t, 0, left, shallow)
    return text, 0, 1000 * 9.81 * ((deep * dx) ** 2 - (shallow * dx) ** 2) / 2


def attempted(program, text, out, sets=()):
    """A run, what the program said of a thin wall, or nothing."""
    ended = runs.scene(program, text, out, sets, check=False, timeout=500)
    word = "refused" if ended.status == 2 else f"status {ended.status}" if ended.status else "told" if "rows of" in ended.stderr else ""
    if ended.status == 2 and "rows of" not in ended.stderr:
        raise runs.Broken(ended.stderr, ended)
    return ended, word


def at_rest(program, name, make, dx, scheme, scratch):
    for rows in (1, 2, 3, 4, 5):
        text, axis, ideal = make(dx, rows, scheme)
        ended, word = attempted(program, text, scratch / f"{name}-{scheme}-{rows}")
        what = f"{rows} rows: force over that of water at rest, off by"
        if word == "refused" or word.startswith("status"):
            table.report(name, scheme, round(1 / dx), f"{rows} rows: {word}", float(word != "refused"), 0.0, 0.0)
            continue
        history = ended.history()
        force, time = history[f"wall_force_{'xy'[axis]}"], history["time"]
        mean = statistics.fmean(f for f, t in zip(force, time) if t > 0.5)
        table.report(name, scheme, round(1 / dx), f"{what}{' (told)' if word else ''}", abs(mean / ideal - 1), BOUND, ended.seconds)


def gate(program, scratch, spacings):
    found = {}
    for dx in spacings:
        ended, word = attempted(program, "dam_gate", scratch / f"gate{dx:.5f}", [f"spacing={dx!r}"])
        if word == "refused":
            table.report("gate", "consistent", round(0.3 / dx), "refused", 0.0, 0.0, 0.0)
            continue
        history = ended.history()
        time, force = history["time"], history["gate_force_x"]
        found[dx] = (sum((b - a) * (f + g) / 2 for a, b, f, g in zip(time, time[1:], force, force[1:])), word, ended.seconds)
    middle = statistics.median(impulse for impulse, _, _ in found.values())
    for dx, (impulse, word, seconds) in found.items():
        table.report("gate", "consistent", round(0.3 / dx), f"impulse {impulse:.2f} N s/m, {0.0375 / dx:.2f} rows{' (told)' if word else ''}; off the median",
                     abs(impulse / middle - 1), BOUND, seconds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--which", default="vessel,plate,gate")
    parser.add_argument("--scheme", default="consistent,plain")
    parser.add_argument("--spacing", type=float, default=0.02, help="m, of the vessel and the plate")
    parser.add_argument("--rows", default=",".join(map(str, range(20, 40))), help="of the gate's water, 0.3 m deep")
    given = parser.parse_args()
    which, program = given.which.split(","), given.program.resolve()
    print(table.HEAD, flush=True)
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        for name, make in (("vessel", vessel), ("plate", plate)):
            for scheme in given.scheme.split(",") if name in which else ():
                at_rest(program, name, make, given.spacing, scheme, folder)
        if "gate" in which:
            gate(program, folder, [0.3 / int(rows) for rows in given.rows.split(",")])
    return 0 if all(row["good"] for row in table.rows) else 1


if __name__ == "__main__":
    sys.exit(main())
