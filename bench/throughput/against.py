#!/usr/bin/env python3
"""User CPU time and error of periodic air, beside another commit of Barchan, run in turn.

    bench/throughput/against.py COMMIT [--rounds N] [--cases NAME,...] [--build DIR] [--instructions avx2|avx512]
    bench/throughput/against.py --program OTHER [...]     a program that is built already, instead of COMMIT

Builds COMMIT in a work tree of its own under DIR (default: a temporary folder, removed at the end), with the default preset, and runs every case
with one thread by turns: other, this, other, this, ... Prints the median of the ratios this/other of the user CPU time of neighbouring runs with
their range, and the ratio of the errors against the exact solution. Ratios of times that were measured in one run can be trusted on a busy machine,
times cannot. `this` is build/barchan. Exit status 1 when a median is above --bound (default: none is asked).
"""

import argparse
import math
import pathlib
import shutil
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, run as runs  # noqa: E402

SCENE = """dimensions = {dimensions}
precision = "{precision}"
spacing = {spacing!r}
[domain]
size = {size}
periodic = {axes}
[phases.fluid]
kind = "fluid"
density = 1
viscosity = {viscosity!r}
sound-speed = {sound!r}
scheme = "{scheme}"
[interactions]
kernel = "wendland-c2"
fluid-fluid = {radius}
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = 0.2
velocity = {velocity}
pressure = {pressure}
[time]
end = {end!r}
largest-speed = 1
[output]
every = {end!r}
"""

TAYLOR_GREEN = dict(velocity='["-cos(2*pi*x)*sin(2*pi*y)", "sin(2*pi*x)*cos(2*pi*y)"]',
                    pressure='"-0.25*(cos(4*pi*x) + cos(4*pi*y))"', size="[1, 1]", axes='["x", "y"]', dimensions=2, sound=10.0)
R = "sqrt((x-0.5)^2+(y-0.5)^2)"
TURN = f"({R} < 0.2 ? 5 : ({R} < 0.4 ? 2/{R} - 5 : 0))"
GRESHO = dict(velocity=f'["-(y-0.5)*{TURN}", "(x-0.5)*{TURN}"]',
              pressure=f'"12.5*{R}^2*({R} < 0.4 ? 1 : 0) + ({R} < 0.2 ? 2 - 4*ln(2) : ({R} < 0.4 ? 6 - 4*ln(2) - 20*{R} + 4*ln(5*{R}) : 0))"',
              size="[1, 1]", axes='["x", "y"]', dimensions=2, viscosity=0.0)


def exact_taylor_green(x, t, viscosity):
    import numpy
    decay = math.exp(-8 * math.pi**2 * viscosity * t)
    a, b = 2 * math.pi * x[:, 0], 2 * math.pi * x[:, 1]
    return decay * numpy.column_stack([-numpy.cos(a) * numpy.sin(b), numpy.sin(a) * numpy.cos(b)])


def exact_gresho(x, _time, _viscosity):
    import numpy
    d = x[:, :2] - .5
    r = numpy.maximum(numpy.hypot(d[:, 0], d[:, 1]), 1e-12)
    turn = numpy.where(r < .2, 5, numpy.where(r < .4, 2 / r - 5, 0))
    return numpy.column_stack([-d[:, 1] * turn, d[:, 0] * turn])


def taylor_green(n, scheme, precision, viscosity, end):
    return SCENE.format(**TAYLOR_GREEN, spacing=1 / n, viscosity=viscosity, scheme=scheme, precision=precision, radius=2.6 if scheme == "plain" else 2.1,
                        end=end), exact_taylor_green, viscosity


def gresho(n, precision, end):
    return SCENE.format(**GRESHO, spacing=1 / n, sound=10.0 * max(n, 50) / 50, scheme="consistent", precision=precision, radius=2.1,
                        end=end), exact_gresho, 0.0


