#!/usr/bin/python3
"""Dense beds of spheres in Barchan and in LAMMPS' package GRANULAR, one core each, in turn.

    /usr/bin/python3 bench/grains/lammps.py build/barchan [--lammps lmp] [--rounds 3] [--grains 100000] [--steps 1000] [--write]

Hertz contacts with tangential history, friction 0.5, restitution 0.5, sizes 1 mm +- 20 % (3D: a layer on a floor with periodic sides; 2D: a
layer one grain thick, which both programs compute as spheres whose third coordinate is fixed). A small bed settles in Barchan and is put
side by side until --grains are there: both programs start from the same places, radii and velocities (0.05 m/s in waves, so that
contacts open and close and lists are searched anew) and take the same step. LAMMPS runs with each skin of SKINS; its best counts.
The figure is grain-steps a second of user CPU time, steps only; the median of the rounds. A step here is one of the contacts'.
With --write the figures go to bench/grains/results/lammps.csv.
"""

import argparse
import json
import math
import pathlib
import re
import statistics
import sys
import tempfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import run, store, table  # noqa: E402
from barchan_bench.frame import Frame, write_particles  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SKINS = (.1, .2, .3)  # of the mean diameter
SUBSTEPS = 8  # of the grains in a step of Barchan's, when nothing else limits it
D, YOUNG, POISSON, FRICTION, RESTITUTION, DENSITY = 1e-3, 5e6, .25, .5, .5, 2650.

SCENE = """title      = "Dense bed"
dimensions = {dim}
spacing    = {d!r}
[domain]
size     = {size}
periodic = {periodic}
gravity  = {gravity}
[phases.sand]
kind        = "grains"
density     = {density!r}
diameter    = {{ mean = {d!r}, spread = 0.2 }}
restitution = {restitution!r}
friction    = {friction!r}
young       = {young!r}
poisson     = {poisson!r}
[phases.floor]
kind = "wall"
[interactions]
sand-sand  = {{ law = "hertz" }}
sand-floor = {{ law = "hertz" }}
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"] }}
[[fill]]
phase = "sand"
{fill}
[time]
end           = {end!r}
largest-speed = 1.0
{step}
[output]
every         = {every!r}
history-every = {end!r}
fields        = ["radius"]
checkpoint-every = 1e6
"""


def scene(dim, size, fill, end, every, step=""):
    up = [0, -9.81] + [0] * (dim - 2)
    return SCENE.format(dim=dim, d=D, size=size, periodic=json.dumps(["x", "z"][: dim - 1]), gravity=up, density=DENSITY, restitution=RESTITUTION,
                        friction=FRICTION, young=YOUNG, poisson=POISSON, fill=fill, end=end, every=every, step=step)


def barchan(program, folder, text, before=()):
    """A run of a scene's text; `before`: the words of a launcher of ranks."""
    return run.scene(program, run.scene_file(text, folder, "bed.toml"), folder / "out", shown=True, before=before)


def waves(x, dim):
    k = 2 * math.pi / (20 * D)
    v = .05 * numpy.column_stack([numpy.sin(k * (x[:, 1] + .7 * x[:, 0])), numpy.sin(k * (1.3 * x[:, 0] - x[:, 2])), numpy.sin(k * (x[:, 0] + .4 * x[:, 1]))])
    if dim == 2:
        v[:, 2] = 0
    return v


def formulas(dim):
    k = repr(2 * math.pi / (20 * D))
    f = [f"0.05*sin({k}*(y + 0.7*x))", f"0.05*sin({k}*(1.3*x - {'z' if dim == 3 else '0'}))", f"0.05*sin({k}*(x + 0.4*y))"]
    return json.dumps(f[:dim])


def gamma(mass, stiffness):
    """Of gran/hertz/history (1/(m s)): F_n = sqrt(delta R*) (k_n delta - m* gamma_n v); e as for Tsuji et al. 1992."""
    loss = -math.log(RESTITUTION)
    alpha = math.sqrt(5) * loss / math.sqrt(math.pi**2 + loss**2)
    return alpha * math.sqrt(stiffness / mass)  # alpha sqrt(m* k_n) delta^(1/4) R*^(1/4) at a mean overlap: the cost is the same


def lammps(program, folder, dim, size, x, radius, v, step, steps, skin, before=()):
    low, high = (-.5 * D, .5 * D) if dim == 2 else (0, size[2])
    rows = [f"{k + 1} 1 {2 * r:.17g} {DENSITY:.17g} {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}" for k, (p, r) in enumerate(zip(x, radius))]
    speeds = [f"{k + 1} {u[0]:.17g} {u[1]:.17g} {u[2]:.17g} 0 0 0" for k, u in enumerate(v)]
    (folder / "bed.data").write_text(f"bed\n\n{len(x)} atoms\n1 atom types\n\n0 {size[0]} xlo xhi\n{-D} {size[1]} ylo yhi\n{low} {high} zlo zhi\n\nAtoms\n\n" +
                                     "\n".join(rows) + "\n\nVelocities\n\n" + "\n".join(speeds) + "\n")
    stiffness = 2 * YOUNG / (3 * (1 - POISSON**2))
    mass = DENSITY * math.pi / 6 * D**3 / 2
    contact = f"hertz/history {stiffness} NULL {gamma(mass, stiffness)} NULL {FRICTION} 1"
    flat = dim == 2
    (folder / "in.bed").write_text(f"""units si
atom_style sphere
dimension {dim}
boundary p f p
newton off
comm_modify vel yes
read_data {folder}/bed.data
pair_style gran/{contact}
pair_coeff * *
neighbor {skin * D} bin
neigh_modify every 1 delay 0 check yes
fix 1 all gravity 9.81 vector 0 -1 0
fix 2 all wall/gran {contact} yplane 0 NULL
fix 3 all nve/sphere
{'fix 4 all enforce2d' if flat else ''}
timestep {step}
thermo {steps}
run {steps}
""")
    said = run.command([*before, program, "-in", folder / "in.bed", "-log", "none"], folder=folder)
    text = said.stdout
    if said.status:
        raise SystemExit(f"lammps.py: {program} failed\n{text}\n{said.stderr}")
    return float(re.search(r"Loop time of ([\d.e+-]+)", text)[1]), int(re.search(r"Neighbor list builds = (\d+)", text)[1])


