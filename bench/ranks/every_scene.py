#!/usr/bin/python3
"""Every scene that comes along, shortened, on ranks: the bytes of one process. The table of docs/ranks.md.

    /usr/bin/python3 bench/ranks/every_scene.py PROGRAM [--only SCENE]... [--steps 30] [--write]

Each scene runs for 30 steps as long as the first one: one process of 1 and of 2 threads, 1, 2, 3, 4 and 7 ranks, 2 ranks of 2 threads, and 3 ranks to
the middle whose checkpoint 2 ranks go on from. Instruments measure from the start, every third step. All files but run.json must have the bytes of the first. Scenes that take long to fill have the overrides
of tests/physics/every_scene.hpp. A scene whose result is kept is not run again unless it is named. Exit status 1 when bytes differ or a run ends badly.
"""

import argparse
import json
import pathlib
import re
import sys
import tempfile
import tomllib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, checkpoints, run, store, table  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/every_scene.csv"
LAUNCH = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "--bind-to", "none", "-n"]
WAYS = {"2 threads": (0, 2), "1 rank": (1, 1), "2 ranks": (2, 1), "3 ranks": (3, 1), "4 ranks": (4, 1), "7 ranks": (7, 1), "2 ranks of 2 threads": (2, 2)}
SAME = "same"


def fewer_particles():
    """Overrides by scene, of the tests that run every scene."""
    text = (ROOT / "tests/physics/every_scene.hpp").read_text()
    return {name: re.findall(r'"([^"]*)"', words) for name, words in re.findall(r'\{"([^"]+)", \{([^{}]*)\}\}', text)}


def files(folder):
    """All that has the bits of the run; the checkpoint before the last one is another in a run that was continued."""
    return {f.name: checkpoints.whole(f) if f.suffix == ".checkpoint" else f.read_bytes() for f in folder.iterdir()
            if f.is_file() and f.name not in ("run.json", "barchan.lock") and not f.name.endswith(".older")}


def measured_at_once(name, every):
    """Overrides that let the instruments of a scene measure from its start, every so many seconds."""
    scene = tomllib.loads((ROOT / "scenes" / f"{name}.toml").read_text())
    return [f"{kind}.{k}.{key}={value!r}" for kind in ("probe", "gauge", "profile", "grid", "wall-shear", "saltation") for k, one in enumerate(scene.get(kind, []))
            for key, value in (("start", 0.), ("every", every)) if key in one]


class Scene:
    def __init__(self, program, name, sets, steps, top):
        self.program, self.name, self.sets, self.top = program, name, sets, top
        planned = run.command([program, "plan", run.scene_file(name), "--json", *run.settings(sets)], timeout=600, check=True)
        self.step = json.loads(planned.stdout)["step"]
        self.sets = [*sets, *measured_at_once(name, 3 * self.step)]
        self.steps = steps

    def run(self, ranks, threads, out, part=1., options=()):
        end = self.step * self.steps
        sets = [*self.sets, f"time.end={part * end!r}", f"output.every={end / 2!r}", f"output.history-every={end / 6!r}", "output.checkpoint-every=1e9"]
        return run.scene(self.program, self.name, self.top / out, sets, threads=threads, options=options, before=[*LAUNCH, ranks] if ranks else [],
                         check=False, timeout=900)

    def compare(self, out, reference):
        found = files(self.top / out)
        return sorted(name for name in found.keys() | reference.keys() if found.get(name) != reference.get(name))

    def result(self):
        one = self.run(0, 1, "one").checked(self.name)
        kept = {"particles": sum(one.report["particles"].values()), "steps": one.report["steps"], "files": len(files(one.out)), "ways": {}}
        reference = files(one.out)
        for way, (ranks, threads) in WAYS.items():
            ended = self.run(ranks, threads, way)
            kept["ways"][way] = self.outcome(ended, way, reference)
        first = self.run(3, 1, "restart", part=.5)
        second = self.run(2, 1, "restart", options=["--restart", "latest"])
        kept["ways"]["3 ranks, then 2"] = self.outcome(first if first.status else second, "restart", reference)
        return kept

    def outcome(self, ended, out, reference):
        if ended.status != 0:
            return f"status {ended.status}: {ended.stderr.strip()[-200:]}"
        different = self.compare(out, reference)
        return SAME if not different else "other bytes: " + ", ".join(different)


def measured(program, name, steps):
    with tempfile.TemporaryDirectory(prefix="barchan_ranks_") as top:
        return Scene(program, name, fewer_particles().get(name, []), steps, pathlib.Path(top)).result()


def says(result):
    ways = result["ways"]
    if all(outcome == SAME for outcome in ways.values()):
        return "the same bytes in all"
    return "; ".join(f"{way}: {outcome}" for way, outcome in ways.items() if outcome != SAME)


def text(results):
    good = [name for name, r in results.items() if all(o == SAME for o in r["ways"].values())]
    lines = [f"{len(results)} scenes: {len(good)} have the same bytes in all of these runs, {len(results) - len(good)} differ.", "",
             table.head("scene", "particles", "steps", "frames, history, checkpoint")]
    lines += [table.row(f"`{name}`", r["particles"], r["steps"], says(r)) for name, r in sorted(results.items())]
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"every scene": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", action="append")
    parser.add_argument("--steps", type=int, default=30)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    every = sorted(str(f.relative_to(ROOT / "scenes").with_suffix("")) for f in (ROOT / "scenes").rglob("*.toml"))
    results = store.load(RESULTS, {})
    asked = [name for name in options.only if name != "none"] if options.only else [name for name in every if name not in results]
    for name in asked:
        results[name] = measured(options.program.resolve(), name, options.steps)
        print(name, says(results[name]), flush=True)
        store.keep(RESULTS, results)
    results = {name: results[name] for name in every if name in results}
    if options.write:
        store.keep(RESULTS, results)
    return any(o != SAME for r in results.values() for o in r["ways"].values())


if __name__ == "__main__":
    sys.exit(main())
