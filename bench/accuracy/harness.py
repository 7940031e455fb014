"""What all cases share: the options of the command line, a scene as dictionaries and back, runs that are kept, a local fit. Frames, tables and figures are
those of barchan_bench."""

import argparse
import hashlib
import json
import pathlib
import shutil
import sys
import tempfile
import tomllib

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import ROOT, frame, run as runs  # noqa: E402, F401
from barchan_bench.run import Broken, Seconds  # noqa: E402
from barchan_bench.table import attempt, report, rows, tell  # noqa: E402, F401  (for the cases)

RESULTS = pathlib.Path(__file__).resolve().parent / "results"
options = argparse.Namespace(program=None, runs=None, set=[], largest=200, verbose=False)  # cases.py fills it from its command line
SECTIONS = ("fill", "force", "forcing", "marker", "motion", "probe", "gauge", "profile", "grid", "wall-shear")  # lists of sections of a scene


def run_into(out, scene, overrides):
    """Runs a scene (a file's name or its text) into `out`, unless it is there; returns the series' name and the user CPU seconds."""
    if (out / "run.json").exists():
        kept = json.loads((out / "run.json").read_text())
        return runs.scene_file(scene, out).stem, Seconds.of(kept["cpu_seconds"], kept)
    try:
        ended = runs.scene(options.program, scene, out, overrides)
    except Broken as broken:
        print(broken.ended.stderr, file=sys.stderr)
        shutil.rmtree(out, ignore_errors=True)
        raise
    return ended.name, ended.seconds


def run(scene, overrides, phase=None, last=None, keep=lambda t: True, files=(), also=()):
    """Runs a scene; returns the frames that `keep` takes and the user CPU seconds. With `files`, tables of the run (dictionaries of
    columns) instead of frames; with `also`, frames, those tables and the seconds."""
    overrides = list(overrides) + options.set
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "run"
        if options.runs:
            text = scene + (" ".join(overrides) if "\n" in scene else " " + " ".join(overrides))
            out = pathlib.Path(options.runs) / hashlib.sha1(text.encode()).hexdigest()[:12]
        name, seconds = run_into(out, scene, overrides)
        if files:
            return [frame.table(out / file) for file in files], seconds
        entries = frame.series(out / f"{name}.pvd")
        if last:
            entries = entries[-last:]
        frames = [frame.Frame(file, t, phase) for t, file in entries if keep(t)]
        return (frames, [frame.table(out / file) for file in also], seconds) if also else (frames, seconds)


def document(scene):
    """A scene of scenes/ or scenes/verification/ as dictionaries."""
    return tomllib.loads(runs.scene_file(scene).read_text())


def toml(scene):
    """Text of a scene that is given as dictionaries: what `document` reads, changed."""
    def value(v):
        if isinstance(v, dict):
            return "{ " + ", ".join(f"{k} = {value(x)}" for k, x in v.items()) + " }"
        return "[" + ", ".join(value(x) for x in v) + "]" if isinstance(v, list) else json.dumps(v)
    lines = [f"{k} = {value(v)}" for k, v in scene.items() if not isinstance(v, dict) and k not in SECTIONS]
    for name, section in scene.items():
        if name == "phases":
            for phase, keys in section.items():
                lines += [f"[phases.{phase}]"] + [f"{k} = {value(v)}" for k, v in keys.items()]
        elif isinstance(section, dict):
            lines += [f"[{name}]"] + [f"{k} = {value(v)}" for k, v in section.items()]
        elif name in SECTIONS:
            for keys in section:
                lines += [f"[[{name}]]"] + [f"{k} = {value(v)}" for k, v in keys.items()]
    return "\n".join(lines) + "\n"


def local_fit(x, values, at, radius):
    """Moving least squares, linear, Wendland C2 weights: the field at `at`."""
    d = x[:, :2] - numpy.asarray(at)
    q = numpy.hypot(d[:, 0], d[:, 1]) / radius
    near = q < 1
    d, q = d[near], q[near]
    w = (1 - q) ** 4 * (4 * q + 1)
    basis = numpy.column_stack([numpy.ones(len(d)), d])
    return numpy.linalg.solve((basis * w[:, None]).T @ basis, (basis * w[:, None]).T @ values[near])[0]
