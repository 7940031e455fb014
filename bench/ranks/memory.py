#!/usr/bin/python3
"""The peak memory of ranks: no rank holds arrays of all particles of a fluid. The table "Memory of ranks" of docs/ranks.md.

    /usr/bin/python3 bench/ranks/memory.py PROGRAM [--only NAME]... [--write]

Periodic air of the consistent scheme makes a few steps on several ranks, without states to go back to. run.json tells the most that the first rank and
the others have held at any time. `barchan plan --ranks` says before what it will be; the largest case is too large to be planned in one process.
With --write the results go to bench/ranks/results/memory.csv.
"""

import argparse
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page as pages, run, store, table  # noqa: E402
from speed import air  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/memory.csv"
STEPS = .15  # of a step of the sound over a spacing each: some five steps
PLANNED = 2e6  # particles, at most, of a case that is planned in one process
# name: dimensions, particles along an edge, ranks
CASES = {f"{name}, {ranks} ranks": (dimensions, across, ranks)
         for name, dimensions, across, many in (("2e5", 2, 447, (2, 3, 4)), ("2e6", 2, 1414, (2, 4)), ("1e6 in 3D", 3, 100, (2, 4)), ("2e7", 2, 4472, (4,)))
         for ranks in many}


def measured(program, name):
    dimensions, across, ranks = CASES[name]
    text = air(dimensions, across, STEPS / across)
    before = ["mpirun", "--allow-run-as-root", "--bind-to", "none", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", ranks]
    planned = None
    with tempfile.TemporaryDirectory() as folder:
        scene = run.scene_file(text, pathlib.Path(folder))
        ended = run.scene(program, scene, pathlib.Path(folder) / "out", before=before, options=["--retreats", "0"])
        if across**dimensions <= PLANNED:
            told = json.loads(run.command([program, "plan", scene, "--json", "--threads", "1", "--ranks", ranks], check=True).stdout)
            states = dict(told["memory"]["parts"]).get("states to go back to", 0.)
            planned = max(rank["memory"] for rank in told["ranks"]["of"][1:]) - states / ranks
    of = ended.report["ranks"]
    return {"particles": across**dimensions, "ranks": ranks, "steps": ended.report["steps"], "first": of["memory_of_first"],
            "others": of["most_memory_of_others"], "most_particles": of["most_particles"], "planned": planned, "processor": pages.processor()}


def text(results):
    """The table of the page."""
    lines = [table.head("particles, ranks", "particles of the largest", "the most of a rank but the first: GB", "bytes a particle of it", "over that of plan --ranks", "the first: GB")]
    for r in results.values():
        lines.append(table.row(f"{r['particles']}, {r['ranks']}", r["most_particles"], f"{r['others'] / 1e9:.3f}", f"{r['others'] / r['most_particles']:.0f}",
                               f"{r['others'] / r['planned']:.3f}" if r["planned"] else "", f"{r['first'] / 1e9:.3f}"))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"memory": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", action="append", choices=list(CASES))
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    results = store.load(RESULTS, {})
    for name in options.only or CASES:
        results[name] = measured(options.program.resolve(), name)
        print(name, json.dumps(results[name]), flush=True)
    results = {name: results[name] for name in CASES if name in results}
    print(text(results))
    if options.write:
        store.keep(RESULTS, results)


if __name__ == "__main__":
    main()
