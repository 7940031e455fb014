#!/usr/bin/python3
"""The cases of docs/accuracy.md, and more enclosed flows, with another program and with this one in turn: errors and user CPU times.

    /usr/bin/python3 bench/accuracy/against.py OTHER [--this build/barchan] [--cases NAME,...] [--largest N] [--rounds N]
                     [--write COMMIT] [--set KEY=VALUE ...]

OTHER is a program that is built already, of another commit. Every run is made with both, other, this, other, this, ..., on one thread: at least
once each, and up to --rounds times until it has taken six seconds. Printed are each figure then and now, their ratio, and the median of the ratios
of the user CPU times of neighbouring runs (with the least and the largest). Ratios of times of neighbouring runs can be trusted on a busy machine,
times cannot. With --write COMMIT the figures go to bench/accuracy/results/against-COMMIT.csv.

Both programs read the same file: the scene with the defaults written out that have changed since 142972c (`scheme`, `kernel`, `layers`). One key
differs: `enclosed`, which the program of today finds from the particles. An older one gets `enclosed = true` where its own scenes had it (ENCLOSED).
"""

import argparse
import json
import math
import os
import pathlib
import shutil
import statistics
import sys
import tempfile
import tomllib

import cases_periodic
import cases_surface
import cases_walls
import harness
import numpy
from barchan_bench import store
from harness import options, rows, runs
from page import processor

ENCLOSED = ("backward_step", "cavity", "logarithmic_layer", "low_hill", "rushil", "still_column", "vortex_box")  # of the scenes of 142972c, and one new


# ---- enclosed flows that no bound was chosen for -----------------------------------------------------------------------

FLOW = """dimensions = 2
precision = "{precision}"
spacing = {spacing!r}
[domain]
size = [{width!r}, {height!r}]
periodic = ["x", "y"]
[phases.fluid]
kind = "fluid"
density = 1
viscosity = {viscosity!r}
sound-speed = {sound!r}
scheme = "{scheme}"
[interactions]
kernel = "wendland-c2"
fluid-fluid = {radius!r}
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = {perturb!r}
seed = {seed}
velocity = {velocity}
pressure = "{pressure}"
[time]
end = {end!r}
largest-speed = 1
[output]
every = {end!r}
history-every = {row!r}
"""


class Gresho:
    """Gresho's vortex with its middle anywhere in the unit square (nearer to a side than 0.4 m it goes through it)."""
    name, end = "Gresho's vortex", 0.5

    def __init__(self, x=.5, y=.5):
        self.middle = x, y
        self.where = "" if self.middle == (.5, .5) else f", middle at {x:g}, {y:g}"
        dx, dy = (f"({a}-{b!r}-rint({a}-{b!r}))" for a, b in (("x", x), ("y", y)))
        r = f"sqrt({dx}^2+{dy}^2)"
        turn = f"({r} < 0.2 ? 5 : ({r} < 0.4 ? 2/{r} - 5 : 0))"
        pressure = (f"12.5*{r}^2*({r} < 0.4 ? 1 : 0) + ({r} < 0.2 ? 2 - 4*ln(2) : "
                    f"({r} < 0.4 ? 6 - 4*ln(2) - 20*{r} + 4*ln(5*{r}) : 0))")
        self.scene = dict(width=1., height=1., viscosity=0., velocity=json.dumps([f"-{dy}*{turn}", f"{dx}*{turn}"]), pressure=pressure)

    def exact(self, x, _time):
        d = x[:, :2] - self.middle
        d -= numpy.round(d)
        r = numpy.maximum(numpy.hypot(d[:, 0], d[:, 1]), 1e-12)
        turn = numpy.where(r < .2, 5, numpy.where(r < .4, 2 / r - 5, 0))
        return numpy.column_stack([-d[:, 1] * turn, d[:, 0] * turn])


