#!/usr/bin/python3
"""The speed of ranks beside that of threads, in one session: the table "What was measured" of docs/ranks.md.

    /usr/bin/python3 bench/ranks/speed.py PROGRAM [--only NAME]... [--rounds 5] [--write]

Every case runs by turns: two ranks of one thread, one process of two threads; one rank, one process of one thread (the cost of MPI); and, for weak
scaling, one process with half of the particles. Every second round goes the other way round. Runs are so long that the frame of the start, which is written
beside the first steps, is a small part of them. Particle-steps a second are those of run.json. Prints the median of the ratios of neighbouring runs, with
their range. Of weak scaling, two processes with half of the particles run side by side besides: what the machine gives to two programs that do not know of
each other. All runs of a case must write the same checkpoint. With --write the results go to bench/ranks/results/speed.csv.
"""

import argparse
import concurrent.futures
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, checkpoints, page as pages, run, store, table  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/speed.csv"
AIR = """dimensions = {dimensions}
spacing = {spacing!r}
[domain]
size = {size}
periodic = {axes}
[phases.air]
kind = "fluid"
density = 1
viscosity = 1e-3
sound-speed = 10
scheme = "consistent"
[interactions]
kernel = "wendland-c2"
air-air = 2.1
[[fill]]
phase = "air"
shape = "the-rest"
perturb = 0.2
velocity = ["-cos(2*pi*x)*sin({wave}*pi*y)", "{along}*sin(2*pi*x)*cos({wave}*pi*y)"{third}]
[time]
end = {end!r}
largest-speed = 1
[output]
every = 1
"""

GRAINS = """dimensions = 3
spacing = 1e-3
[domain]
size = [0.08, {high!r}, 0.08]
periodic = ["x", "z"]
gravity = [0, -9.81, 0]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
restitution = 0.7
friction = 0.5
rolling-friction = 0.1
stiffness = 300
[phases.floor]
kind = "wall"
[interactions]
sand-sand = {{ law = "linear" }}
sand-floor = {{ law = "linear" }}
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"] }}
[[fill]]
phase = "sand"
shape = {{ box = {{ min = [0, 0, 0], max = [0.08, {high!r}, 0.08] }} }}
velocity = ["0.1*sin(3e3*y + 700*z)", "0.1*sin(2e3*x + 900*z)", "0.1*sin(4e3*x + 800*y)"]
[time]
end = {end!r}
largest-speed = 1
[output]
every = 1
"""


def air(dimensions, across, end, wide=1):
    """Periodic air; `wide`: how many times as long as it is high, of `across` particles. Waves of half of a square are half as long."""
    along = wide if dimensions == 2 and wide < 1 else 1
    size, axes = ([1, wide], ["x", "y"]) if dimensions == 2 else ([1, 1, wide], ["x", "y", "z"])
    return AIR.format(dimensions=dimensions, spacing=1 / across, size=size, axes=str(axes).replace("'", '"'), third=", 0" if dimensions == 3 else "",
                      wave=2 / along, along=along, end=end)


# name: scene, overrides; the same with half of the particles, or none
CASES = {
    "air 2D, 1e6": (air(2, 1000, .012), [], air(2, 1000, .012, .5)),
    "air 3D, 1e6": (air(3, 100, .08), [], air(3, 100, .08, .5)),
    "dam break 2D, 9.4e4": ("dam_break", ["spacing=5e-4", "time.end=0.01", "output.every=1"], None),
    "grains 3D, 5e5": (GRAINS.format(high=.08, end=.006), [], GRAINS.format(high=.04, end=.006)),
    "dune": ("dune", ["time.end=0.05", "output.every=1"], None),
}


def on_ranks(ranks, threads, program, scene, sets, out):
    before = ["mpirun", "--allow-run-as-root", "--bind-to", "none", "-n", ranks] if ranks else []
    return run.scene(program, scene, out, sets, threads=threads, before=before)


