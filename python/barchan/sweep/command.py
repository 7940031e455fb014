"""barchan sweep SCENE --vary KEY=a:b:n ..."""

import argparse
import json
import os
import pathlib
import shlex
import subprocess
import sys

from .. import files
from ..errors import OutputError, PackageMissing, SceneError, nearest
from ..program import find_program, settings
from ..tables import bare
from . import results
from .cases import combinations
from .runner import Runner

SHARED = pathlib.Path(__file__).resolve().parents[3]  # of the source tree; of an installation PREFIX/share/barchan


def parser():
    """Options of the command line."""
    p = argparse.ArgumentParser(prog="barchan sweep", description="Runs a scene with every combination of the values of some keys, goes on after a fault and after being stopped, and gathers one table and one page.",
                                epilog="Exit status: 0 all runs ended well, 1 some did not (the table says which), 2 wrong command or every run was refused, 128 + n stopped by signal n: the same command goes on.")
    p.add_argument("scene", help="scene file (.toml), or the name of a scene that comes along")
    p.add_argument("--vary", action="append", default=[], metavar="KEY=VALUES", help="FROM:TO:NUMBER (evenly, both ends with it), FROM:TO:NUMBER:log (equal ratios) or VALUE,VALUE,...; again for another key")
    p.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of the scene in all runs")
    p.add_argument("-j", "--jobs", type=int, metavar="N", help="runs at a time (default: processors over --threads)")
    p.add_argument("--threads", type=int, default=1, help="threads of each run (default 1)")
    p.add_argument("--out", metavar="DIR", help="folder of the sweep (default out/NAME_sweep)")
    p.add_argument("--measure", action="append", default=[], metavar="COLUMN[:WAY]", help="a column of history.csv; WAY is last (default), first, mean, max or min of its rows; again for another")
    p.add_argument("--from", dest="start", type=float, default=0., metavar="TIME", help="s; measures take the rows of the history from this time on")
    return p


def scene_file(word):
    """The file that a person names: a file as it is, else the scene of this name that comes along (dune, verification/hop or hop). Throws SceneError."""
    if pathlib.Path(word).is_file():
        return word
    scenes = SHARED / "scenes"
    if not word.endswith(".toml"):
        found = [scenes / f"{word}.toml"] if (scenes / f"{word}.toml").is_file() else [file for file in scenes.rglob("*.toml") if file.stem == word]
        if len(found) == 1:
            return str(found[0])
    raise SceneError(f"{word}: there is no such scene file (.toml){nearest(pathlib.Path(word).stem, [file.stem for file in scenes.rglob('*.toml')])}")


def main(words):
    """Runs the sweep; returns the exit status."""
    options = parser().parse_args(words)
    if not options.vary:
        raise SceneError("sweep: nothing to vary: --vary KEY=FROM:TO:NUMBER or --vary KEY=VALUE,VALUE,...")
    options.scene = scene_file(options.scene)
    if options.threads < 1 or (options.jobs is not None and options.jobs < 1):
        raise SceneError("--jobs and --threads are numbers of 1 or more")
    measures = [results.measure(text) for text in options.measure]
    cases = combinations(options.vary, options.set)
    out = pathlib.Path(options.out or f"out/{pathlib.Path(options.scene).stem}_sweep")
    check_measures(measures, options.scene, cases[0])
    jobs = options.jobs or max(len(os.sched_getaffinity(0)) // options.threads, 1)
    lines, count = [], [0]

    def tell(ended):
        count[0] += 1
        said = "done before" if ended.again else f"{ended.seconds:.1f} s"
        more = "" if ended.status == 0 else ": " + results.row(ended, [])[0]["end_reason"][:160]
        print(f"[{count[0]}/{len(cases)}] {ended.folder.name}: status {ended.status}, {said}{more}", flush=True)

    try:
        out.mkdir(parents=True, exist_ok=True)
        runner = Runner(find_program(), options.scene, out, jobs, options.threads, tell)
        ended = runner.go(cases)
        measures = measures or results.usual([each.folder for each in ended])
        missing = {}
        for each in ended:
            line, absent = results.row(each, measures, options.start)
            lines.append(line)
            missing.update(absent)
        results.write(out / "sweep.csv", lines)
    except OSError as error:
        raise OutputError(f"{out}: {error}") from error
    keys = list(cases[0].values)
    print(f"table     {out / 'sweep.csv'}")
    notes = [f"--measure {text}" for text in missing.values()]
    write_page(out, options, words, lines, len(cases), keys, measures, notes)
    for note in notes:
        print(f"barchan: warning: {note}", file=sys.stderr)
    return status_of(runner.stopped, lines, missing)


def check_measures(measures, scene, case):
    """Throws SceneError for a column that history.csv will not have, before anything runs. A scene that the program refuses is told by its run."""
    if not measures:
        return
    planned = subprocess.run([find_program(), "plan", scene, "--json", *settings(case.settings)], capture_output=True, text=True)
    if planned.returncode != 0:
        return
    names = [bare(full) for full in json.loads(planned.stdout).get("history", ())]
    wrong = [f'--measure {column}: history.csv has no such column{nearest(column, names)}' for column, _ in measures if names and column not in names]
    if wrong:
        raise SceneError("\n".join(wrong) + f'; expected {", ".join(names)}')


def write_page(out, options, words, lines, expected, keys, measures, notes):
    """sweep.html; without matplotlib there is none, and a warning says so."""
    try:
        from . import page
        text = page.make(pathlib.Path(options.scene).name, shlex.join(["barchan", "sweep", *words]), lines, expected, keys, measures, notes)
    except PackageMissing as error:
        print(f"barchan: warning: no page: {error}", file=sys.stderr)
        return
    files.write_whole(out / "sweep.html", text)
    print(f"page      {out / 'sweep.html'}")


def status_of(stopped, lines, missing):
    """The exit status of a sweep."""
    if stopped is not None:
        print("stopped: the same command goes on", file=sys.stderr)
        return 128 + stopped
    if missing or (lines and all(line["status"] == 2 for line in lines)):
        return 2
    return 0 if all(line["status"] == 0 for line in lines) else 1