class Vortices:
    """Taylor-Green vortices in a box of width by 1 m, `periods` of them along x, one along y: u = -s cos ax sin by,
    v = s (a/b) sin ax cos by, with s = min(1, b/a), so that no speed exceeds 1 m/s."""
    end = 0.5

    def __init__(self, re, periods=1, width=1.):
        self.viscosity, self.a, self.b = 1 / re, 2 * math.pi * periods / width, 2 * math.pi
        self.name, self.where = f"Taylor-Green, Re {re:g}", "" if (periods, width) == (1, 1.) else f", {periods} periods in {width:g} m"
        a, b = self.a, self.b
        self.strength = min(1., b / a), min(1., a / b)
        s, t = self.strength
        self.scene = dict(width=width, height=1., viscosity=self.viscosity,
                          velocity=json.dumps([f"-{s!r}*cos({a!r}*x)*sin({b!r}*y)", f"{t!r}*sin({a!r}*x)*cos({b!r}*y)"]),
                          pressure=f"-0.25*({s * s!r}*cos({2 * a!r}*x) + {t * t!r}*cos({2 * b!r}*y))")

    def exact(self, x, time):
        a, b = self.a * x[:, 0], self.b * x[:, 1]
        decay = math.exp(-(self.a**2 + self.b**2) * self.viscosity * time)
        return decay * numpy.column_stack([-self.strength[0] * numpy.cos(a) * numpy.sin(b), self.strength[1] * numpy.sin(a) * numpy.cos(b)])


# flow, scheme, radius, precision, perturbation
VARIANTS = [
    (Gresho(), "consistent", 2.1, "mixed", .2),
    (Gresho(.31, .62), "consistent", 2.1, "double", .2),
    (Gresho(), "consistent", 2.6, "double", .2),
    (Gresho(), "consistent", 3.0, "mixed", .1),
    (Gresho(), "consistent", 2.1, "double", .3),
    (Gresho(), "plain", 3.0, "double", .2),
    (Vortices(10000), "consistent", 2.1, "mixed", .1),
    (Vortices(10000), "consistent", 2.6, "double", .3),
    (Vortices(10000), "consistent", 3.0, "double", .2),
    (Vortices(10000, 2), "consistent", 2.1, "double", .2),
    (Vortices(3000, 3, 2.), "consistent", 2.6, "mixed", .2),
    (Vortices(1000), "plain", 2.6, "double", .2),
    (Vortices(100), "plain", 3.0, "mixed", .1),
    (Vortices(100, 1, 1.6), "consistent", 2.1, "double", .3),
]


def variant(n, flow, scheme, radius, precision, perturb):
    """L1 of the vector at the end, mean of the seeds 11, 12, 13 (two at 100 spacings, one at 200)."""
    errors, total = [], 0
    for seed in {100: (11, 12), 200: (11,)}.get(n, (11, 12, 13)):
        text = FLOW.format(**flow.scene, precision=precision, spacing=1 / n, sound=10. * max(n, 50) / 50, scheme=scheme, radius=radius, perturb=perturb,
                           seed=seed, end=flow.end, row=flow.end / 100)
        (*_, f), seconds = harness.run(text, [], "fluid")
        truth, total = flow.exact(f.x, f.time), total + seconds
        errors.append(numpy.linalg.norm(f["velocity"][:, :2] - truth, axis=1).sum() / numpy.linalg.norm(truth, axis=1).sum())
    harness.report(flow.name + flow.where, f"{scheme}, {radius} dx, {precision}, disturbed by {perturb} dx", n, "L1 of the vector at the end",
                   numpy.mean(errors), None, total)


# ---- the same figures from two programs --------------------------------------------------------------------------------

def sized(case, *sizes):
    """One part of a case a resolution."""
    return lambda: [(lambda n=n: case(n)) for n in sizes if n <= options.largest]


def each(case, *arguments):
    """One part of a case an argument."""
    return lambda: [(lambda a=a: case(*a) if isinstance(a, tuple) else case(a)) for a in arguments]


# name: its parts, each a function that reports figures; a part is what runs in turn before anything is printed
CASES = {
    "variants": lambda: [(lambda v=v, n=n: variant(n, *v)) for n in (25, 50, 100, 200) if n <= options.largest for v in VARIANTS],
    "whole-fluids": lambda: [cases_periodic.whole_fluids],
    "taylor-green": lambda: [lambda: cases_periodic.taylor_green((25, 50, 100, 200))],
    "cost": lambda: [cases_periodic.cost],
    "taylor-green-1000": sized(cases_periodic.taylor_green_1000, 25, 50, 100),
    "abc": sized(cases_periodic.abc, 16, 24, 32),
    "waves": sized(cases_periodic.waves, 20, 40, 80),
    "poiseuille": sized(cases_walls.poiseuille, 25, 50, 100),
    "couette": sized(cases_walls.couette, 25, 50, 100),
    "cavity": sized(cases_walls.cavity, 25, 50, 100),
    "logarithmic-layer": each(cases_walls.logarithmic_layer, (.2, 20), (.4, 20), (.8, 20), (.4, 40)),
    "backward-step": each(cases_walls.backward_step, 100, 200),
    "low-hill": sized(cases_walls.low_hill, 5, 10, 20),
    "two-phase-column": each(cases_walls.two_phase_column, (1000, 0), (1000, .2), (2000, 0), (2000, .2)),
    "standing-wave": sized(cases_surface.standing_wave, 25, 50),
    "square-patch": sized(cases_surface.square_patch, 25, 50, 100),
    "dam-break": sized(cases_surface.dam_break, 20, 40, 80),
    "still-tank": sized(cases_surface.still_tank, 25, 50),
}
NO_ERROR = ("order", "Re of the flow", "x_r/S", "measured places", "omega t", "error at equal time")  # figures that no ratio says anything of


