#!/usr/bin/python3
"""What a checkpoint and a restart cost on ranks: the table "A checkpoint and a restart" of docs/ranks.md.

    /usr/bin/python3 bench/ranks/checkpoint.py PROGRAM [BEFORE] [--ranks 2] [--across 1000] [--rounds 5] [--write]

Periodic air of the consistent scheme, across * across particles, by turns with PROGRAM and with an older one BEFORE. Two runs of the same few steps, one
with a checkpoint after every step and one with a checkpoint at its end only: their difference in wall time is that of their checkpoints. Two runs of one
step, one from the beginning and one from a checkpoint: a restart makes the start too, and the difference is the reading. Prints medians in seconds. With
--write the results go to bench/ranks/results/checkpoint.csv.
"""

import argparse
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, page as pages, run, store, table  # noqa: E402
from speed import air  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/checkpoint.csv"


class Case:
    def __init__(self, program, ranks, across, top):
        self.program, self.across, self.out = program, across, top / "out"
        self.before = ["mpirun", "--allow-run-as-root", "--bind-to", "none", "--oversubscribe", "-n", ranks]

    def run(self, steps, every, *options):
        sets = [f"time.end={.045 / self.across * steps!r}", f"output.checkpoint-every={every}", "output.every=1"]
        return run.scene(self.program, air(2, self.across, 1), self.out, sets, before=self.before, options=["--retreats", "0", *options])

    def measured(self):
        steps = 8
        often, seldom = self.run(steps, 1e-9), self.run(steps, 0)
        more = often.report["steps"]  # one after every step, and one of the end, which the other has too
        start = self.run(1, 0)
        again = self.run(2, 0, "--restart", "latest")
        return {"checkpoint": (often.wall - seldom.wall) / more, "start": start.wall, "restart": again.wall}


def text(result):
    lines = [table.head("", "a checkpoint, s", "a run of few steps from the beginning, s", "the same from a checkpoint, s")]
    for name, of in result["of"].items():
        lines.append(table.row(name, *(f"{of[figure]:.2f}" for figure in ("checkpoint", "start", "restart"))))
    return "\n".join(lines) + f"\n\n{result['particles']} particles on {result['ranks']} ranks, medians of {result['rounds']} rounds."


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"checkpoint": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("older", type=pathlib.Path, nargs="?")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--across", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    programs = {"through the first rank (before)": options.older, "in pieces": options.program}
    found = {name: [] for name, program in programs.items() if program}
    for number in range(options.rounds):
        for name in found:
            with tempfile.TemporaryDirectory() as folder:
                found[name].append(Case(programs[name].resolve(), options.ranks, options.across, pathlib.Path(folder)).measured())
                print(number, name, found[name][-1], flush=True)
    medians = {name: {figure: statistics.median(one[figure] for one in rounds) for figure in rounds[0]} for name, rounds in found.items()}
    result = {"particles": options.across**2, "ranks": options.ranks, "rounds": options.rounds, "of": medians, "processor": pages.processor()}
    print(text(result))
    if options.write:
        store.keep(RESULTS, result)


if __name__ == "__main__":
    main()