def rate(ended):
    return ended.report["particle_steps_per_second"]


def side_by_side(program, scene, sets, folder):
    """Particle-steps a second of two processes of one thread that run at the same time."""
    with concurrent.futures.ThreadPoolExecutor(2) as both:
        return sum(both.map(lambda number: rate(on_ranks(0, 1, program, scene, sets, folder / f"half{number}")), (0, 1)))


def measured(program, name, rounds):
    scene, sets, half = CASES[name]
    kinds = {"ranks": (2, 1), "threads": (0, 2), "one rank": (1, 1), "one process": (0, 1)}
    rates, kept, result = {kind: [] for kind in [*kinds, *(["half", "two halves"] if half else [])]}, {}, {}
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        for number in range(rounds):
            for kind, (ranks, threads) in list(kinds.items())[::-1 if number % 2 else 1]:
                ended = on_ranks(ranks, threads, program, scene, sets, scratch / f"{kind}{number}")
                rates[kind].append(rate(ended))
                if number == 0:
                    kept[kind] = checkpoints.whole(next(ended.out.glob("*.checkpoint")))
                if kind == "ranks":
                    result.update(steps=ended.report["steps"], particles=sum(ended.report["particles"].values()), of_ranks=ended.report["ranks"])
            if half:
                rates["half"].append(rate(on_ranks(0, 1, program, half, sets, scratch / f"half{number}")))
                rates["two halves"].append(side_by_side(program, half, sets, scratch / f"halves{number}"))
            print(name, number, {kind: f"{values[-1] / 1e6:.3f}" for kind, values in rates.items()}, flush=True)
        if len(set(kept.values())) != 1:
            raise RuntimeError(f"{name}: ranks, threads and one process have other bits")
    result["rates"] = {kind: statistics.median(values) for kind, values in rates.items()}
    pairs = {"kept": ("ranks", "threads"), "with MPI": ("one rank", "one process")}
    pairs |= {"weak": ("ranks", "half"), "side by side": ("two halves", "half")} if half else {}
    for figure, (over, under) in pairs.items():
        of = sorted(a / b for a, b in zip(rates[over], rates[under]))
        result[figure] = [statistics.median(of), of[0], of[-1]]
    for figure in ("weak", "side by side"):
        result[figure] = [x / 2 for x in result[figure]] if half else None
    return result


def text(results):
    """The table of the page."""
    def figure(value, bound):
        if not value:
            return ""
        return f"{value[0]:.3f} ({value[1]:.3f} to {value[2]:.3f})" + ("" if value[0] >= bound else ", **not met**")
    lines = [table.head("case", "particles, steps", "2 ranks, 2 threads: million particle-steps a second", "2 ranks over 2 threads, >= 0.95",
                        "1 rank over 1 process, >= 0.99", "weak: 2 ranks over 2 times half of it, >= 0.93", "two processes of half side by side, the same",
                        "messages; MB a step of all ranks")]
    for name, r in results.items():
        lines.append(table.row(name, f"{r['particles']}, {r['steps']}", f"{r['rates']['ranks'] / 1e6:.2f}, {r['rates']['threads'] / 1e6:.2f}",
                               figure(r["kept"], .95), figure(r["with MPI"], .99), figure(r["weak"], .93),
                               figure(r.get("side by side"), 0),
                               f"{r['of_ranks']['messages'] / r['steps']:.1f}; {r['of_ranks']['bytes'] / r['steps'] / 1e6:.2f}"))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"speed": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", action="append", choices=list(CASES))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    results = store.load(RESULTS, {})
    for name in options.only or CASES:
        results[name] = measured(options.program.resolve(), name, options.rounds) | {"rounds": options.rounds, "processor": pages.processor()}
    results = {name: results[name] for name in CASES if name in results}
    print(text(results))
    if options.write:
        store.keep(RESULTS, results)


if __name__ == "__main__":
    main()