def dense_bed(program, dim, grains, scratch):
    """About `grains` grains: a small bed settles and is put side by side. Returns places, radii (m), the size of the domain and the fill of a scene, which
    reads a file in the folder `scratch`."""
    depth, side = (30 * D, .3) if dim == 2 else (15 * D, .012)
    size = [side, 2 * depth] + ([side] if dim == 3 else [])
    box = json.dumps({"min": [0] * dim, "max": [side, depth] + [side] * (dim - 2)}).replace(":", " =").replace('"', "")
    folder = scratch / f"settle{dim}"
    folder.mkdir()
    settled = barchan(program, folder, scene(dim, size, f"shape = {{ box = {box} }}\npacking = \"settled\"", 1e-4, 1e-4))
    bed = Frame(settled.series()[0][1], phase="sand")
    x, radius = bed.x.astype(float), bed["radius"].astype(float)
    many = max(1, round(grains / len(x)))
    across = round(math.sqrt(many)) if dim == 3 else many
    shifts = [(a * side, 0, b * side) for a in range(across) for b in range(across if dim == 3 else 1)]
    x, radius = numpy.concatenate([x + s for s in shifts]), numpy.tile(radius, len(shifts))
    size = [side * across, 2 * depth] + ([side * across] if dim == 3 else [])
    write_particles(scratch / f"bed{dim}.vtp", x, "sand", radius=radius)
    return x, radius, size, f"shape = {{ file = \"{scratch}/bed{dim}.vtp\" }}\nvelocity = {formulas(dim)}"


def measure(program, lmp, dim, grains, steps, rounds, scratch, before=()):
    """`before`: the words of a launcher that starts both programs on ranks."""
    x, radius, size, fill = dense_bed(program, dim, grains, scratch)
    v = waves(x, dim)
    ours, theirs, end = [], {skin: [] for skin in SKINS}, 2e-3
    for turn in range(rounds + 1):  # the first, short, tells the step
        folder = scratch / f"run{dim}_{turn}"
        folder.mkdir()
        report = barchan(program, folder, scene(dim, size, fill, end, end), before).report
        contact_steps = report["steps"] * SUBSTEPS
        contact_step = report["simulated_time"] / contact_steps
        if turn == 0:
            end = contact_step * steps
            continue
        spent = sum(t for name, t in report["seconds"].items() if not name.startswith("output"))
        ours.append(len(x) * contact_steps / spent)
        for skin in SKINS:
            seconds, builds = lammps(lmp, folder, dim, size, x, radius, v, contact_step, steps, skin, before)
            theirs[skin].append(len(x) * steps / seconds)
            print(f"{dim}D round {turn}: Barchan {ours[-1] / 1e6:.2f}, LAMMPS skin {skin} d {theirs[skin][-1] / 1e6:.2f} M grain-steps/s, {builds} builds",
                  flush=True)
    best = max(SKINS, key=lambda skin: statistics.median(theirs[skin]))
    a, b = statistics.median(ours), statistics.median(theirs[best])
    contacts = report["pairs"]["sand-sand"] / len(x) / 2
    return {"dimensions": dim, "grains": len(x), "contact_step": contact_step, "steps": steps, "barchan": a, "lammps": b, "skin": best,
            "ratio": a / b, "ratios": [o / t for o, t in zip(ours, theirs[best])], "listed_pairs_a_grain": contacts}


def tables():
    """That of docs/performance.md."""
    lines = [table.head("bed", "grains", "Barchan, M grain-steps/s", "LAMMPS", "ratio")]
    for r in store.load(HERE / "results/lammps.csv"):
        lines.append(table.row(f"{r['dimensions']}D", r["grains"], f"{r['barchan'] / 1e6:.1f}", f"{r['lammps'] / 1e6:.1f}",
                               f"{r['ratio']:.2f} ({min(r['ratios']):.2f} to {max(r['ratios']):.2f})"))
    return {"beds": "\n".join(lines)}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda p: str(pathlib.Path(p).resolve()))
    parser.add_argument("--lammps", default="lmp")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--grains", type=int, default=100000)
    parser.add_argument("--steps", type=int, default=1000)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as scratch:
        for dim in (2, 3):
            r = measure(options.program, options.lammps, dim, options.grains, options.steps, options.rounds, pathlib.Path(scratch))
            results.append(r)
            print(f"{dim}D, {r['grains']} grains: Barchan {r['barchan'] / 1e6:.2f}, LAMMPS {r['lammps'] / 1e6:.2f} M grain-steps/s (skin {r['skin']} d), "
                  f"ratio {r['ratio']:.2f} ({min(r['ratios']):.2f} to {max(r['ratios']):.2f})", flush=True)
    if options.write:
        store.keep(HERE / "results/lammps.csv", results)
