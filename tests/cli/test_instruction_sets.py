"""The program on every instruction set that it and the machine have: the choice, what is refused, the same figures, the
same bits on any number of threads. And its machine code: instructions of AVX-512 stand nowhere but in the functions that
are called only where the machine has them.

    test_instruction_sets.py BARCHAN SOURCE_DIR
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

program, source = sys.argv[1], pathlib.Path(sys.argv[2])
NAMES = {"avx2": "AVX2", "avx512": "AVX-512"}
# Scene, what shortens it, and how far the figures of two instruction sets may be apart, relative to the field's largest
# value: turbulent air over grains in mixed precision, 100 steps (found: 8e-8); water in three dimensions with a free
# surface, 16 steps (found: 8e-8, of sums in single precision too).
SCENES = [("scenes/paper/dune.toml", ["time.end=3e-5", "output.every=3e-5"], 1e-5),
          ("scenes/verification/dam_break_3d.toml", ["time.end=0.002", "output.every=0.002"], 1e-5)]
failures = []


def check(good, what):
    print("ok    " if good else "FAILED", what)
    if not good:
        failures.append(what)


def barchan(*arguments, **environment):
    return subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, env={**os.environ, **environment})


def older(*features):
    """The environment in which glibc says that the machine lacks these."""
    return {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join("-" + f for f in features)}


def choice(sets, dispatches, folder):
    scene = source / SCENES[0][0]
    said = barchan("run", scene, "--out", folder / "none", "--instructions", "mmx")
    check(said.returncode == 2 and "mmx" in said.stderr and "expected" in said.stderr, "an unknown name is refused")
    check(not (folder / "none").exists(), "and nothing is written")
    if not dispatches:
        return
    for name in sets:
        said = barchan("--version", BARCHAN_INSTRUCTIONS=name)
        check(f"instruction set: {NAMES[name]} (" in said.stdout, f"--version says {NAMES[name]} when {name} is chosen")
    said = barchan("--version", BARCHAN_INSTRUCTIONS="mmx")
    check(said.returncode == 2 and "BARCHAN_INSTRUCTIONS" in said.stderr, "an unknown name in the environment is refused")
    said = barchan("--version", **older("AVX2"))
    check(said.returncode == 2 and "does not have AVX2" in said.stderr, "a machine without AVX2 gets a message and status 2")
    said = barchan("--version", **older("AVX512F"))
    check("instruction set: AVX2 (of avx2)" in said.stdout, "a machine without AVX-512 runs AVX2")
    said = barchan("run", scene, "--out", folder / "none", "--instructions", "avx512", **older("AVX512F"))
    check(said.returncode == 2 and "does not have AVX512F" in said.stderr, "avx512 is refused where the machine lacks it")


def figures(sets, folder):
    for scene, shortened, tolerance in SCENES:
        name = pathlib.Path(scene).stem
        series = {}
        for which in sets:
            for threads in (1, 2):
                out = folder / name / f"{which}-{threads}"
                settings = [x for s in shortened for x in ("--set", s)]
                ended = barchan("run", source / scene, "--quiet", "--threads", threads, "--out", out, "--instructions", which, *settings)
                check(ended.returncode == 0, f"{name} on {which}, {threads} threads: {ended.stderr.strip() or 'ran'}")
                if ended.returncode:
                    return
                series[which, threads] = out / f"{name}.pvd"
                says = json.loads((out / "run.json").read_text())["instruction_set"].split(" (")[0]
                check(says == NAMES.get(which, says), f"{name}: run.json says {says}")
            same = barchan("compare", series[which, 1], series[which, 2])
            check(same.returncode == 0, f"{name} on {which}: the same bits on 1 and 2 threads")
        if len(sets) == 2:
            near = barchan("compare", *(series[which, 1] for which in sets), "--tolerance", tolerance)
            check(near.returncode == 0, f"{name}: both sets within {tolerance:g}" + ("" if near.returncode == 0 else "\n" + near.stdout))
            same = barchan("compare", *(series[which, 1] for which in sets))
            check(same.returncode == 1, f"{name}: two sets, and not one of them twice (their last bits differ)")


def machine_code():
    """Functions with instructions of AVX-512 (prefix EVEX, or a mask register) must have avx512 in their name."""
    listing = subprocess.Popen(["objdump", "-d", "-C", "--insn-width=15", program], stdout=subprocess.PIPE, text=True)
    wide = re.compile(r"\t(?:(?:26|2e|36|3e|64|65|66|67) )*62 |%k[0-7]\b")
    vex = re.compile(r"\t(?:(?:26|2e|36|3e|64|65|66|67) )*(?:62|c4|c5) ")
    head = re.compile(r"^[0-9a-f]+ <(.*)>:$")
    name, inside, outside, first = "", set(), {}, {}
    for line in listing.stdout:
        if found := head.match(line):
            name = found[1]
            if re.search(r"^barchan::\(anonymous namespace\)::(look_at_the_machine|missing_of_\w+|refuse)\(", name):
                first.setdefault(name, 0)
        elif wide.search(line):
            if "avx512" in name:
                inside.add(name)
            else:
                outside.setdefault(name, line.split("\t")[-1].strip())
        if name in first and vex.search(line):
            first[name] += 1
    check(listing.wait() == 0, "objdump read the program")
    check(len(inside) > 20, f"{len(inside)} functions of the hot files have instructions of AVX-512")
    check(not outside, "no other function has" + "".join(f"\n         {i} in {f}" for f, i in outside.items()))
    check(bool(first) and not any(first.values()), f"what looks at the machine first runs on any x86-64: {first}")


said = barchan("--version").stdout
dispatches = "(of " in said
sets = re.search(r"instruction set: .*\(of (.*)\)", said)[1].split(", ") if dispatches else \
    [{name: key for key, name in NAMES.items()}.get(re.search(r"instruction set: (\S+)", said)[1], "sse2")]
with tempfile.TemporaryDirectory(prefix="barchan-instructions-") as folder:
    choice(sets, dispatches, pathlib.Path(folder))
    figures(sets, pathlib.Path(folder))
if dispatches and shutil.which("objdump"):
    machine_code()
sys.exit(1 if failures else 0)
