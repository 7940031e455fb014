#!/usr/bin/python3
"""Instructions a pair of the pair loops, built for x86-64-v3 and counted by callgrind: a guard that does not time.

    test_instructions.py PAIR_LOOPS [--write]

Fails when a loop takes over a tenth more, or less, than tests/instructions/expected.json says. Less is good news: then
--write notes the new figures.
"""
import json
import os
import pathlib
import re
import subprocess
import sys

EXPECTED = pathlib.Path(__file__).resolve().parent / "expected.json"
CASES = {**{f"{scheme}{dimensions}-{precision}": "barchan::*fluid_rates*"
            for scheme in ("plain", "consistent") for dimensions in ("2d", "3d") for precision in ("double", "mixed")},
         "strain2d": "barchan::*elastic_strain*", "forces2d": "barchan::*elastic_forces*",
         "lists2d": "barchan::Neighbours::update*", "lists3d": "barchan::Neighbours::update*"}
TOLERANCE = 0.10


def count(program, case, function):
    run = subprocess.run(["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", f"--toggle-collect={function}", program, case],
                         capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or not found or int(found[1]) == 0:
        sys.exit(f"{case}: nothing counted\n{run.stderr}")
    return int(found[1]) / int(run.stdout)


def main():
    if not os.path.exists(sys.argv[1]):
        print("not built: cmake --build --preset default --target long_programs")
        return 77  # ctest: skipped
    measured = {case: round(count(sys.argv[1], case, function), 2) for case, function in CASES.items()}
    if "--write" in sys.argv:
        EXPECTED.write_text(json.dumps(measured, indent=2) + "\n")
        return 0
    expected = json.loads(EXPECTED.read_text())
    failed = expected.keys() != measured.keys()
    for case, value in measured.items():
        ratio = value / expected.get(case, float("nan"))
        bad = not abs(ratio - 1) <= TOLERANCE
        failed |= bad
        print(f"{case:22} {value:7.2f} instructions a pair, {ratio:.2f} of the committed figure{'  <-- FAILED' if bad else ''}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
