#!/usr/bin/env python3
"""Runs of two threads and of two ranks beside processes that only compute, as many as there are cores, compared with one thread beside them.

    bench/robustness/busy.py build/barchan [--runs 20] [--particles 500,1500,10000,100000] [--load 2] [--seconds 1]

A dam of about so many particles, long enough for some seconds on one free core. The three commands run in turn. Prints for each the median and the worst wall time
over the median of one thread; bound 2 (of the worst; ranks with the 0.5 s in which mpirun starts and ends taken off). `--load 0`: a free machine.
"""

import argparse
import math
import pathlib
import signal
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import run as runs, table  # noqa: E402

BOUND = 2.0
DAM = """dimensions = 2
spacing = {spacing!r}
[domain]
size = [1.6, 1]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
[phases.wall]
kind = "wall"
[interactions]
water-water = 2.1
water-wall = 2.1
[[fill]]
phase = "wall"
shape = {{ sides = ["bottom", "left", "right"] }}
[[fill]]
phase = "water"
shape = {{ box = {{ min = [0, 0], max = [0.8, 0.75] }} }}
[time]
end = {end!r}
largest-speed = 4
[output]
every = {end!r}
"""
MPI = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"]
WAYS = {"one thread": (1, []), "two threads": (2, []), "two ranks": (1, MPI)}


def measured(program, particles, load, rounds, seconds):
    spacing = math.sqrt(0.6 / particles)
    steps = max(20, round(seconds * 6e6 / particles))
    scene = DAM.format(spacing=spacing, end=steps * 0.4 * 1.05 * spacing / 44)
    walls = {way: [] for way in WAYS}
    with tempfile.TemporaryDirectory() as scratch:
        burners = [runs.start(["sh", "-c", "while :; do :; done"]) for _ in range(load)]
        try:
            for _ in range(rounds):
                for way, (threads, before) in WAYS.items():
                    out = pathlib.Path(scratch) / way.replace(" ", "-")
                    walls[way].append(runs.scene(program, scene, out, threads=threads, before=before).wall - (0.5 if before else 0.0))
        finally:
            for burner in burners:
                burner.kill()
                burner.wait()
    return walls


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--particles", default="500,1500,10000,100000")
    parser.add_argument("--load", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=1.0)
    given = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # the busy processes end with this one
    for particles in map(int, given.particles.split(",")):
        walls = measured(given.program.resolve(), particles, given.load, given.runs, given.seconds)
        one = statistics.median(walls["one thread"])
        for way, times in walls.items():
            table.report("busy", way, particles, f"median {statistics.median(times):.2f} s; worst over the median of one thread", max(times) / one, BOUND, sum(times))
    return 0 if all(row["good"] for row in table.rows) else 1


if __name__ == "__main__":
    sys.exit(main())
