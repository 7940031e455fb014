#!/usr/bin/python3
"""Bodies against exact solutions and references, and the paper's impacts: the tables and plots of docs/impacts.md.

    /usr/bin/python3 bench/impacts/cases.py build/barchan [--only CASE]...

Cases: cantilever, csm3, restitution, paper, of bars.py bars, rows, of bounce.py rings, block, of hertz.py hertz, hertz_spheres, of eq13.py eq13, and of rigid.py top, pendulum, rolling, gears; bearing.py has a command of its own. Results are kept case by case in bench/impacts/results/impacts.csv. What a case
draws, docs/gallery/impacts_*.png, it draws when it is measured. One thread, about five minutes
on a quiet core; csm3 takes most of them.
"""

import argparse
import math
import pathlib
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import bars
import bearing
import bounce
import eq13
import hertz
import rigid
from barchan_bench import ROOT, page as pages, run, store

RESULTS = ROOT / "bench/impacts/results/impacts.csv"
TIMOSHENKO, THIN = 0.25645, 0.25403  # s, period of the plate
SPEED = 10.0  # m/s: of what hits


class Run:
    """A run of a scene; columns of its history by their names."""

    def __init__(self, program, scene, settings=()):
        with tempfile.TemporaryDirectory(prefix="barchan_impacts_") as folder:
            ended = run.scene(program, scene, folder, ["output.every=0", *settings], shown=True)
            self.history, self.report = ended.history(), ended.report

    def __getitem__(self, name):
        return self.history[name]

    def energy(self, bodies):
        return sum(self[f"{b}_{kind}_energy"] for b in bodies for kind in ("kinetic", "strain", "hourglass"))


def cantilever(program):
    table = []
    for across in (5, 10, 20):
        run = Run(program, "verification/cantilever", [f"spacing={0.02 / across!r}"])
        t, y = run["time"], run["tip_y"] - run["tip_y"][0]
        zeros = [t[k] - y[k] * (t[k + 1] - t[k]) / (y[k + 1] - y[k]) for k in range(1, len(t) - 1) if y[k] * y[k + 1] < 0]
        period = float(np.mean(np.array(zeros[2:]) - np.array(zeros[:-2]))) if len(zeros) > 2 else zeros[1]
        energy = run.energy(["plate"])
        table.append({"across": across, "period": period, "amplitude": float(y.max() - y.min()) / 2,
                      "energy": float(abs(energy / energy[0] - 1).max()), "history": [t.tolist(), y.tolist()] if across == 10 else None})
    long = Run(program, "verification/cantilever", ["time.end=5.2", "output.history-every=5e-3"])
    y = long["tip_y"] - long["tip_y"][0]
    n = len(y) // 20
    return {"table": table, "twenty": {"first": float(abs(y[:n]).max()), "last": float(abs(y[-n:]).max()),
                                       "energy": float(abs(long.energy(["plate"]) / long.energy(["plate"])[0] - 1).max())}}


def csm3(program):
    table = []
    for across in (5, 9, 17):
        run = Run(program, "verification/turek_hron_csm3", [f"spacing={0.02 / across!r}"])
        t, x, y, bx, by = (run[n] for n in ("time", "tip_x", "tip_y", "before_x", "before_y"))
        share = (0.35033 - x[0]) / (x[0] - bx[0])
        ux, uy = x + share * (x - bx) - 0.35033, y + share * (y - by)
        lows = [k for k in range(1, len(t) - 1) if uy[k] < uy[k - 1] and uy[k] <= uy[k + 1] and uy[k] < -0.05]
        at = []
        for k in lows[:2]:
            c = np.polyfit(t[k - 1:k + 2] - t[k], uy[k - 1:k + 2], 2)
            at.append(t[k] - c[1] / (2 * c[0]))
        middle, half = (lambda u: float(u.max() + u.min()) / 2), (lambda u: float(u.max() - u.min()) / 2)
        table.append({"across": across, "ux": [middle(ux), half(ux)], "uy": [middle(uy), half(uy)], "frequency": 1 / float(at[1] - at[0])})
    return {"table": table}


def restitution(program):
    table = []
    for written in (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 1.0):
        for young, speed in ((206e9, 10), (206e6, 10), (206e12, 10), (206e9, 0.1), (206e9, 100)):
            run = Run(program, "verification/two_particle_impact", [
                f"interactions={{ a-b = {{ restitution = {written} }} }}", f"phases.a.young={young}", f"phases.b.young={young}",
                "phases.a.formulation=total-lagrangian", "phases.b.formulation=total-lagrangian", f"fill.0.velocity=[{speed}, 0, 0]",
                "fill.1.shape.points=[[0.0030001, 0.002, 0.002]]", f"time.largest-speed={speed}",
                f"time.end={1.2e-7 / speed + 20 * 1e-3 / math.sqrt(young / 7870)!r}"])
            table.append({"written": written, "young": young, "speed": speed,
                          "measured": float(run["b_mean_vx"][-1] - run["a_mean_vx"][-1]) / speed})
    return {"table": table}