CASES = {
    "taylor-green-plain": lambda: taylor_green(100, "plain", "double", .01, .25),
    "taylor-green-consistent": lambda: taylor_green(100, "consistent", "double", .01, .5),
    "taylor-green-mixed": lambda: taylor_green(100, "consistent", "mixed", .01, .5),
    "taylor-green-re10000": lambda: taylor_green(100, "consistent", "mixed", 1e-4, .5),
    "gresho": lambda: gresho(100, "double", .25),
    "gresho-mixed": lambda: gresho(100, "mixed", .25),
}


def build(commit, folder):
    """The program of a commit, built under `folder`."""
    tree = folder / "tree"
    if not tree.exists():
        runs.command(["git", "-C", ROOT, "worktree", "add", "--detach", tree, commit], check=True)
    runs.command(["cmake", "--preset", "default", "-DBARCHAN_TESTS=OFF"], folder=tree, check=True)
    runs.command(["ninja", "-C", "build", "barchan"], folder=tree, check=True)
    return tree / "build/barchan"


def run(program, case, options):
    """User CPU seconds, L1 of the velocity against the exact one, steps."""
    import numpy
    from barchan_bench.frame import Frame
    text, exact, viscosity = CASES[case]()
    with tempfile.TemporaryDirectory() as scratch:
        done = runs.scene(program, text, scratch, options=options, environment={"OMP_WAIT_POLICY": "passive"}, check=False)
        if done.status:
            raise SystemExit(f"against: {program} ended with status {done.status} in {case}: {done.stderr.strip()[:300]}")
        time, file = done.series()[-1]
        frame = Frame(file, time, "fluid")
        truth = exact(frame.x, time, viscosity)
        error = numpy.linalg.norm(frame["velocity"][:, :2] - truth, axis=1).sum() / numpy.linalg.norm(truth, axis=1).sum()
        return done.user, error, done.report.get("steps", 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", nargs="?", help="what to compare with")
    parser.add_argument("--program", type=pathlib.Path, help="a program that is built already, instead of a commit")
    parser.add_argument("--this", type=pathlib.Path, default=ROOT / "build/barchan")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--build", type=pathlib.Path)
    parser.add_argument("--instructions", choices=["avx2", "avx512"])
    parser.add_argument("--bound", type=float)
    given = parser.parse_args()
    cases = given.cases.split(",")
    unknown = [c for c in cases if c not in CASES]
    if unknown:
        parser.error(f"no case {', '.join(unknown)}; expected some of {', '.join(CASES)}")
    if (given.commit is None) == (given.program is None):
        parser.error("expected a commit, or --program; one of them")
    if given.rounds < 1:
        parser.error("--rounds: expected at least 1")
    options = ["--instructions", given.instructions] if given.instructions else []
    folder = given.build or (pathlib.Path(tempfile.mkdtemp()) if given.commit else None)
    worst = 0.0
    try:
        other = given.program or build(given.commit, folder)
        print("| case | steps | user CPU, this/other: median | least | largest | this, s | error, this/other |\n" + "| --- " * 7 + "|")
        for case in cases:
            pairs = [(run(other, case, options), run(given.this, case, options))
                     for _ in range(given.rounds)]
            ratios = sorted(b[0] / a[0] for a, b in pairs)
            worst = max(worst, statistics.median(ratios))
            a, b = pairs[0]
            steps = f"{b[2]}" if a[2] == b[2] else f"{b[2]}, other {a[2]}"
            print(f"| {case} | {steps} | {statistics.median(ratios):.3f} | {ratios[0]:.3f} | {ratios[-1]:.3f} | "
                  f"{statistics.median(b[0] for a, b in pairs):.2f} | {b[1] / a[1]:.4f} |", flush=True)
    finally:
        if given.commit:
            if not given.build:
                runs.command(["git", "-C", ROOT, "worktree", "remove", "--force", folder / "tree"])
                shutil.rmtree(folder, ignore_errors=True)
    return 1 if given.bound and worst > given.bound else 0


if __name__ == "__main__":
    sys.exit(main())
