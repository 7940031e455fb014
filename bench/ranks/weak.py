#!/usr/bin/python3
"""Weak scaling from counters: the same work a rank on 1 to 16 ranks. The table "Work a rank" of docs/ranks.md.

    /usr/bin/python3 bench/ranks/weak.py PROGRAM [--only NAME]... [--ranks 1 2 4 8 16] [--write]

Periodic air grows with the ranks, so that each has the same number of particles. More ranks than cores take turns: their times say nothing, so this counts
what a rank has to do. From run.json of a run and of a shorter one, whose difference leaves the start out: messages and bytes that a rank sends in a step,
ghosts a rank, and the particles of the largest rank over the mean. The time of two ranks is in bench/ranks/speed.py. With --write the results go to bench/ranks/results/weak.csv.
"""

import argparse
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run, store, table  # noqa: E402
from speed import air  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/weak.csv"
CASES = {"air 2D, 4e4 a rank": (2, 200), "air 3D, 2.7e4 a rank": (3, 30)}  # dimensions, particles along an edge of the part of a rank
STEPS = 60, 20  # about, of a run and of the one that is taken off it
COURANT = .12   # of a step: times of the sound (10 m/s) over a spacing, about
MANY = ["mpirun", "--allow-run-as-root", "--bind-to", "none", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n"]


def report(program, text, ranks, folder):
    sets = ["output.history-every=1"]
    return run.scene(program, text, folder, sets, before=[*MANY, ranks], options=["--retreats", "0"]).report


def measured(program, name, ranks):
    dimensions, across = CASES[name]
    long, short = (air(dimensions, across, COURANT * steps / (10 * across) * 2.1, wide=ranks) for steps in STEPS)
    with tempfile.TemporaryDirectory() as folder:
        late, early = (report(program, text, ranks, pathlib.Path(folder) / which) for text, which in ((long, "late"), (short, "early")))
        steps = late["steps"] - early["steps"]
        of = late.get("ranks")
        result = {"particles": sum(late["particles"].values()), "steps": steps, "pairs": sum(late["pairs"].values()) / ranks}
        if not of:
            return result
    result |= {"largest": of["most_particles"] * ranks / result["particles"], "ghosts": of["ghosts"] / ranks}
    for what in ("messages", "bytes"):
        result[what] = (of[what] - early["ranks"][what]) / steps / ranks
    return result


def text(results):
    """The table of the page."""
    lines = [table.head("case", "ranks", "particles, steps", "million pairs a rank", "largest rank over the mean", "ghosts a rank", "messages a step a rank", "MB a step a rank")]
    for name in CASES:
        for ranks, r in results.get(name, {}).items():
            shared = "messages" in r
            lines.append(table.row(name, ranks, f"{r['particles']}, {r['steps']}", f"{r['pairs'] / 1e6:.3f}", *(
                [f"{r['largest']:.3f}", f"{r['ghosts']:.0f}", f"{r['messages']:.1f}", f"{r['bytes'] / 1e6:.3f}"] if shared else ["", "0", "0", "0"])))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"weak": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", action="append", choices=list(CASES))
    parser.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8, 16])
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    program = options.program.resolve()
    results = store.load(RESULTS, {})
    for name in options.only or CASES:
        for ranks in options.ranks:
            results.setdefault(name, {})[str(ranks)] = measured(program, name, ranks)
            print(name, ranks, results[name][str(ranks)], flush=True)
    print(text(results))
    if options.write:
        store.keep(RESULTS, results)


if __name__ == "__main__":
    main()