FIGURES = [  # figure, scene, settings, what the paper says
    ("6a", "impact_single", ["interactions.a-b=2.4"], "A and B go on together with half the speed; they feel each other too early"),
    ("6b", "impact_cubes", ["interactions.a-b=2.4"], "the same"),
    ("7a", "impact_single", [], "half the speed each; contact where they touch"),
    ("7b", "impact_cubes", [], "A slower than B, they part: weakly elastic"),
    ("8a", "impact_single", ["interactions.a-b=2.4", "phases.a.young=206e12", "phases.b.young=206e12", "time.end=5e-5"],
     "more of the speed is exchanged than with 206 GPa"),
    ("8b", "impact_single", ["phases.a.young=206e12", "phases.b.young=206e12", "time.end=3e-5", "fill.1.shape.points=[[0.0031, 0.002, 0.002]]"],
     "more elastic than 8a, at the right distance"),
    ("9a", "impact_cubes", ["interactions.a-b=2.4", "phases.a.young=206e12", "phases.b.young=206e12", "time.end=1.2e-4"], "as 8a"),
    ("9b", "impact_cubes", ["phases.a.young=206e12", "phases.b.young=206e12", "time.end=3e-5", "fill.1.shape.cube.centre=[0.0211, 0.010, 0.010]"],
     "as 8b"),
]


def paper(program):
    table = []
    for figure, scene, settings, statement in FIGURES:
        run = Run(program, "paper/" + scene, settings)
        t, a, b = run["time"], run["a_mean_vx"], run["b_mean_vx"]
        gap = {"9b": 1.1, "8b": 1.1}.get(figure, 2.5)  # spacings between the nearest particles at the start
        begins = next(k for k in range(len(t)) if b[k] > 1e-3 * SPEED)
        table.append({"figure": figure, "statement": statement, "a": float(a[-1]), "b": float(b[-1]), "begins": gap - SPEED * float(t[begins]) / 1e-3,
                      "history": [t.tolist(), a.tolist(), b.tolist()]})
    return {"table": table}


CASES = {"cantilever": cantilever, "csm3": csm3, "restitution": restitution, "paper": paper} | hertz.CASES | eq13.CASES
for other_name, other_case in (bars.CASES | rigid.CASES | bounce.CASES).items():
    CASES[other_name] = lambda program, case=other_case: case(lambda *scene: Run(program, *scene))


def verdict(row):
    left, right = row["a"] / SPEED, row["b"] / SPEED
    if abs(left - 0.5) < 0.05 and abs(right - 0.5) < 0.05:
        return "half each"
    return "all of it exchanged" if left < 0.02 else "most of it exchanged" if left < 0.3 else "part of it exchanged"


def page(results):
    lines = []
    if "cantilever" in results:
        lines += ["### A clamped plate (Gray et al. 2001)", "",
                  "| particles across | period [s] | over Timoshenko's 0.2565 s | amplitude over that of thin beams, 0.0231 m | energy, largest change |",
                  "| --- | --- | --- | --- | --- |"]
        rows = results["cantilever"]["table"]
        lines += [f"| {r['across']} | {r['period']:.5f} | {100 * (r['period'] / TIMOSHENKO - 1):+.2f} % | {100 * (r['amplitude'] / 0.023057 - 1):+.1f} % | "
                  f"{r['energy']:.1e} |" for r in rows]
        twenty = results["cantilever"]["twenty"]
        lines += ["", f"Over 20 periods with 10 across the amplitude goes from {1e3 * twenty['first']:.3f} to {1e3 * twenty['last']:.3f} mm, the energy "
                  f"changes by {twenty['energy']:.1e}. Nothing damps it.", "", "![The tip of the plate](gallery/impacts_cantilever.png)", ""]
    if "csm3" in results:
        lines += ["### A plate that swings under its weight (Turek and Hron, CSM3)", "",
                  "| particles across | u_x [mm] | u_y [mm] | frequency [Hz] |", "| --- | --- | --- | --- |"]
        lines += [f"| {r['across']} | {1e3 * r['ux'][0]:.2f} +- {1e3 * r['ux'][1]:.2f} | {1e3 * r['uy'][0]:.2f} +- {1e3 * r['uy'][1]:.2f} | "
                  f"{r['frequency']:.4f} |" for r in results["csm3"]["table"]]
        lines += ["| reference | -14.305 +- 14.305 | -63.607 +- 65.160 | 1.0995 (1.0940 in the mean of 10 s) |", ""]
    lines += bars.page(results)
    if "restitution" in results:
        rows = results["restitution"]["table"]
        combinations = sorted({(r["young"], r["speed"]) for r in rows})
        lines += ["### Restitution of two particles", "", "| written | " + " | ".join(f"E {y / 1e9:g} GPa, {v:g} m/s" for y, v in combinations) + " |",
                  "| --- |" + " --- |" * len(combinations)]
        for written in sorted({r["written"] for r in rows}):
            found = {(r["young"], r["speed"]): r["measured"] for r in rows if r["written"] == written}
            lines.append(f"| {written} | " + " | ".join(f"{found[c]:.5f}" for c in combinations) + " |")
        lines.append("")
    if "paper" in results:
        lines += ["### Figures 6 to 9 of the paper", "",
                  "| figure | the paper | speed of A, of B at the end [m/s] | distance at which the force begins [dx] | ours |", "| --- | --- | --- | --- | --- |"]
        lines += [f"| {r['figure']} | {r['statement']} | {r['a']:.2f}, {r['b']:.2f} | {r['begins']:.2f} | {verdict(r)} |" for r in results["paper"]["table"]]
        lines += ["", "![Speeds in figures 6 to 9](gallery/impacts_paper.png)", ""]
    lines += bounce.page(results) + hertz.page(results) + eq13.page(results) + rigid.page(results)
    if "bearing" in results:
        lines += bearing.page(results["bearing"])
    return "\n".join(lines)


