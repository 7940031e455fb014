#!/usr/bin/python3
"""Is a scene stable, or was it luck? Many runs of it that differ by less than anybody can know.

    /usr/bin/python3 bench/stability/ensemble.py build/barchan paper/dune.toml paper/flat_bed.toml --write

Between instruction sets bits differ, and a loosened bed is chaos, so one good run says nothing. Each scene runs --runs times (24): the air
disturbed by 0.01 spacings with another seed in each, u* times 0.98, 1 and 1.02 in turn, mixed and double precision, and all
instruction sets that the program and this machine have (or --instructions). Asked: every run reaches its end; the density error of the air is
at most 2 % in every row of history.csv (a thousand rows a run); no grain leaves. With --ustar-factor or --density-factor
(grains as heavy by that factor) the scene is another one; then every run must end well or be stopped by the watch with its message.
Of a scene without a logarithmic wind other things differ and are asked: ensemble_any.py.

The runs are cases of a sweep (python/barchan/sweep): single-threaded, --jobs at a time (2). --runs-dir keeps them: a run that is there is not done again, so that an ensemble
can be stopped and gone on with. With --write the figures go to bench/stability/results/. Exits with 1 when something that was asked is missed.
"""

import argparse
import json
import math
import pathlib
import re
import sys
import tempfile
import tomllib

import numpy

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1]), str(pathlib.Path(__file__).resolve().parents[1] / "accuracy")]
import cases_wind  # noqa: E402
import ensemble_any as any_scene  # noqa: E402
from barchan_bench import ROOT, page as pages, run, store  # noqa: E402
from barchan_bench.frame import Frame, series, table  # noqa: E402
from barchan_bench.table import head  # noqa: E402
from barchan import sweep  # noqa: E402  (barchan_bench.frame knows where the package is)

RESULTS = pathlib.Path(__file__).resolve().parent / "results"
DENSITY_BOUND = .02
HEAD = head("run", "seed", "u*", "precision", "instructions", "status", "ended at, ms", "steps", "largest density error of the air", "fastest grain, m/s",
            "bulk speed, second half/start", "u 1 mm over the bed upstream, end/start", "user CPU s", "message")


def label(path):
    """A scene as the pages name it: its path from scenes/."""
    return str(path.relative_to(ROOT / "scenes")) if path.is_relative_to(ROOT / "scenes") else path.name


def available(program):
    """The instruction sets that the program and this machine have, the widest first."""
    return re.search(r"instruction set: .*\(of (.*)\)", run.version(program))[1].split(", ")[::-1]


