#!/usr/bin/python3
"""What safety costs, and what a long run does.

    price.py PROGRAM [--steps 1000000]

The watch: its share of the time of the steps in several scenes, from the program's own timers (run.json). A checkpoint: runs that write one
every so often and none, in turn; the difference by checkpoint, as a share of a minute. The lock: the same with the wall time of short runs is
below what can be measured, so its system calls are counted. A million steps of a small closed scene: energy, momentum and memory (the
largest resident set after a tenth of the steps and at the end). Prints Markdown; exits with 1 when a bound is missed.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run as runs  # noqa: E402
from barchan_bench.frame import table  # noqa: E402
from barchan_bench.table import head  # noqa: E402

SPEED = .7  # m/s, of the order of the mean speed at the start of both
SPHERES = """dimensions = 2
spacing = 1e-3
[domain]
size = [0.01, 0.01]
periodic = ["x", "y"]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 1e-3, spread = 0.2 }
restitution = 1
[interactions]
sand-sand = { law = "linear" }
[[fill]]
phase = "sand"
shape = { box = { min = [0.0, 0.0], max = [0.01, 0.0035] } }
velocity = ["0.7*sin(700*x)", "0.7*cos(900*y)"]
[time]
end = 1
largest-speed = 2
"""

rows = []


def run(program, scene, sets, out):
    """Wall and user seconds, and the largest resident set (kB), of one run."""
    done = runs.scene(program, ROOT / "scenes" / scene, out, sets, check=False)
    if done.status:
        raise SystemExit(f"{scene}: status {done.status}: {done.stderr}")
    return done.wall, done.user, done.memory


def report(what, bound, value, good):
    rows.append(good)
    print(f"| {what} | {bound} | {value}{'' if good else ' **MISSED**'} |", flush=True)


def watch(program, scratch):
    for scene, sets in (("verification/taylor_green.toml", ["spacing=0.005", "time.end=0.1"]),
                        ("paper/impact_cubes.toml", ["time.end=1e-4", "output.every=1e-3"]),
                        ("verification/dam_break.toml", ["time.end=0.5"]), ("column_collapse.toml", ["fill.1.packing=staggered", "time.end=0.1"])):
        out = scratch / "watch"
        run(program, scene, sets, out)
        seconds = json.loads((out / "run.json").read_text())["seconds"]
        share = seconds["watch"] / sum(seconds.values())
        report(f"watch, {scene} with {' '.join(sets)}", "1 % of the steps", f"{100 * share:.2f} %", share < .01)


def checkpoint(program, scratch):
    sets = ["spacing=0.0025", "time.end=0.02", "output.every=1"]  # 160,000 particles
    every, written = 2, []
    times = {0: [], every: []}
    for _ in range(3):
        for seconds in times:
            out = scratch / "checkpoint"
            times[seconds].append(run(program, "verification/taylor_green.toml", sets + [f"output.checkpoint-every={seconds}"], out)[:2])
            if seconds:
                written.append(times[seconds][-1][0] // seconds)
    wall, user = ((statistics.median(t[k] for t in times[every]) - statistics.median(t[k] for t in times[0])) / max(statistics.median(written), 1)
                  for k in (0, 1))
    where = f"160,000 particles, medians of 3 pairs, {statistics.median(written):.0f} checkpoints a run"
    report(f"a checkpoint every minute, user CPU time ({where})", "1 %", f"{max(user, 0):.2f} s each: {100 * max(user, 0) / 60:.2f} %", user / 60 < .01)
    report(f"a checkpoint every minute, wall time ({where})", "2 %", f"{max(wall, 0):.2f} s each: {100 * max(wall, 0) / 60:.2f} %", wall / 60 < .02)


def long_run(program, scratch, steps):
    spheres = scratch / "spheres.toml"
    spheres.write_text(SPHERES)
    for name, scene, sets, step in (
            ("Taylor-Green vortices, 400 particles, no viscosity", "verification/taylor_green.toml", ["spacing=0.05", "phases.fluid.viscosity=0"], 1e-3),
            ("30 spheres in a periodic box, restitution 1, no friction", spheres, [], 6e-7)):
        peak = []
        for part in (steps // 10, steps):
            out = scratch / "long"
            peak.append(run(program, scene, sets + [f"time.step={step}", f"time.end={part * step}", f"output.every={part * step}"], out)[2])
        history = table(out / "history.csv")
        kinetic = sum(v for k, v in history.items() if "_kinetic_energy [" in k)
        energy = kinetic + sum(v for k, v in history.items() if k.startswith("contacts_stored_energy ["))
        drift = max(numpy.ptp(history[f"momentum_{axis}"]) for axis in "xy")
        done = json.loads((out / "run.json").read_text())["steps"]
        report(f"{name}, {done:,} steps: energy at the end and at most, of that at the start", "no growth: 1.01",
               f"{energy[-1] / energy[0]:.4g}, {energy.max() / energy[0]:.5g}", energy.max() <= 1.01 * energy[0])
        report("its momentum: largest change, of the mass times the first mean speed", "none", f"{drift / (energy[0] * 2 / SPEED):.1e}", True)
        report("its memory after a tenth of the steps and at the end", "flat: 2 %", f"{peak[0] / 1024:.1f} and {peak[1] / 1024:.1f} MB", peak[1] < 1.02 * peak[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--steps", type=int, default=1_000_000)
    options = parser.parse_args()
    program = str(options.program.resolve())
    print(head("figure", "bound", "measured"))
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        watch(program, scratch)
        checkpoint(program, scratch)
        long_run(program, scratch, options.steps)
    return 0 if all(rows) else 1


if __name__ == "__main__":
    sys.exit(main())