def explicit(scene, enclosed):
    """A scene (a file's name or its text) with the defaults of today written out, as text."""
    keys = tomllib.loads(scene) if "\n" in scene else harness.document(scene)
    for phase in keys["phases"].values():
        if phase["kind"] == "fluid":
            phase.setdefault("scheme", "consistent")
            if enclosed and scene in ENCLOSED:
                phase.setdefault("enclosed", True)
    keys["interactions"].setdefault("kernel", "wendland-c2")
    for fill in keys["fill"]:
        if isinstance(fill["shape"], dict) and "sides" in fill["shape"]:
            fill["shape"].setdefault("layers", 3)
    return harness.toml(keys)


class Turns:
    """Takes the place of harness.run_into: makes every run with both programs by turns, once for two evaluations of a case."""

    def __init__(self, other, this, rounds, folder):
        self.programs, self.rounds, self.folder = {"other": other, "this": this}, rounds, folder
        self.side, self.made, self.log = "other", {}, []

    def once(self, side, scene, overrides, out):
        out.mkdir(parents=True)
        file = out / ("case.toml" if "\n" in scene else pathlib.Path(scene).name + ".toml")
        file.write_text(explicit(scene, side == "other"))
        done = runs.scene(self.programs[side], file, out, overrides, check=False)
        if done.status != 0:
            (out / "failed").write_text(f"{file.name} ended with status {done.status}: {done.stderr.strip()[:300]}")
        return file.stem, done.user

    def make(self, scene, overrides):
        key = json.dumps([scene, overrides])
        if key in self.made:
            return self.made[key]
        home, times = self.folder / f"{len(self.made)}", {"other": [], "this": []}
        failed = []
        while not times["this"] or (len(times["this"]) < self.rounds and sum(times["this"]) < 6 and not failed):
            for side in times:
                out = home / side if not times[side] else home / "again"
                stem, seconds = self.once(side, scene, overrides, out)
                times[side].append(seconds)
                shutil.rmtree(home / "again", ignore_errors=True)
            failed = [side for side in times if (home / side / "failed").exists()]
        self.made[key] = stem, home, times
        return self.made[key]

    def __call__(self, out, scene, overrides):
        stem, home, times = self.make(scene, list(overrides))
        self.log.append((len(rows), times))
        failed = home / self.side / "failed"
        if failed.exists():
            raise harness.Broken(failed.read_text())
        os.symlink(home / self.side, out)
        summary = json.loads((out / "run.json").read_text())
        seconds = harness.Seconds(statistics.median(times[self.side]))
        seconds.work = float(summary["steps"]) * (sum(summary["particles"].values()) if isinstance(summary["particles"], dict) else summary["particles"])
        return stem, seconds


def evaluate(case, turns, side):
    """The rows of a case with the runs of one program, each with the times of the runs behind it."""
    rows.clear()
    turns.side, turns.log = side, []
    silent, sys.stdout = sys.stdout, open(os.devnull, "w")
    try:
        case()
    except harness.Broken as broken:
        harness.tell("", "", "", "runs to the end", str(broken).replace("|", "/")[:160], "", 0)
    finally:
        sys.stdout = silent
    runs, known = [], []
    for k, row in enumerate(rows):
        now = [times for at, times in turns.log if at == k]  # runs made since the row before
        known = now or known
        runs.append(known)
    return [(dict(row), times) for row, times in zip(rows, runs)]