def members(scene, sets_of_instructions, options):
    """The runs of a scene: what differs, and the command's overrides."""
    air = next(k for k, f in enumerate(scene["fill"]) if f["phase"] == "air")
    friction = scene["fill"][air]["velocity"]["log-profile"]["friction-velocity"]
    for k in range(options.runs):
        factor = (.98, 1., 1.02)[k % 3] * options.ustar_factor
        precision, instructions = ("mixed", "double")[k // 3 % 2], sets_of_instructions[k // 6 % len(sets_of_instructions)]
        sets = [f"fill.{air}.perturb=0.01", f"fill.{air}.seed={k + 1}", f"precision={precision}",
                f"fill.{air}.velocity.log-profile.friction-velocity={friction * factor!r}"]
        for n, forcing in enumerate(scene.get("forcing", [])):  # a given force is u*^2/H
            if forcing["phase"] == "air" and all(isinstance(a, int | float) for a in forcing.get("acceleration", ["a formula"])):
                sets.append(f"forcing.{n}.acceleration={[a * factor**2 for a in forcing['acceleration']]}")
        if options.density_factor != 1:
            sets.append(f"phases.sand.density={scene['phases']['sand']['density'] * options.density_factor!r}")
        sets += [f"output.every={scene['time']['end']!r}", f"output.history-every={scene['time']['end'] / 1000!r}", "output.walls=false"]
        yield {"run": k + 1, "seed": k + 1, "friction_velocity": friction * factor, "precision": precision}, instructions, sets + options.set


def figures(out, name, scene):
    """What a finished run shows; figures that it did not come to are None."""
    if not any_scene.is_wind(scene):
        return any_scene.figures(out, name, scene)
    report = json.loads((out / "run.json").read_text())
    history = table(out / "history.csv")
    t, bulk = history["time [s]"], history["air_mean_vx [m/s]"]
    late = bulk[t > .5 * t[-1]]
    finite = lambda x: float(x) if math.isfinite(x) else None
    entries = series(out / f"{name}.pvd")
    first, last = (Frame(file, time) for time, file in (entries[0], entries[-1]))
    sand = last["phase"] == last.names.index("sand")
    origin = numpy.array(scene["domain"].get("origin", [0, 0]))
    low, high = last.x[sand, :2] < origin, last.x[sand, :2] > origin + scene["domain"]["size"]
    left = int((low | high).any(axis=1).sum()) + int((first["phase"] == last.names.index("sand")).sum() - sand.sum())
    return {"instructions": report["instruction_set"].split(" (")[0], "ended_at": finite(t[-1]), "steps": report["steps"],
            "density_error": finite(history["largest_density_error"].max()), "grains_left": left,
            "fastest_grain": finite(history["sand_largest_speed [m/s]"].max()), "bulk": finite(late.mean() / bulk[0]),
            "near_bed": near_bed(scene, first, last), "cpu_seconds": round(report["cpu_seconds"], 1)}


def near_bed(scene, first, last):
    """u at 1 mm over the bed of the last frame over that of the first, 3 cm upstream of a dune's toe or over the whole flat bed."""
    wind = cases_wind.Wind(scene)
    dune = wind.dune if "height" in wind.dune else None
    middle, width = (dune["at"] - dune["length"] / 2 - .03, .01) if dune else (0, wind.size[0])
    then, now = (cases_wind.speed([cases_wind.only(f, "air")], wind, middle, width, wind.bed + 1e-3) for f in (first, last))
    return float(now / then) if math.isfinite(now / then) else None


def carry_out(path, program, folder, members, jobs):
    """All runs of a scene, as cases of a sweep: those that are there are not done again. Returns the figures of each, and prints them as they end."""
    scene, runs = tomllib.loads(path.read_text()), {}
    cases = [sweep.Case(member, tuple(sets), f"{member['run']:02d}", ("--instructions", instructions)) for member, instructions, sets in members]

    def tell(ended):
        if ended.status > 128:
            return
        result = dict(ended.case.values, status=ended.status, message="" if ended.status == 0 else ended.said.strip().partition("barchan: ")[2][:300])
        if ended.status in (0, 3):
            result.update(figures(ended.folder, path.stem, scene))
        runs[ended.case.folder] = result
        print(row(result), flush=True)

    sweep.Runner(program, path, folder, jobs, tell=tell).go(cases)
    if len(runs) < len(cases):
        raise SystemExit(f"{len(cases) - len(runs)} runs were stopped by a signal; start again to go on")
    return [runs[case.folder] for case in cases]


def row(r):
    if "step_factor" in r:
        return any_scene.row(r)
    text = lambda key, form: "" if r.get(key) is None else format(r[key], form)
    ended = "" if r.get("ended_at") is None else f"{1e3 * r['ended_at']:.1f}"
    return (f"| {r['run']} | {r['seed']} | {r['friction_velocity']:.4g} | {r['precision']} | {r.get('instructions', '')} | {r['status']} | {ended} | "
            f"{r.get('steps', '')} | {text('density_error', '.4f')} | {text('fastest_grain', '.2f')} | {text('bulk', '.3f')} | {text('near_bed', '.2f')} | "
            f"{text('cpu_seconds', '.0f')} | {r['message'].replace('|', '/')} |")


def verdict(result):
    """Lines of what was asked and what came out; True if all is well."""
    if "step_factor" in result["runs"][0]:
        return any_scene.verdict(result)
    runs, plain = result["runs"], result["ustar_factor"] == 1 and result["density_factor"] == 1
    ended = sum(r["status"] == 0 for r in runs)
    stopped = sum(r["status"] == 3 and bool(r["message"]) for r in runs)
    errors = [r["density_error"] for r in runs if r.get("density_error") is not None]
    left = sum(r.get("grains_left") or 0 for r in runs)
    worst = max(errors) if errors else math.nan
    lines = [f"{ended} of {len(runs)} reach the end, {stopped} are stopped with a message, {len(runs) - ended - stopped} end otherwise.",
             f"Largest density error of the air at any time: {worst:.4f}" + (f" (bound {DENSITY_BOUND})." if plain else "."),
             f"Grains outside the domain at the end: {left}."]
    good = ended == len(runs) and worst <= DENSITY_BOUND and left == 0 if plain else ended + stopped == len(runs)
    return lines + ([] if good else ["**MISSED**"]), good


def title(result):
    other = [f"u* times {result['ustar_factor']:g}"] * (result["ustar_factor"] != 1) + [
        f"grains {result['density_factor']:g} times as heavy"] * (result["density_factor"] != 1)
    return ", ".join([result["scene"]] + other)


def tables():
    """That of docs/stability.md, from all results that are there."""
    parts, rows = [], []
    for file in sorted(RESULTS.glob("*.csv")):
        result = store.load(file)
        if "runs" not in result:  # the atlas stands beside the ensembles
            continue
        if "step_factor" in result["runs"][0]:
            rows.append(any_scene.page_row(result))
            continue
        lines, _ = verdict(result)
        parts += [f"\n## {title(result)}\n", f"`{result['command']}`\n"] + ["\n".join(f"- {x}" for x in lines) + "\n",
                  HEAD + "\n" + "\n".join(row(r) for r in result["runs"]) + f"\n\nMeasured on {result['processor']}.\n"]
    if rows:
        about = "`ensemble.py build/barchan SCENE --runs N`. The step (time.safety) times 0.98, 1 and 1.02, fluids and elastic bodies disturbed with other seeds, mixed and double precision, all instruction sets."
        parts = ["\n## Bodies, heaps and fluids\n", about + " Least and largest of the runs.\n", any_scene.PAGE_HEAD + "\n" + "\n".join(rows) + "\n"] + parts
    return {"measured": "\n".join(parts or ["\nNothing was measured.\n"])}


def ensemble(path, program, options, folder):
    """All runs of one scene."""
    scene = tomllib.loads(path.read_text())
    variant = "".join(f"-{name}-{value:g}" for name, value in (("ustar", options.ustar_factor), ("density", options.density_factor)) if value != 1)
    members_of = members if any_scene.is_wind(scene) else any_scene.members
    out = folder / f"{label(path)[:-5].replace('/', '-')}{variant}"
    runs = carry_out(path, program, out, members_of(scene, options.instructions or available(program), options), options.jobs)
    command = f"ensemble.py build/barchan {label(path)} --runs {options.runs}"
    command += f" --instructions {' '.join(options.instructions)}" if options.instructions else ""
    command += f" --ustar-factor {options.ustar_factor:g}" * (options.ustar_factor != 1)
    command += f" --density-factor {options.density_factor:g}" * (options.density_factor != 1)
    command += "".join(f" --set {s}" for s in options.set)
    result = {"scene": label(path), "ustar_factor": options.ustar_factor, "density_factor": options.density_factor, "command": command,
              "processor": pages.processor(), "runs": runs}
    lines, good = verdict(result)
    print(f"{title(result)}: " + " ".join(lines), flush=True)
    if options.write:
        store.keep(RESULTS / f"{label(path)[:-5].replace('/', '-')}{variant}.csv", result)
    return good


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", metavar="PROGRAM", help="build/barchan, or none")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="a file, or the name of one in scenes/")
    parser.add_argument("--runs", type=int, default=24)
    parser.add_argument("--instructions", nargs="+", metavar="NAME", help="avx512, avx2 (default: all that there are)")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--ustar-factor", type=float, default=1.)
    parser.add_argument("--density-factor", type=float, default=1.)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE")
    parser.add_argument("--runs-dir", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    good = True
    if options.build != "none":
        program = pathlib.Path(options.build).resolve()
        if not program.exists() or not options.scenes:
            parser.error("which scene?" if program.exists() else f"no program {program}")
        print(HEAD)
        for name in options.scenes:
            path = next((p for p in (pathlib.Path(name), ROOT / "scenes" / name, ROOT / f"scenes/{name}.toml") if p.is_file()), None)
            if not path:
                parser.error(f"no scene {name}")
            with tempfile.TemporaryDirectory() as scratch:
                good = ensemble(path.resolve(), program, options, options.runs_dir or pathlib.Path(scratch)) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
