#!/usr/bin/env python3
"""Wall time of runs with the default number of threads beside one thread, on a quiet machine and on a busy one.

    bench/throughput/busy.py [--program build/barchan] [--runs N] [--particles 500,1500,10000,100000] [--load 0,2] [--write]

Periodic air of about so many particles, long enough for some seconds on one thread (--seconds); `load`: as many processes that only compute, beside the run. Runs with
one thread and with the default number alternate. Prints the median of one thread, the median and the worst of the default over it, and how many steps
were taken with how many threads. With --write the figures go to bench/throughput/busy.csv.
"""

import argparse
import math
import os
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run as runs, store, table  # noqa: E402

RESULTS = ROOT / "bench/throughput/busy.csv"

SCENE = """dimensions = 2
spacing = {spacing!r}
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.fluid]
kind = "fluid"
density = 1
viscosity = 0.01
sound-speed = 10
[interactions]
fluid-fluid = 2.1
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = 0.2
velocity = ["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]
[time]
end = {end!r}
largest-speed = 1
[output]
every = {end!r}
"""


def run(program, scene, out, threads):
    """Wall seconds of a run, and its report."""
    done = runs.scene(program, scene, out, threads=threads, check=False)
    if done.status:
        sys.exit(f"busy: {done.stderr.strip()[:300]}")
    return done.wall, done.report


def cell(program, particles, load, runs, seconds):
    """One line of the table."""
    side = round(math.sqrt(particles))
    steps = max(20, round(seconds * 6e6 / side**2))
    with tempfile.TemporaryDirectory() as scratch:
        scene = pathlib.Path(scratch) / "case.toml"
        scene.write_text(SCENE.format(spacing=1 / side, end=steps * .4 * 1.05 / side / 11))
        burners = [runs.start([sys.executable, "-c", "while True: pass"]) for _ in range(load)]
        try:
            one, default, used = [], [], {}
            for _ in range(runs):
                one.append(run(program, scene, pathlib.Path(scratch) / "one", 1)[0])
                wall, report = run(program, scene, pathlib.Path(scratch) / "default", 0)
                default.append(wall)
                for use in report["threads_used"]:
                    used[use["threads"]] = used.get(use["threads"], 0) + use["steps"]
        finally:
            for burner in burners:
                burner.kill()
                burner.wait()
    middle = statistics.median(one)
    total = sum(used.values())
    return {"particles": side**2, "busy": load, "one": middle, "worst of one": max(one) / middle, "median": statistics.median(default) / middle,
            "worst": max(default) / middle, "threads": ", ".join(f"{n}: {100 * k / total:.0f} %" for n, k in sorted(used.items()))}


HEAD = table.head("particles", "busy processes beside it", "one thread, s (median)", "worst of one thread", "default: median over one thread",
                  "default: worst over one thread", "steps by threads")


def line(r):
    return table.row(r["particles"], r["busy"], *(f"{r[name]:.2f}" for name in ("one", "worst of one", "median", "worst")), r["threads"])


def tables():
    """That of docs/performance.md."""
    kept = store.load(RESULTS)
    return {"busy": "\n".join([HEAD, *map(line, kept["rows"]), "", f"{kept['runs']} runs each, {kept['cores']} cores; load of the machine in the minute before the "
                               f"end: {kept['load']}."])}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/barchan")
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--particles", default="500,1500,10000,100000")
    parser.add_argument("--load", default="0,2")
    parser.add_argument("--seconds", type=float, default=1.5)
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    rows = []
    print(HEAD, flush=True)
    for load in map(int, given.load.split(",")):
        for particles in map(int, given.particles.split(",")):
            rows.append(cell(given.program, particles, load, given.runs, given.seconds))
            print(line(rows[-1]), flush=True)
    if given.write:
        store.keep(RESULTS, {"runs": given.runs, "cores": os.cpu_count(), "load": round(os.getloadavg()[0], 1), "rows": rows})
    return 0


if __name__ == "__main__":
    sys.exit(main())
