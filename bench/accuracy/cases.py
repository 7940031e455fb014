#!/usr/bin/python3
"""Air against exact, converged and measured solutions: one function a case, one line a figure.

    /usr/bin/python3 bench/accuracy/cases.py build/barchan [all | CASE ...] [--write] [--largest N] [--set KEY=VALUE ...]

Runs each case (all of them without a name; --list names them) on one thread with disturbed particles, and prints case, scheme,
number of spacings, what was measured, its bound, the user CPU seconds and the particle-steps a user CPU second. Exits with 1 when a
figure misses its bound.

With --write the figures go to bench/accuracy/results/CASE.csv; the case cost draws docs/gallery/accuracy.png. --runs DIR keeps the runs in DIR and takes those that
are there already. A new case is one more line in CASES of the file that its topic has (cases_*.py).
"""

import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import cases_dams
import cases_fsi
import cases_grains
import cases_motion
import cases_open
import cases_periodic
import cases_surface
import cases_walls
import cases_waves
import cases_wind
from barchan_bench.store import keep
from barchan_bench.table import HEAD
from harness import RESULTS, options, rows
from page import figures, plot, processor

CASES = {}  # name: (function, heading of its table)
for topic in (cases_periodic, cases_walls, cases_surface, cases_grains, cases_wind, cases_open, cases_motion, cases_waves, cases_dams, cases_fsi):
    CASES.update(topic.CASES)


def tables():
    """That of docs/accuracy.md."""
    return {"figures": figures(CASES)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("cases", nargs="*", metavar="CASE")
    parser.add_argument("--largest", type=int, default=200)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--runs", metavar="DIR")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--write", action="store_true")
    parser.parse_args(namespace=options)
    if options.list:
        print("\n".join(CASES))
        return 0
    names = list(CASES) if not options.cases or "all" in options.cases else options.cases
    unknown = [name for name in names if name not in CASES]
    if unknown or not options.program:
        parser.error(f"no case {', '.join(unknown)}; cases are {', '.join(CASES)}" if unknown else "which program?")
    good = True
    print(HEAD)
    for name in names:
        rows.clear()
        CASES[name][0]()
        good = good and all(r["good"] for r in rows)
        if options.write:
            keep(RESULTS / f"{name}.csv", {"processor": processor(), "rows": rows})
            if name == "cost":
                plot(rows, processor())
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
