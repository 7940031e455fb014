#!/usr/bin/python3
"""Whole matrices of cases that once broke, gained energy or went astray, with the defaults of the shipped scenes.

    matrix.py PROGRAM [cavity | block | rings | balls ...] [--sides 20,33,50,100] [--jobs N] [--write]

cavity  lid-driven cavity, Re 100, 400, 1000, 3200, the default radius, 20 to 100 particles a side, four seeds: which end.
block   bouncing_block.toml, Young 5e4 to 1e7 Pa, 1 to 8 m/s, three spacings: energy at the end and at most, over that of the start.
rings   rings.toml at 1, 2 and 4 times its speed: the same.
balls   a frictionless disc and ball, elastic and rigid, on a plate (a box) and on a side at 20 places: speed along the plate over that of the fall.

Prints a line a run and Markdown tables; --write puts them into bench/robustness/results/CASE.json. A run that ends with status 3 is named with its
message. Exits with 1 when a run breaks down without a word, or gains more than 1 % of its energy and ends with status 0.
"""

import argparse
import concurrent.futures
import itertools
import json
import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run  # noqa: E402

RESULTS = pathlib.Path(__file__).resolve().parent / "results"


def go(program, scene, sets, work, text=None):
    """Status, message and the rows of history.csv (a list of dictionaries of numbers) of one run."""
    path = ROOT / "scenes" / scene
    with tempfile.TemporaryDirectory(dir=work) as folder:
        if text is not None:
            path = pathlib.Path(folder) / scene
            path.write_text(text)
        done = run.scene(program, path, folder + "/out", sets, check=False)
        rows = done.history().rows() if (done.out / "history.csv").exists() else []
        warned = " ".join(w if isinstance(w, str) else json.dumps(w) for w in (done.report or {}).get("warnings", []))
        return done.status, done.stderr.strip(), rows, warned


def cavity(options, work, pool):
    sides = [int(n) for n in options.sides.split(",")]
    cases = list(itertools.product(sides, (100, 400, 1000, 3200), (1, 2, 3, 4)))

    def one(case):
        n, reynolds, seed = case
        sets = [f"spacing={1 / n!r}", f"phases.fluid.viscosity={1 / reynolds!r}", "interactions.fluid-fluid=2.1", f"fill.2.seed={seed}", "time.end=30"]
        status, words, rows, _ = go(options.program, "verification/cavity.toml", sets, work)
        return {"a side": n, "Re": reynolds, "seed": seed, "status": status, "until": rows[-1]["time"] if rows else 0, "words": words[:300] if status else ""}
    return list(pool.map(one, cases)), lambda r: r["status"] != 0


def energies(rows, scene):
    """Energy by row: motion, strain, hourglass, weight, and what the springs of contacts hold."""
    def sum_of(row, *ends):
        return sum(v for k, v in row.items() if k.endswith(ends))
    total = [sum_of(r, "_kinetic_energy", "_strain_energy", "_hourglass_energy", "_taken_energy") for r in rows]
    if scene == "block":
        mass = 1000 * .1 * .1
        total = [e + mass * 9.81 * (r["middle_y"] - .05) for e, r in zip(total, rows)]
    return total


