#!/usr/bin/python3
"""What MPI costs where there is one rank: instructions of `mpirun -n 1` beside those of the program alone. A table of docs/ranks.md.

    /usr/bin/python3 bench/ranks/one_rank.py PROGRAM [--write]

valgrind (callgrind) counts the instructions of the whole process, which noise does not change; it knows AVX2 and not AVX-512, so the program runs with
BARCHAN_INSTRUCTIONS=avx2. Both runs must write the same bytes. With --write the results go to bench/ranks/results/one_rank.csv.
"""

import argparse
import pathlib
import re
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, checkpoints, run, store, table  # noqa: E402
from speed import GRAINS, air  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/one_rank.csv"
# name: scene, overrides
CASES = {
    "air 2D": (air(2, 100, .06), []),
    "air 3D": (air(3, 25, .08), []),
    "grains 3D": (GRAINS.format(high=.005, end=.002), []),
    "dune": ("dune", ["time.end=0.0004", "output.every=1"]),
}


def counted(program, scene, sets, before, folder):
    """Instructions of a run, its steps and particles, and the bytes of its checkpoint."""
    log = folder / "callgrind.log"
    words = [*before, "valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--log-file={log}"]
    ended = run.scene(program, scene, folder / "run", sets, before=words, environment={"BARCHAN_INSTRUCTIONS": "avx2", "OMP_NUM_THREADS": "1"})
    instructions = int(re.search(r"Collected : (\d+)", log.read_text())[1])
    return instructions, ended.report["steps"], sum(ended.report["particles"].values()), checkpoints.whole(next(ended.out.glob("*.checkpoint")))


def measured(program, name):
    scene, sets = CASES[name]
    with tempfile.TemporaryDirectory() as folder:
        results = {}
        for kind, before in (("alone", []), ("one rank", ["mpirun", "--allow-run-as-root", "-n", "1"])):
            place = pathlib.Path(folder) / kind.replace(" ", "_")
            place.mkdir()
            results[kind] = counted(program, scene, sets, before, place)
    if results["alone"][1:] != results["one rank"][1:]:
        raise RuntimeError(f"{name}: one rank has other bits than the program alone")
    return {"particles": results["alone"][2], "steps": results["alone"][1], **{kind: result[0] for kind, result in results.items()}}


def text(results):
    lines = [table.head("case", "particles, steps", "million instructions: alone, one rank", "one rank over alone, <= 1.01")]
    for name, r in results.items():
        lines.append(table.row(name, f"{r['particles']}, {r['steps']}", f"{r['alone'] / 1e6:.1f}, {r['one rank'] / 1e6:.1f}",
                               f"{r['one rank'] / r['alone']:.4f}"))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"one rank": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    results = {}
    for name in CASES:
        results[name] = measured(options.program.resolve(), name)
        print(name, results[name], flush=True)
    print(text(results))
    if options.write:
        store.keep(RESULTS, results)


if __name__ == "__main__":
    main()