def cpu(times):
    """Median, least and largest ratio this/other of neighbouring runs, and the seconds of other and this: of all the runs of a figure."""
    rounds = min(len(t["this"]) for t in times) if times else 0
    if not rounds:
        return None
    total = {side: [sum(t[side][k] for t in times) for k in range(rounds)] for side in ("other", "this")}
    ratios = sorted(b / a for a, b in zip(total["other"], total["this"]))
    return statistics.median(ratios), ratios[0], ratios[-1], statistics.median(total["other"]), statistics.median(total["this"])


def compare(name, part, turns):
    """The figures of a part of a case, one dictionary each."""
    turns.made = {}
    then, now = evaluate(part, turns, "other"), evaluate(part, turns, "this")
    figures = []
    for (row, times) in now:
        same = [r for r, _ in then if (r["case"], r["scheme"], r["n"]) == (row["case"], row["scheme"], row["n"])]
        mine = [r for r, _ in now if (r["case"], r["scheme"], r["n"]) == (row["case"], row["scheme"], row["n"])]
        place = [r is row for r in mine].index(True)
        if isinstance(row["value"], str) and row["what"] != "runs to the end" or row["what"].startswith(NO_ERROR):
            continue
        old = same[place] if place < len(same) and len(same) == len(mine) else {"value": next((r["value"] for r in same if isinstance(r["value"], str)), "none")}
        figures.append({"name": name, "case": row["case"], "scheme": row["scheme"], "n": row["n"], "what": row["what"], "then": old["value"],
                        "now": row["value"], "bound": row["bound"], "at_least": row.get("at_least", False), "cpu": cpu(times)})
    shutil.rmtree(turns.folder, ignore_errors=True)
    return figures


# ---- the table ---------------------------------------------------------------------------------------------------------

HEAD = "| case | scheme | N | figure | then | now | now/then | user CPU now/then | least, largest | s now |\n" + "| --- " * 10 + "|"


def ratio(figure):
    """Now over then (then over now of a figure that should be large); None when one of them has no number."""
    then, now = figure["then"], figure["now"]
    if isinstance(then, str) or isinstance(now, str):
        return None
    if figure["at_least"]:
        then, now = now, then
    return now / then if then else (1. if not now else math.inf)


def line(figure):
    number = lambda v: v[:60] if isinstance(v, str) else f"{v:.4g}"
    times = figure["cpu"]
    cells = [f"{times[0]:.3f}", f"{times[1]:.3f}, {times[2]:.3f}", f"{times[4]:.2f}"] if times else ["", "", ""]
    of = ratio(figure)
    return (f"| {figure['case']} | {figure['scheme']} | {figure['n']} | {figure['what']} | {number(figure['then'])} | {number(figure['now'])} | "
            f"{'' if of is None else f'{of:.3f}'} | " + " | ".join(cells) + " |")


def keep(commit, figures):
    """The figures go to the results of this commit, each in the place of the one that it replaces."""
    file = harness.RESULTS / f"against-{commit}.csv"
    of = lambda f: (list(CASES).index(f["name"]), f["case"], f["scheme"], float(f["n"] or 0), f["what"])
    known = {of(f): f for f in store.load(file, {"figures": []})["figures"]}
    known.update((of(f), f) for f in figures)
    store.keep(file, {"commit": commit, "processor": processor(), "figures": [known[k] for k in sorted(known)]})


def tables():
    """Those of all commits that have results, on docs/accuracy.md."""
    text = []
    for file in sorted(harness.RESULTS.glob("against-*.csv")):
        result = store.load(file)
        text += [f"\n### Commit {result['commit']} and now\n", HEAD] + [line(f) for f in result["figures"]] + [f"\nMeasured on {result['processor']}."]
    return {"against": "\n".join(text)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", type=pathlib.Path)
    parser.add_argument("--this", type=pathlib.Path, default=harness.ROOT / "build/barchan")
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--largest", type=int, default=100)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", metavar="COMMIT")
    parser.add_argument("--set", action="append", default=[])
    given = parser.parse_args()
    unknown = [c for c in given.cases.split(",") if c not in CASES]
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; cases are {', '.join(CASES)}")
    options.set, options.largest = given.set, given.largest
    print(HEAD)
    for name in given.cases.split(","):
        for part in CASES[name]():
            with tempfile.TemporaryDirectory() as scratch:
                harness.run_into = turns = Turns(given.other, given.this, given.rounds, pathlib.Path(scratch) / "runs")
                figures = compare(name, part, turns)
            print("\n".join(line(f) for f in figures), flush=True)
            if given.write:
                keep(given.write, figures)


if __name__ == "__main__":
    sys.exit(main())
