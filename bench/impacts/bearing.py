"""The ball bearing of scenes/bearing.toml: passes of the inclusion, films, and the ledgers of mass, momentum and energy.

    /usr/bin/python3 bench/impacts/bearing.py build/barchan [--threads N] [--of DIR] [--write]

--of DIR reads a run that is there instead of running the scene. With --write the figures go into bench/impacts/results/impacts.csv.
"""

import argparse
import json
import math
import pathlib
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402

RESULTS = ROOT / "bench/impacts/results/impacts.csv"
INNER, OUTER, BALL, DX = 1e-2, 1.78e-2, 3e-3, 3e-4  # m: the rings' surfaces, radius of the balls, spacing
DENSITY = {"oil": 900, "inner": 7850, "balls": 1140, "inclusion": 2650}  # kg/m3


def integral(y, t):
    return np.concatenate([[0.0], np.cumsum(0.5 * (y[1:] + y[:-1]) * np.diff(t))])


def measure(folder):
    names = table(folder / "history.csv")
    report = json.loads((folder / "run.json").read_text())
    column = names.__getitem__
    t = column("time")
    counts = report["particles"]
    mass = {name: DENSITY[name] * DX**2 * counts[name] for name in DENSITY}
    balls = [f"balls_{k}" for k in range(1, 9)]

    radius = lambda body: np.hypot(column(body + "_x [m]"), column(body + "_y [m]"))
    inner_film = min(float((radius(b) - BALL - INNER).min()) for b in balls)
    outer_film = min(float((OUTER - radius(b) - BALL).min()) for b in balls)
    angle = np.unwrap(np.arctan2(column("inclusion_y [m]"), column("inclusion_x [m]")))
    # A pass: a ball overtakes the inclusion, the angle from it to the ball becomes positive.
    passed = 0
    for b in balls:
        ahead = np.unwrap(np.arctan2(column(b + "_y [m]"), column(b + "_x [m]")) - angle)
        passed += int(np.floor(ahead[-1] / (2 * math.pi)) - np.floor(ahead[0] / (2 * math.pi)))
    carried = np.unwrap(np.arctan2(column("balls_1_y [m]"), column("balls_1_x [m]")))

    # Momentum of oil, balls and inclusion: all but the driven ring. What the rings feel is what these lose.
    worst = 0.0
    speed = math.sqrt(2 * max(column("oil_kinetic_energy") + column("balls_kinetic_energy")) * sum(mass[p] for p in ("oil", "balls", "inclusion")))
    for d in "xy":
        momentum = column("momentum_" + d) - mass["inner"] * column("inner_velocity_" + d)
        lost = integral(column("inner_force_" + d) + column("outer_force_" + d), t)
        worst = max(worst, float(abs(momentum - momentum[0] + lost).max()) / speed)

    # Energy: what the driven ring gives becomes motion, internal energy of the oil, or is taken by contacts (docs/method.md). All are sums over the
    # steps that the program keeps.
    work = column("inner_work")[0] - column("inner_work")
    kinetic = sum(column(f"{p}_kinetic_energy") for p in ("oil", "balls", "inclusion"))
    internal = column("oil_internal_energy")
    taken = sum(column(n.split(" ")[0]) for n in names if "_taken_energy" in n)
    left = work - (kinetic - kinetic[0]) - (internal - internal[0]) - (taken - taken[0])
    overlaps = {n.split()[0]: float(column(n).max()) / DX for n in names if "_overlap" in n}

    frames = series(folder / "bearing.pvd")
    oil = [Frame(path, time, "oil").x for time, path in (frames[0], frames[-1])]
    r = np.hypot(oil[1][:, 0], oil[1][:, 1])
    return {"time": float(t[-1]), "steps": report["steps"], "passes": passed, "rounds": float((angle[-1] - angle[0]) / (2 * math.pi)),
            "carried": float((carried[-1] - carried[0]) / (2 * math.pi)), "turns": float(integral(column("inner_angular_velocity"), t)[-1] / (2 * math.pi)),
            "inner_film": inner_film / DX, "outer_film": outer_film / DX, "overlaps": overlaps,
            "mass": abs(len(oil[1]) / len(oil[0]) - 1), "inside": float(min(r.min() - INNER, OUTER - r.max()) / DX),
            "momentum": worst, "work": float(work[-1]), "kinetic": float(kinetic[-1] - kinetic[0]), "internal": float(internal[-1] - internal[0]),
            "taken": float(taken[-1] - taken[0]), "left": float(abs(left).max() / work[-1]), "torque": float(-column("inner_torque")[len(t) // 2:].mean()),
            "density": float(column("largest_density_error").max())}


def page(r):
    return ["### A ball bearing with lubricant and an inclusion", "",
            f"`scenes/bearing.toml` to {r['time']:g} s, {r['steps']} steps: the driven ring turns {r['turns']:.1f} times. A pass: a ball overtakes the inclusion.",
            "", "| figure | measured | wanted |", "| --- | --- | --- |",
            f"| passes of the inclusion | {r['passes']} | 3 |",
            f"| rounds of the inclusion about the bearing; of the first ball | {r['rounds']:.2f}; {r['carried']:.2f} | |",
            f"| least film between a ball and the inner, the outer ring [dx] | {r['inner_film']:.2f}, {r['outer_film']:.2f} | above 0 |",
            "| deepest overlap [dx] | " + ", ".join(f"{name.replace('_overlap', '').replace('_', '-')} {depth:.2f}" for name, depth in r["overlaps"].items() if depth > 0)
            + "; no other bodies touch | |",
            f"| mass of the lubricant, change; nearest to leaving [dx] | {r['mass']:.0e}; {r['inside']:.2f} inside | 1e-12; above 0 |",
            f"| momentum of oil, balls and inclusion, and what the rings felt: sum over mass times speed | {r['momentum']:.1e} | 1 % |",
            f"| work of the driving torque [J/m] = motion + oil's internal energy + taken by contacts; largest rest | {r['work']:.3f} = {r['kinetic']:.3f} + "
            f"{r['internal']:.3f} + {r['taken']:.1e}; {100 * r['left']:.1e} % | rest within 1 % |",
            f"| mean driving torque, second half [N m/m] | {r['torque']:.4f} | |",
            f"| largest change of the oil's density | {100 * r['density']:.1f} % | |", "",
            "A ball catches the inclusion, throws it against the outer ring and rolls over it; so do those that follow.", "",
            "![Speed of the oil about the balls at 60 ms](gallery/scenes/bearing.png)", ""]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("--threads", default="2")
    parser.add_argument("--of", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    chosen = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="barchan_bearing_") as folder:
        if not chosen.of:
            run.scene(chosen.program, "bearing", folder, threads=chosen.threads, shown=True)
        found = measure(chosen.of or pathlib.Path(folder))
    print("\n".join(page(found)))
    if chosen.write:
        store.keep(RESULTS, {**store.load(RESULTS, {}), "bearing": found})


if __name__ == "__main__":
    main()