def of_energy(name, scene, cases, sets_of, options, work, pool):
    def one(case):
        status, words, rows, warned = go(options.program, scene, sets_of(case), work)
        e, last = energies(rows, name), len(rows) - 1
        if name == "block" and rows:  # in flight, at the top of its last bounce: what the springs of the floor hold has no column
            low = min(range(len(rows)), key=lambda k: rows[k]["middle_y"])
            last = max(range(low, len(rows)), key=lambda k: rows[k]["middle_y"])
        return dict(case, status=status, end=e[last] / e[0] if e else math.nan, most=max(e) / e[0] if e else math.nan,
                    words=(words if status else "told: " + warned if "energy" in warned else "")[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] == 0 and not r["words"] and not (r["most"] < 1.01 and r["end"] > .99)


def block(options, work, pool):
    cases = [{"young": y, "speed": v, "spacing": h} for y in (5e4, 1e5, 2e5, 1e6, 1e7) for v in (1, 2, 4, 6, 8) for h in (2.5e-3, 5e-3, 1e-2)]

    def sets(c):
        end = .2 / c["speed"] + .25
        return [f"phases.block.young={c['young']!r}", f"spacing={c['spacing']!r}", f"fill.1.velocity=[0, {-c['speed']}]", "domain.size=[0.4, 4]",
                f"time.end={end!r}", f"time.largest-speed={c['speed'] + 2}"]
    return of_energy("block", "bouncing_block.toml", cases, sets, options, work, pool)


def rings(options, work, pool):
    cases = [{"times": t, "spacing": h} for t in (1, 2, 4) for h in (1e-3, 1.25e-3, 2e-3)]

    def sets(c):
        v = 6.95 * c["times"]
        return [f"fill.0.velocity=[{v!r}, 0]", f"fill.1.velocity=[{-v!r}, 0]", f"spacing={c['spacing']!r}", f"time.largest-speed={2.1 * v!r}",
                f"time.end={.016 / c['times'] + .004!r}"]
    return of_energy("rings", "rings.toml", cases, sets, options, work, pool)


BALL = """dimensions = {dimensions}
spacing = {spacing}
precision = "double"
[domain]
size = {size}
gravity = {gravity}
[phases.ball]
kind = "{kind}"
density = 1000
{elastic}
[phases.plate]
kind = "wall"
[interactions]
{own}
ball-plate = {{ restitution = 1 }}
[[fill]]
phase = "plate"
shape = {plate}
[[fill]]
phase = "ball"
shape = {ball}
packing = "{packing}"
velocity = {velocity}
[time]
end = 0.02
largest-speed = 3
[output]
every = 0.02
history-every = 1e-4
"""


def balls(options, work, pool):
    """2.1 m/s, radius 20 mm, spacing 2 mm (3D: 4 mm), gap 4 mm. The plate is a box, or the lower side."""
    cases = [{"dimensions": d, "kind": kind, "plate": plate, "place": round(.1 + .02 * k / 20 * (1 + .05 * (k % 3)), 6)}
             for d in (2, 3) for kind in ("elastic", "rigid") for plate in ("box", "sides") for k in range(20)]

    def one(c):
        three = c["dimensions"] == 3
        vector = lambda *x: str(list(x if three else x[:2]))
        floor = .02 if c["plate"] == "box" else 0.
        spacing = .004 if three else .002
        text = BALL.format(
            dimensions=c["dimensions"], spacing=spacing, size=vector(.24, .16, .24), gravity=vector(0, 0, 0), kind=c["kind"], velocity=vector(0, -2.1, 0),
            elastic="young = 5e6\npoisson = 0.3" if c["kind"] == "elastic" else "", own="ball-ball = 1.6" if c["kind"] == "elastic" else "",
            plate="{ sides = [\"bottom\"] }" if c["plate"] == "sides" else "{ box = { min = %s, max = %s } }" % (vector(0, 0, 0), vector(.24, .02, .24)),
            ball="{ %s = { centre = %s, radius = 0.02 } }" % ("sphere" if three else "disc", vector(c["place"], floor + .024, c["place"] + .001)),
            packing="rows")
        status, words, rows, warned = go(options.program, "ball.toml", [], work, text)
        row = rows[-1] if rows else {}
        vx, vy = row.get("ball_mean_vx", math.nan), row.get("momentum_y", math.nan)
        start = abs(rows[0]["momentum_y"]) if rows else math.nan
        sideways = max(abs(vx), abs(row.get("momentum_x", math.nan)) / start * 2.1, abs(row.get("momentum_z", 0.)) / start * 2.1) / 2.1
        return dict(c, status=status, sideways=sideways, rebound=vy / start, words=(words if status else warned)[:300])
    return list(pool.map(one, cases)), lambda r: r["status"] != 0 or not r["sideways"] < .01


CASES = {"cavity": cavity, "block": block, "rings": rings, "balls": balls}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", nargs="*", choices=[*CASES, []], default=list(CASES))
    parser.add_argument("--sides", default="20,33,50,100")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    options.program = str(pathlib.Path(options.program).resolve())
    failed = False
    with tempfile.TemporaryDirectory() as work, concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for name in options.cases:
            rows, wrong = CASES[name](options, work, pool)
            keys = list(rows[0])
            print("| " + " | ".join(keys) + " |\n|" + " --- |" * len(keys))
            for row in rows:
                print("| " + " | ".join(f"{v:.5g}" if isinstance(v, float) else str(v) for v in row.values()) + (" WRONG |" if wrong(row) else " |"))
            bad = sum(map(wrong, rows))
            print(f"\n{name}: {len(rows)} runs, {bad} wrong\n", flush=True)
            failed |= bad > 0
            if options.write:
                RESULTS.mkdir(exist_ok=True)
                (RESULTS / f"{name}.json").write_text(json.dumps({"runs": rows, "wrong": bad}, indent=1) + "\n")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
