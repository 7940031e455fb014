#!/usr/bin/python3
"""Runs the tests on wrong programs, one wrong text in each, and notes which test tells it from the right one.

    mutants.py [NAME ...] [--work DIR] [--survivors] [--again] [--quick] [--seconds N]

mutants.toml names the wrong texts. All of them are built into one program, in a copy of the sources: where the text T
stands, the copy has (barchan_mutant == NUMBER ? (WRONG) : (T)), and the environment variable BARCHAN_MUTANT chooses.
What cannot be written so is built on its own. The copy is built as the program is (preset default), so that a compiler
cache has what no mutant touches; what includes a wrong text is built with -O1. A mutant is killed by the first test that fails, ends by a signal or
takes longer than its bound. The right program (BARCHAN_MUTANT is 0) must pass a stage before mutants go through it.

NAME: mutants to run (default: all). Those that have a result are left out; --survivors: but not those that survived;
--again: none is. --quick: test_unit only; a mutant that passes it gets no result. --seconds: begins nothing new after so
many seconds; the next call goes on. Status 0: every mutant asked for has been killed; 1: one survives; 3: not done.
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import store  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TABLE = SOURCE / "bench/robustness/mutants.toml"
RESULTS = SOURCE / "bench/robustness/results/mutants.csv"
HEADER = """// Which mutant this process is; 0: none.
#pragma once
#include <cstdlib>
inline const int barchan_mutant = [] {
  const char* text = std::getenv("BARCHAN_MUTANT");
  return text ? std::atoi(text) : 0;
}();
"""
PROGRAMS = ["test_unit", "test_cli", "test_stress", "test_physics"]
# What runs in a few seconds of test_physics, as tests/CMakeLists.txt has it.
SHORT = "Allocations.*:*Steps.*:*Threads.*:Simulations.*:*Invariants.*:Integrator.*:*EveryScene.*:RunJson.*"
# Tests in Python that run the program; the others read sources and pages.
SCRIPTS = ["tests/cli/test_restart.py", "tests/cli/test_robust.py", "tests/cli/test_measuring.py"]
SHARDS = 6  # of the rest of test_physics


def mutants():
    table = tomllib.loads(TABLE.read_text())["mutant"]
    for number, mutant in enumerate(table, 1):
        mutant["number"] = number
        mutant.setdefault("form", "choice")
    return table


def mutated(text, mutant):
    """The text with the mutant in it; the place must be there once."""
    find, wrong = mutant["find"], mutant["replace"]
    if text.count(find) != 1:
        raise ValueError(f"{mutant['name']}: {mutant['file']} has its text {text.count(find)} times")
    here = f"barchan_mutant == {mutant['number']}"
    return text.replace(find, {"choice": f"({here} ? ({wrong}) : ({find}))",
                               "statement": f"if ({here}) {{ {wrong} }} else {{ {find} }}",
                               "build": wrong}[mutant["form"]])


def touched(files, wrong):
    """Of .cpp files of src those that include one of the wrong files, or are one."""
    includes = {f: [g for i in re.findall(r'#include "([^"]+)"', (SOURCE / f).read_text()) if (g := "src/" + i) in files]
                for f in files if f.startswith("src/") and f.endswith((".cpp", ".hpp"))}
    reached = set(wrong)
    while more := {f for f, of in includes.items() if f not in reached and reached.intersection(of)}:
        reached |= more
    return sorted(f for f in reached if f.endswith(".cpp") and not f.startswith("src/app/"))


def write(file, text):
    if not file.exists() or file.read_text() != text:
        file.write_text(text)


class Enough(Exception):
    """The time is over."""


class Copy:
    """The tree with the mutants, its build, and runs of its tests."""

    def __init__(self, work, seconds):
        self.tree, self.build, self.scratch = work / "tree", work / "tree/build", work / "scratch"
        self.until = time.monotonic() + seconds
        self.made = set()
        self.bounds_file, self.passed_file = work / "seconds.json", work / "passed.json"
        self.bounds = json.loads(self.bounds_file.read_text()) if self.bounds_file.exists() else {}
        self.passed = json.loads(self.passed_file.read_text()) if self.passed_file.exists() else {}

    def left(self):
        """Seconds that are left; raises Enough when there are none."""
        if (left := self.until - time.monotonic()) <= 0.0:
            raise Enough
        return left

    def fill(self, table):
        files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=SOURCE, capture_output=True, text=True, check=True).stdout.splitlines()
        texts = {}
        for mutant in table:
            if mutant["form"] != "build":
                file = mutant["file"]
                texts[file] = mutated(texts.get(file) or (SOURCE / file).read_text(), mutant)
        texts = {name: '#include "mutant.hpp"\n' + text for name, text in texts.items()}
        sources = " ".join(f[len("src/"):] for f in touched(set(files), {m["file"] for m in table}))
        texts["src/CMakeLists.txt"] = (SOURCE / "src/CMakeLists.txt").read_text() + f'set_source_files_properties({sources} PROPERTIES COMPILE_OPTIONS "-O1;-w")\n'
        for name in files:
            if not (SOURCE / name).is_file():
                continue
            to = self.tree / name
            to.parent.mkdir(parents=True, exist_ok=True)
            if name in texts:
                write(to, texts[name])
            elif not to.exists() or to.read_bytes() != (SOURCE / name).read_bytes():
                shutil.copyfile(SOURCE / name, to)
        for folder in ("src", "tests"):
            for old in (self.tree / folder).rglob("*.cpp"):  # a file that is gone from the sources
                if str(old.relative_to(self.tree)) not in files:
                    old.unlink()
        write(self.tree / "src/mutant.hpp", HEADER)
        self.forget(files)

    def forget(self, files):
        """What earlier calls found holds while neither the sources nor the tests of a stage have changed."""
        digests = {}
        for folder in ["src", "tests/unit", "tests/physics", "tests/cli", "tests/stress", "tests/golden"]:
            digest = hashlib.sha256()
            for name in sorted(f for f in files if f.startswith(folder + "/") and (SOURCE / f).is_file()):
                digest.update(name.encode() + (SOURCE / name).read_bytes())
            digests[folder] = digest.hexdigest()
        file = self.bounds_file.with_name("digests.json")
        old = json.loads(file.read_text()) if file.exists() else {}
        for folder, digest in digests.items():
            if old.get(folder) == digest:
                continue
            for name, _, _ in list(self.stages()):
                of = {"test_restart.py": "tests/cli", "test_robust.py": "tests/cli", "test_measuring.py": "tests/cli"}.get(
                    name, "tests/" + re.match(r"test_(\w+)", name)[1])
                if folder in ("src", of):
                    self.bounds.pop(name, None)
                    if of == "tests/unit":
                        self.bounds.pop("slow unit tests", None)
                    for passed in self.passed.values():
                        if name in passed:
                            passed.remove(name)
        file.write_text(json.dumps(digests, indent=1))
        self.passed_file.write_text(json.dumps(self.passed, indent=1))

    def make(self):
        if not (self.build / "build.ninja").exists():
            subprocess.run(["cmake", "--preset", "default"], cwd=self.tree, check=True, stdout=subprocess.DEVNULL)
        self.need("barchan_all", "barchan", "test_unit")

    def need(self, *targets):
        if self.made.issuperset(targets):
            return
        build = subprocess.Popen(["cmake", "--build", str(self.build), "--target", *targets], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 start_new_session=True)
        try:
            said, _ = build.communicate(timeout=self.left())
        except subprocess.TimeoutExpired:
            os.killpg(build.pid, signal.SIGINT)  # what is built stays
            build.communicate()
            raise Enough from None
        if build.returncode != 0:
            raise SystemExit(said[-4000:])
        self.made.update(targets)

    def stages(self):
        """(name, command) of what a mutant has to pass, in order."""
        def gtest(program, only="*"):
            return [str(self.build / "tests" / program), "--gtest_fail_fast", "--gtest_brief=0", f"--gtest_filter={only}"]

        def python(script):
            return ["/usr/bin/python3", str(self.tree / script), str(self.build / "barchan"), str(self.tree)]
        slow = ":".join(self.bounds.get("slow unit tests", []))
        yield "test_unit", gtest("test_unit", "-" + slow if slow else "*"), {}
        if slow:
            yield "test_unit, slow", gtest("test_unit", slow), {}
        yield "test_physics, short", gtest("test_physics", SHORT), {}
        yield "test_cli", gtest("test_cli"), {}
        yield "test_golden.py", python("tests/golden/test_golden.py"), {}
        yield "test_stress", gtest("test_stress"), {}
        for shard in range(SHARDS):
            yield (f"test_physics, rest {shard + 1}/{SHARDS}", gtest("test_physics", "-" + SHORT),
                   {"GTEST_TOTAL_SHARDS": str(SHARDS), "GTEST_SHARD_INDEX": str(shard)})
        for script in SCRIPTS:
            yield pathlib.Path(script).name, python(script), {}

    def run(self, name, command, more, number):
        """How a stage ended: None when it passed."""
        if name.split(",")[0] in PROGRAMS:
            self.need(name.split(",")[0])
        shutil.rmtree(self.scratch, ignore_errors=True)
        self.scratch.mkdir()
        environment = {**os.environ, **more, "OMP_WAIT_POLICY": "passive", "TMPDIR": str(self.scratch), "BARCHAN_MUTANT": str(number)}
        bound = max(60.0, 6.0 * self.bounds[name]) if name in self.bounds else 3600.0
        with open(self.scratch / "output", "w+") as output:
            start = time.monotonic()
            process = subprocess.Popen(command, cwd=self.scratch, env=environment, stdout=output, stderr=subprocess.STDOUT, start_new_session=True)
            late = False
            try:
                process.wait(timeout=bound)
            except subprocess.TimeoutExpired:
                late = True
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
            seconds = time.monotonic() - start
            output.seek(0)
            text = output.read()
        if process.returncode == 0:
            if name == "test_unit" and name not in self.bounds:  # those that take half a second go second
                self.bounds["slow unit tests"] = [test for test, ms in re.findall(r"\[       OK \] (\S+) \((\d+) ms\)", text) if int(ms) > 500]
            return None, seconds
        failed = re.findall(r"\[  FAILED  \] ([\w/.]+)", text) or re.findall(r"^(?:FAIL|ERROR): (\w+)", text, re.M)
        running = re.findall(r"\[ RUN      \] ([\w/.]+)", text)
        how = "time-out" if late else "failed" if failed else "ended by a signal"
        return {"killed_by": name, "test": (failed or running[-1:] or [""])[0], "how": how, "seconds": round(seconds, 1)}, seconds

    def pass_all(self, names=None):
        """The right program; its times are bounds."""
        for name, command, more in self.stages():
            if name in self.bounds or (names and name not in names):
                continue
            self.left()
            end, seconds = self.run(name, command, more, 0)
            if end:
                raise SystemExit(f"the program without a mutant fails in {name}: {end['test']}")
            self.bounds[name] = seconds
            self.bounds_file.write_text(json.dumps(self.bounds, indent=1))
            print(f"right program      {name}: {seconds:.1f} s", flush=True)


def trial(copy, mutant, quick):
    if mutant["form"] != "build":
        return stages_of(copy, mutant, quick)
    file = copy.tree / mutant["file"]
    right = file.read_text()
    copy.made = set()
    try:
        file.write_text(mutated(right, mutant))
        copy.make()
        return stages_of(copy, mutant, quick)
    finally:
        file.write_text(right)
        copy.made = set()


def stages_of(copy, mutant, quick):
    passed = copy.passed.setdefault(mutant["name"], [])
    for name, command, more in copy.stages():
        if quick and not name.startswith("test_unit"):
            return None
        if name in passed:
            continue
        if name not in copy.bounds:
            copy.pass_all([name])
        copy.left()
        end, _ = copy.run(name, command, more, mutant["number"])
        if end:
            return end
        passed.append(name)
        copy.passed_file.write_text(json.dumps(copy.passed, indent=1))
    return {"killed_by": None}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--work", type=pathlib.Path, default=SOURCE / "build-mutants")
    parser.add_argument("--survivors", action="store_true")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--seconds", type=float, default=1e6)
    options = parser.parse_args()
    table = mutants()
    if unknown := set(options.names) - {m["name"] for m in table}:
        parser.error("no mutant " + ", ".join(sorted(unknown)))
    results = store.load(RESULTS, {})
    results = {m["name"]: results[m["name"]] for m in table if m["name"] in results}

    options.work.mkdir(parents=True, exist_ok=True)
    copy = Copy(options.work.resolve(), options.seconds)
    wanted = [m for m in table if not options.names or m["name"] in options.names]
    done = True
    try:
        copy.fill(table)
        copy.make()
        for mutant in wanted:
            name, had = mutant["name"], results.get(mutant["name"])
            if had and not options.again and not (options.survivors and had["killed_by"] is None):
                continue
            end = trial(copy, mutant, options.quick)
            if end is None:
                print(f"passes test_unit   {name}: {mutant['wrong']}", flush=True)
                continue
            results[name] = end
            store.keep(RESULTS, {m["name"]: results[m["name"]] for m in table if m["name"] in results})
            killed = end["killed_by"]
            print(f"{'killed  ' if killed else 'SURVIVED'}           {name}: " +
                  (f"{killed}, {end['test']} ({end['how']}, {end['seconds']} s)" if killed else mutant["wrong"]), flush=True)
    except Enough:
        done = False
    survivors = [name for name, end in results.items() if end["killed_by"] is None]
    print(f"{len(results)} of {len(table)} mutants have a result, {len(results) - len(survivors)} killed; survivors: {', '.join(survivors) or 'none'}")
    return 3 if not done else 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
