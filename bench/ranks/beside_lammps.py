#!/usr/bin/python3
"""Barchan and LAMMPS on the same ranks, by turns: the table "Beside LAMMPS" of docs/ranks.md.

    /usr/bin/python3 bench/ranks/beside_lammps.py PROGRAM LMP [--only NAME]... [--rounds 3] [--ranks 1 2] [--write]

Fluids: periodic air, a disturbed lattice, the kernel radius 2.1 spacings, the same step in both programs. LAMMPS has `sph/taitwater` (Monaghan's
artificial viscosity, no shifts, no correction of gradients); Barchan has its consistent and its plain scheme, which compute more. Grains: the dense beds of
bench/grains/lammps.py. LMP is an `lmp` with the packages SPH and GRANULAR; Debian's has no SPH, and is built for SSE2: build LAMMPS for the same processor.
LAMMPS runs with several skins, the best one counts. A figure is particle-steps a second of the steps alone. With --write the results go to
bench/ranks/results/beside_lammps.csv.
"""

import argparse
import pathlib
import re
import statistics
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE), str(HERE.parent / "grains")]
import lammps as beds  # noqa: E402
from barchan_bench import ROOT, run, store, table  # noqa: E402
from speed import air  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/beside_lammps.csv"
BOUND = 1.5
RADIUS = 2.1  # spacings
SKINS = (.1, .2, .3, .4)  # of the radius
# name: dimensions, particles along an edge, end of the run (s); of grains: dimensions, grains, steps of contacts
FLUIDS = {"SPH 2D, 2.5e5": (2, 500, .012), "SPH 3D, 2.5e5": (3, 63, .04)}
BEDS = {"GRANULAR 2D, 1e5": (2, 100000, 800), "GRANULAR 3D, 1.1e5": (3, 111671, 800)}
CASES = [*FLUIDS, *BEDS]
SCRIPT = """units si
dimension {dimensions}
boundary p p p
atom_style sph
comm_modify vel yes
lattice {lattice} {dx!r}
region box block 0 1 0 1 {low!r} {high!r} units box
create_box 1 box
create_atoms 1 box
mass 1 {mass!r}
displace_atoms all random {shift!r} {shift!r} {shift_z!r} 4711 units box
set group all sph/rho 1.0
variable vx atom -cos(2*PI*x)*sin(2*PI*y)
variable vy atom sin(2*PI*x)*cos(2*PI*y)
velocity all set v_vx v_vy 0.0
pair_style sph/taitwater
pair_coeff * * 1.0 10.0 0.1 {radius!r}
neighbor {skin!r} bin
neigh_modify every 1 delay 0 check yes
fix 1 all sph
timestep {step!r}
thermo {steps}
run {steps}
"""


def on_ranks(ranks):
    return ["mpirun", "--allow-run-as-root", "--bind-to", "none", "-n", ranks]


def barchan(program, ranks, text):
    with tempfile.TemporaryDirectory() as folder:
        return run.scene(program, text, pathlib.Path(folder) / "out", threads=1, before=on_ranks(ranks)).report


def theirs(lmp, ranks, text, steps, particles):
    """Particle-steps a second, and how often LAMMPS made its lists."""
    with tempfile.TemporaryDirectory() as folder:
        script = pathlib.Path(folder) / "in.air"
        script.write_text(text)
        said = run.command([*on_ranks(ranks), lmp, "-in", script, "-log", "none"], folder=pathlib.Path(folder), environment={"OMP_NUM_THREADS": "1"}, check=True).stdout
    atoms = int(re.search(r"Created (\d+) atoms", said)[1])
    if atoms != particles:
        raise RuntimeError(f"LAMMPS has {atoms} particles; expected {particles}")
    return particles * steps / float(re.search(r"Loop time of ([\d.e+-]+)", said)[1]), int(re.search(r"Neighbor list builds = (\d+)", said)[1])


def fluid(program, lmp, name, ranks, rounds):
    dimensions, across, end = FLUIDS[name]
    schemes = {scheme: air(dimensions, across, end).replace('"consistent"', f'"{scheme}"') for scheme in ("consistent", "plain")}
    dx, particles = 1 / across, across**dimensions
    first = barchan(program, ranks, schemes["consistent"])
    steps, step = first["steps"], first["simulated_time"] / first["steps"]
    flat = dimensions == 2

    def script(skin):
        return SCRIPT.format(dimensions=dimensions, lattice="sq" if flat else "sc", dx=dx, low=-.5 * dx if flat else 0, high=.5 * dx if flat else 1, mass=dx**dimensions,
                             shift=.1 * dx, shift_z=0 if flat else .1 * dx, radius=RADIUS * dx, skin=skin * RADIUS * dx, step=step, steps=steps)

    ours, others = {scheme: [] for scheme in schemes}, {skin: [] for skin in SKINS}
    for turn in range(rounds):
        for scheme, text in schemes.items():
            ours[scheme].append(barchan(program, ranks, text)["particle_steps_per_second"])
        for skin in SKINS:
            rate, builds = theirs(lmp, ranks, script(skin), steps, particles)
            others[skin].append(rate)
        print(name, ranks, turn, {k: f"{v[-1] / 1e6:.2f}" for k, v in ours.items()}, {k: f"{v[-1] / 1e6:.2f}" for k, v in others.items()}, builds, flush=True)
    skin = max(SKINS, key=lambda s: statistics.median(others[s]))
    return {scheme: row(particles, steps, rates, others[skin], skin) for scheme, rates in ours.items()}


def row(particles, steps, ours, others, skin):
    ratios = sorted(a / b for a, b in zip(ours, others))
    return {"particles": particles, "steps": steps, "barchan": statistics.median(ours), "lammps": statistics.median(others), "skin": skin,
            "ratio": [statistics.median(ratios), ratios[0], ratios[-1]]}


def bed(program, lmp, name, ranks, rounds):
    dimensions, grains, steps = BEDS[name]
    with tempfile.TemporaryDirectory() as scratch:
        r = beds.measure(program, lmp, dimensions, grains, steps, rounds, pathlib.Path(scratch), on_ranks(ranks))
    ratios = sorted(r["ratios"])
    return {"Hertz": {"particles": r["grains"], "steps": r["steps"], "barchan": r["barchan"], "lammps": r["lammps"], "skin": r["skin"],
                      "ratio": [statistics.median(ratios), ratios[0], ratios[-1]]}}


def text(results):
    """The table of the page."""
    lines = [table.head("case", "ranks", "Barchan's", "particles, steps", "million particle-steps a second: Barchan, LAMMPS", "skin", f"ratio, >= {BOUND}")]
    for name in CASES:
        for ranks, laws in results.get(name, {}).items():
            for law, r in laws.items():
                low = "" if r["ratio"][0] >= BOUND else ", **not met**"
                lines.append(table.row(name, ranks, law, f"{r['particles']}, {r['steps']}", f"{r['barchan'] / 1e6:.2f}, {r['lammps'] / 1e6:.2f}", r["skin"],
                                       "{:.2f} ({:.2f} to {:.2f})".format(*r["ratio"]) + low))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"beside LAMMPS": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("lmp", type=pathlib.Path)
    parser.add_argument("--only", action="append", choices=CASES)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    program, lmp = str(options.program.resolve()), str(options.lmp.resolve())
    results = store.load(RESULTS, {})
    for name in options.only or CASES:
        for ranks in options.ranks:
            results.setdefault(name, {})[str(ranks)] = (fluid if name in FLUIDS else bed)(program, lmp, name, ranks, options.rounds)
    print(text(results))
    if options.write:
        store.keep(RESULTS, results)


if __name__ == "__main__":
    main()
