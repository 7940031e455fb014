"""What all cases share: running a scene, reading its frames and tables, reporting a figure, a local fit."""

import argparse
import hashlib
import json
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import tomllib
import xml.etree.ElementTree as ElementTree

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes/verification"
RESULTS = pathlib.Path(__file__).resolve().parent / "results"
options = argparse.Namespace(program=None, runs=None, set=[], largest=200, verbose=False)  # cases.py fills it from its command line
SECTIONS = ("fill", "forcing", "probe", "profile", "grid", "wall-shear")  # lists of sections of a scene
rows = []  # what the case in hand has reported


class Frame:
    """One frame of a series: positions and arrays, of the phase with this name or of all."""

    def __init__(self, path, time, phase=None):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        data = reader.GetOutput()
        arrays = data.GetPointData()
        self.time = time
        self.x = vtk_to_numpy(data.GetPoints().GetData())
        self.arrays = {arrays.GetArrayName(k): vtk_to_numpy(arrays.GetArray(k)) for k in range(arrays.GetNumberOfArrays())}
        names = data.GetFieldData().GetAbstractArray("phase_names")
        self.names = [names.GetValue(k) for k in range(names.GetNumberOfValues())]
        if phase is not None:
            keep = self.arrays["phase"] == self.names.index(phase)
            self.x = self.x[keep]
            self.arrays = {name: values[keep] for name, values in self.arrays.items()}

    def __getitem__(self, name):
        return self.arrays[name]


class Broken(RuntimeError):
    """A run that did not reach its end; the message says why."""


class Seconds(float):
    """User CPU seconds, and the particle-steps done in them."""
    work = 0.0

    def __add__(self, other):
        total = Seconds(float(self) + float(other))
        total.work = self.work + getattr(other, "work", 0.0)
        return total

    __radd__ = __add__


def run_into(out, scene, overrides):
    """Runs a scene (a file's name or its text) into `out`, unless it is there; returns the series' name and the user CPU seconds."""
    places = SCENES / f"{scene}.toml", ROOT / f"scenes/{scene}.toml"
    path = out / "case.toml" if "\n" in scene else next(p for p in places if p.exists())
    report_file = out / "run.json"
    if report_file.exists():
        user = json.loads(report_file.read_text())["cpu_seconds"]
    else:
        out.mkdir(parents=True, exist_ok=True)
        if "\n" in scene:
            path.write_text(scene)
        command = [options.program, "run", str(path), "--threads", "1", "--quiet", "--out", str(out)]
        for o in overrides:
            command += ["--set", o]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(command, capture_output=True, text=True)
        user = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        if done.returncode != 0:
            print(done.stderr, file=sys.stderr)
            shutil.rmtree(out)
            raise Broken(f"{path.name} ended with status {done.returncode}: {done.stderr.strip()[:300]}")
    summary = json.loads(report_file.read_text())
    seconds = Seconds(user)
    seconds.work = float(summary["steps"]) * sum(summary["particles"].values())
    return path.stem, seconds


def run(scene, overrides, phase=None, last=None, keep=lambda t: True, files=(), also=()):
    """Runs a scene; returns the frames that `keep` takes and the user CPU seconds. With `files`, tables of the run (dictionaries of
    columns) instead of frames; with `also`, frames, those tables and the seconds."""
    overrides = list(overrides) + options.set
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "run"
        if options.runs:
            text = scene if "\n" in scene else scene + " " + " ".join(overrides)
            out = pathlib.Path(options.runs) / hashlib.sha1(text.encode()).hexdigest()[:12]
        name, seconds = run_into(out, scene, overrides)
        if files:
            return [table(out / file) for file in files], seconds
        entries = [(float(e.get("timestep")), e.get("file"))
                   for e in ElementTree.parse(out / f"{name}.pvd").getroot().iter("DataSet")]
        if last:
            entries = entries[-last:]
        frames = [Frame(out / file, t, phase) for t, file in entries if keep(t)]
        return (frames, [table(out / file) for file in also], seconds) if also else (frames, seconds)


def table(path):
    names = path.open().readline().strip().split(",")
    return dict(zip(names, numpy.loadtxt(path, delimiter=",", skiprows=1, unpack=True, ndmin=2)))


HEAD = "| case | scheme | N | figure | measured | bound | | user CPU s | particle-steps/s |\n" + "| --- " * 9 + "|"


def line(r):
    rate = f"{r['rate'] / 1e6:.2f} M" if r["rate"] else ""
    bound = r["bound"] if r["bound"] is not None else ""
    if isinstance(bound, float | int):
        bound = f"{'>=' if r['at_least'] else '<='} {bound:g}"
    value = r["value"] if isinstance(r["value"], str) else f"{r['value']:.3g}"
    time = f"{r['seconds']:.1f}" if r["seconds"] else ""
    return (f"| {r['case']} | {r['scheme']} | {r['n']} | {r['what']} | {value} | {bound} | {'' if r['good'] else 'MISSED'} | "
            f"{time} | {rate} |")


def report(case, scheme, n, what, value, bound, seconds, at_least=False):
    """One figure. A bound of None: nothing is asked of it."""
    good = bound is None or bool(value >= bound if at_least else value <= bound)
    rate = seconds.work / seconds if isinstance(seconds, Seconds) and seconds > 0 else None
    rows.append({"case": case, "scheme": scheme, "n": n, "what": what, "value": float(value), "bound": bound, "at_least": at_least,
                 "good": good, "seconds": round(float(seconds), 2), "rate": rate})
    print(line(rows[-1]), flush=True)


def tell(case, scheme, n, what, value, beside, seconds):
    """A figure in words, without a bound, with what others found."""
    rows.append({"case": case, "scheme": scheme, "n": n, "what": what, "value": str(value), "bound": beside, "good": True,
                 "seconds": round(float(seconds), 2), "rate": None})
    print(line(rows[-1]), flush=True)


def attempt(case, scheme, n, measure):
    """Calls measure(); a run that breaks down is a missed figure with the program's message, and the others go on."""
    try:
        measure()
    except Broken as broken:
        rows.append({"case": case, "scheme": scheme, "n": n, "what": "runs to the end", "value": str(broken).replace("|", "/")[:160],
                     "bound": "status 0", "good": False, "seconds": 0., "rate": None})
        print(line(rows[-1]), flush=True)


def document(scene):
    """A scene of scenes/ or scenes/verification/ as dictionaries."""
    return tomllib.loads(next(p for p in (SCENES / f"{scene}.toml", ROOT / f"scenes/{scene}.toml") if p.exists()).read_text())


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
