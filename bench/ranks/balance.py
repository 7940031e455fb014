#!/usr/bin/python3
"""How equal the work of ranks is: the table "How cells are divided" of docs/ranks.md.

    /usr/bin/python3 bench/ranks/balance.py PROGRAM [--only NAME]... [--ranks N]... [--write]

Every case runs on 2 and 3 ranks of one thread, with cells divided by the number of particles and by time. run.json tells how long each rank was busy in
all steps (processor time without waiting, so ranks may share cores), and what the divisions took of the run. Both runs must write the same
checkpoint. With --write the results go to bench/ranks/results/balance.csv.
"""

import argparse
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page as pages, run, store, table  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/balance.csv"
IMBALANCE, COST = 1.05, .02  # at most: the largest busy time over the mean; what divisions take of the run
# name: scene, overrides
CASES = {
    "dam break 3D": ("dam_break_3d", ["spacing=2.8575e-3", "time.end=0.08", "output.every=0.08"]),
    "dam break 2D": ("dam_break", ["spacing=7.14375e-4", "time.end=0.15", "output.every=0.15"]),
    "dune": ("dune", ["time.end=0.02", "output.every=0.02"]),
}


def measured(program, name, ranks):
    scene, sets = CASES[name]
    before = ["mpirun", "--allow-run-as-root", "--bind-to", "none", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", ranks]
    result, kept = {"case": name, "ranks": ranks, "processor": pages.processor()}, []
    for division in ("particles", "time"):
        with tempfile.TemporaryDirectory() as folder:
            ended = run.scene(program, scene, pathlib.Path(folder) / "out", sets, before=before, options=["--division", division])
            kept.append(next(ended.out.glob("*.checkpoint")).read_bytes())
        of = ended.report["ranks"]
        result["by " + division] = {"imbalance": of["imbalance"], "divisions": of["divisions"], "busy": of["busy_seconds"], "waiting": of["waiting_seconds"],
                            "cost": of["dividing_seconds"] / ended.report["wall_seconds"]}
        result.update(steps=ended.report["steps"], particles=sum(ended.report["particles"].values()))
    if kept[0] != kept[1]:
        raise RuntimeError(f"{name}, {ranks} ranks: the two divisions have other bits")
    return result


def text(results):
    """The table of the page."""
    def missed(value, bound):
        return "" if value <= bound else ", **not met**"
    lines = [table.head("case", "particles, steps", "ranks", "imbalance by number of particles", f"by time, <= {IMBALANCE}", "divisions by time", f"their part of the run, <= {COST:.0%}")]
    for r in results.values():
        by_number, by_time = r["by particles"], r["by time"]
        lines.append(table.row(r["case"], f"{r['particles']}, {r['steps']}", r["ranks"], f"{by_number['imbalance']:.3f}",
                               f"{by_time['imbalance']:.3f}{missed(by_time['imbalance'], IMBALANCE)}", by_time["divisions"],
                               f"{by_time['cost']:.2%}{missed(by_time['cost'], COST)}"))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"balance": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", action="append", choices=list(CASES))
    parser.add_argument("--ranks", action="append", type=int)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    results = store.load(RESULTS, {})
    for name in options.only or CASES:
        for ranks in options.ranks or (2, 3):
            results[f"{name}, {ranks}"] = measured(options.program.resolve(), name, ranks)
            print(text({name: results[f"{name}, {ranks}"]}).splitlines()[-1], flush=True)
    print(text(results))
    if options.write:
        store.keep(RESULTS, results)


if __name__ == "__main__":
    main()