def plot(name, result):
    """docs/gallery/impacts_NAME.png of a case that was measured now, if it has one. Colours of Okabe & Ito (Color Universal Design, 2008), and a line style
    for each series."""
    pyplot = pages.pyplot()
    blue, red = "#0072B2", "#D55E00"
    gallery = ROOT / "docs/gallery"
    if name == "cantilever":
        t, y = next(r["history"] for r in result["table"] if r["history"])
        figure, axes = pyplot.subplots(figsize=(7, 3.2), layout="constrained")
        axes.plot(t, np.array(y) * 1e3, color=blue, label="10 particles across")
        phase = np.linspace(0, max(t), 400)
        axes.plot(phase, 23.057 * np.sin(2 * np.pi * phase / TIMOSHENKO), "--", color=red, label="beam: thin amplitude, Timoshenko's period")
        axes.set(xlabel="time [s]", ylabel="tip [mm]")
        axes.legend(loc="lower center", bbox_to_anchor=(.5, 1.), ncol=2, frameon=False)
        figure.savefig(gallery / "impacts_cantilever.png", dpi=110)
    if name == "bars":
        t, a, b = (np.array(x) for x in result["history"])
        figure, axes = pyplot.subplots(figsize=(7, 3.2), layout="constrained")
        axes.plot(t * 1e6, a, color=blue, label="A")
        axes.plot(t * 1e6, b, "--", color=red, label="B")
        axes.plot([0, 1e6 * bars.EXACT, max(t) * 1e6], [10, 0, 0], ":", color="black", label="exact")
        axes.plot([0, 1e6 * bars.EXACT, max(t) * 1e6], [0, 10, 10], ":", color="black")
        axes.set(xlabel="time [us]", ylabel="mean speed [m/s]")
        axes.legend(loc="lower center", bbox_to_anchor=(.5, 1.), ncol=2, frameon=False)
        figure.savefig(gallery / "impacts_bars.png", dpi=110)
    if name == "paper":
        figure, all_axes = pyplot.subplots(2, 4, figsize=(11, 4.6), layout="constrained", sharey=True)
        for axes, r in zip(all_axes.T.flat, result["table"]):
            t, a, b = (np.array(x) for x in r["history"])
            axes.plot(t * 1e6, a, color=blue, label="A")
            axes.plot(t * 1e6, b, "--", color=red, label="B")
            axes.set(title="figure " + r["figure"], xlabel="time [us]")
        for axes in all_axes[:, 0]:
            axes.set_ylabel("mean speed [m/s]")
        all_axes[0, 0].legend(loc="lower center", bbox_to_anchor=(.5, 1.06), ncol=2, frameon=False)
        figure.savefig(gallery / "impacts_paper.png", dpi=110)
    if name == "hertz":
        hertz.plot(result, gallery, pyplot)


def tables():
    """That of docs/impacts.md."""
    return {"measured": page(store.load(RESULTS, {}))}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program")
    parser.add_argument("--only", action="append")
    options = parser.parse_args()
    results = store.load(RESULTS, {})
    for name, case in CASES.items():
        if options.only is None or name in options.only:
            results[name] = case(options.program)
            plot(name, results[name])
            store.keep(RESULTS, results, leave=("history",))
            print(name, "done")
    print(page(results))


if __name__ == "__main__":
    main()
