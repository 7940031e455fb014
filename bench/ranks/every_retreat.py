#!/usr/bin/python3
"""Every scene that comes along with steps that are too long: a run that goes back to an earlier state has the same bytes on ranks.

    /usr/bin/python3 bench/ranks/every_retreat.py PROGRAM [--only SCENE]... [--safety 2.5] [--steps 60] [--write]

Each scene is shortened as in every_scene.py and run in one process with time.safety=2.5. Of those that go back at least once, 2 and 3 ranks must have all
files but run.json byte by byte, and go back from the same steps for the same reasons. Exit status 1 when something differs.
"""

import argparse
import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from every_scene import ROOT, Scene, fewer_particles, files, store, table  # noqa: E402

RESULTS = ROOT / "bench/ranks/results/every_retreat.csv"
RANKS = (2, 3)


def retreats(ended):
    """What run.json says of going back; nothing where the run did not begin."""
    report = ended.out / "run.json"
    return json.loads(report.read_text()).get("retreats", {}) if report.exists() else {}


def measured(program, name, safety, steps):
    with tempfile.TemporaryDirectory(prefix="barchan_retreat_") as top:
        scene = Scene(program, name, fewer_particles().get(name, []), steps, pathlib.Path(top))
        scene.sets = [*scene.sets, f"time.safety={safety!r}"]
        one = scene.run(0, 1, "one")
        back = retreats(one)
        result = {"status": one.status, "count": back.get("count", 0), "ways": {}}
        if not result["count"]:
            return result
        reference = files(one.out)
        for ranks in RANKS:
            ended = scene.run(ranks, 1, f"of-{ranks}")
            same = ended.status == one.status and not scene.compare(f"of-{ranks}", reference) and retreats(ended) == back
            result["ways"][f"{ranks} ranks"] = "same" if same else f"status {ended.status}, other bytes or other retreats"
        return result


def text(results):
    back = {name: r for name, r in results.items() if r["count"]}
    good = [name for name, r in back.items() if all(o == "same" for o in r["ways"].values())]
    lines = [f"{len(results)} scenes, `time.safety = 2.5`: {len(back)} go back to an earlier state, {len(good)} of them with the same bytes on 2 and 3 ranks.",
             "", table.head("scene", "how often", "2 and 3 ranks")]
    for name, r in sorted(back.items()):
        differ = "; ".join(f"{way}: {outcome}" for way, outcome in r["ways"].items() if outcome != "same")
        lines.append(table.row(f"`{name}`", r["count"], differ or "the same bytes"))
    return "\n".join(lines)


def tables():
    """Those of docs/ranks.md."""
    results = store.load(RESULTS)
    return {"every retreat": text(results) if results else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", action="append")
    parser.add_argument("--safety", type=float, default=2.5)
    parser.add_argument("--steps", type=int, default=60)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    every = sorted(str(f.relative_to(ROOT / "scenes").with_suffix("")) for f in (ROOT / "scenes").rglob("*.toml"))
    results = {}
    for name in options.only or every:
        results[name] = measured(options.program.resolve(), name, options.safety, options.steps)
        print(name, results[name], flush=True)
    if options.write:
        store.keep(RESULTS, results)
    return any(o != "same" for r in results.values() for o in r["ways"].values())


if __name__ == "__main__":
    sys.exit(main())
