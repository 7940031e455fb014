"""Starts the program: run, plan, generate, compare, schema. Errors of the program are exceptions (errors.py)."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import warnings

from . import scene as scenes
from .errors import Breakdown, ProgramNotFound, SceneError, Stopped, Unreadable, error_of

HERE = pathlib.Path(__file__).resolve().parent


class RunWarning(UserWarning):
    """A warning of the program, of its plan or of a run: Python shows it once, `series.run["warnings"]` keeps it."""


class Difference(list):
    """What `compare` found: a list of dictionaries as `barchan compare --json` prints them. True in an `if` when the two are the same: `if barchan.compare(a, b): ...`."""

    same = False

    def __bool__(self):
        return self.same


def find_program():
    """The path of the program: what the environment variable BARCHAN_PROGRAM names, else the one beside this package (build/barchan of the source tree, bin/barchan of an
    installation), else the first in PATH. Throws ProgramNotFound."""
    named = os.environ.get("BARCHAN_PROGRAM")
    if named:
        if os.access(named, os.X_OK):
            return pathlib.Path(named)
        raise ProgramNotFound(f"BARCHAN_PROGRAM names {named}, which is no program")
    beside = [HERE.parents[1] / "build/barchan", HERE.parents[3] / "bin/barchan"]  # HERE: ROOT/python/barchan, PREFIX/share/barchan/python/barchan
    for place in beside:
        if place.is_file() and os.access(place, os.X_OK):
            return place
    found = shutil.which("barchan")
    if not found:
        raise ProgramNotFound("there is no program barchan beside this package nor in PATH: build it (scripts/run does), or name it in BARCHAN_PROGRAM")
    return pathlib.Path(found)


def settings(changes):
    """Options --set KEY=VALUE for a dictionary of dotted keys; lists of ready KEY=VALUE texts pass through."""
    if changes is None:
        return []
    if isinstance(changes, dict):
        changes = [f"{key}={scenes.value_text(value)}" for key, value in changes.items()]
    return [word for each in changes for word in ("--set", each)]


def _is_text(scene):
    return isinstance(scene, str) and "\n" in scene


class _SceneFile:
    """The file of a scene that is a path, a text (it has line breaks) or a dictionary. A text or a dictionary is written to `folder`/`name`.toml; if the
    program then refuses it, what was made for it goes away again."""

    def __init__(self, scene, folder, name):
        self.made = []
        if isinstance(scene, dict):
            scene = scenes.dumps(scene)
        elif not _is_text(scene):
            self.path = pathlib.Path(scene)
            return
        folder = pathlib.Path(folder)
        while not folder.exists():  # the folders that are made, the innermost first
            self.made.append(folder)
            folder = folder.parent
        self.made.reverse()
        for each in self.made:
            each.mkdir(exist_ok=True)
        self.path = (self.made[-1] if self.made else folder) / f"{name}.toml"
        self.before = self.path.read_text() if self.path.exists() else None
        self.path.write_text(scene)

    def take_back(self):
        """Removes the file, and the folders that were made for it."""
        if not hasattr(self, "before"):
            return
        if self.before is None:
            self.path.unlink(missing_ok=True)
        else:
            self.path.write_text(self.before)
        for each in reversed(self.made):
            if not any(each.iterdir()):
                each.rmdir()


def start(words, program=None, shown=False):
    """Runs the program with these words to its end: (status, standard output, standard error). `shown`: what it says goes to the terminal, too (standard error only after
    the end). Ctrl-C ends it as on a terminal: it finishes its step and writes a checkpoint."""
    words = [str(program or find_program()), *map(str, words)]
    try:
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=None if shown else subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")
    except OSError as error:
        raise ProgramNotFound(f"{words[0]}: {error}") from error
    while True:
        try:
            said, complained = process.communicate()
            break
        except KeyboardInterrupt:  # the program of this terminal has been sent the signal too, and ends well
            process.send_signal(2)
        except BaseException:
            process.kill()
            raise
    if shown and complained:
        sys.stderr.write(complained)
    return process.returncode, said or "", complained


def _warn(texts):
    for text in texts:
        warnings.warn(text, RunWarning, stacklevel=4)


def _warnings_of(complained):
    return [line.removeprefix("barchan: warning: ") for line in complained.splitlines() if line.startswith("barchan: warning: ")]


def run(scene, out=None, set=None, threads=None, restart=None, retreats=None, instructions=None, name="scene", quiet=True, program=None):
    """Runs a scene to its end and returns its series (barchan.Series).

    `scene`: a file, the text of a scene (it has line breaks), or a dictionary; text and dictionary are kept as `out`/`name`.toml, and files that they name are looked for from
    there (the functions of barchan.shapes return whole paths). `out`: the folder (default out/NAME). `set`: a dictionary of dotted keys, {"time.end": 0.01}. `restart`: "latest" or a
    checkpoint. `quiet=False`: progress goes to the terminal. Warnings of the run are given as RunWarning. Throws SceneError, Breakdown, OutputError, Stopped, Mistake.
    """
    out = None if out is None else pathlib.Path(out)
    file = _SceneFile(scene, out or pathlib.Path("out") / name, name)
    out = out or pathlib.Path("out") / file.path.stem
    options = [word for key, value in (("--threads", threads), ("--restart", restart), ("--retreats", retreats), ("--instructions", instructions)) if value is not None
               for word in (key, value)]
    status, _, complained = start(["run", file.path, "--out", out, *(["--quiet"] if quiet else []), *options, *settings(set)], program, shown=not quiet)
    _warn(_warnings_of(complained))
    if status:
        error = error_of(status, complained)
        if isinstance(error, SceneError):
            file.take_back()
        if isinstance(error, (Breakdown, Stopped)):
            error.series = _series(out, file.path.stem)
        raise error
    return _series(out, file.path.stem)


def _series(out, name):
    from .series import Series
    try:
        return Series(out / f"{name}.pvd")
    except (OSError, Unreadable):
        return None


def _with_scene(scene, name, act):
    """act(file) with the file of a scene; that of a text or a dictionary goes away again."""
    import tempfile
    if not isinstance(scene, dict) and not _is_text(scene):
        return act(pathlib.Path(scene))
    with tempfile.TemporaryDirectory() as folder:
        return act(_SceneFile(scene, folder, name).path)


def plan(scene, set=None, threads=None, name="scene", program=None, ranks=None):
    """What a scene will run and what it costs, on so many ranks too, as the dictionary of `barchan plan --json`. Throws as `run` does; a Breakdown of the first steps has it as `plan`."""
    def act(file):
        options = [word for key, value in (("--threads", threads), ("--ranks", ranks)) if value is not None for word in (key, value)]
        status, said, complained = start(["plan", file, "--json", *options, *settings(set)], program)
        found = json.loads(said) if said.strip() else None
        if status:
            error = error_of(status, complained)
            error.plan = found
            raise error
        return found
    return _with_scene(scene, name, act)


def generate(scene, file, set=None, name="scene", program=None):
    """Writes the particles with which a scene begins into a .vtp or .vtu, and returns them (barchan.Frame)."""
    def act(path):
        status, _, complained = start(["generate", path, "-o", file, *settings(set)], program)
        if status:
            raise error_of(status, complained)
        from .frame import Frame
        return Frame(file)
    return _with_scene(scene, name, act)


def compare(a, b, tolerance=0., program=None):
    """Compares two frames, series or folders of runs (paths, or barchan.Series), particle by particle.

    Returns a Difference, which is true when they are the same.
    """
    a, b = (getattr(each, "pvd", each) for each in (a, b))
    status, said, complained = start(["compare", a, b, "--json", "--tolerance", repr(float(tolerance))], program)
    if status not in (0, 1):
        raise error_of(status, complained)
    found = json.loads(said)
    result = Difference(found if isinstance(found, list) else [found])
    result.same = status == 0
    return result


def schema(program=None):
    """The JSON schema of a scene file, as a dictionary."""
    status, said, complained = start(["schema"], program)
    if status:
        raise error_of(status, complained)
    return json.loads(said)


def version(program=None):
    """What `barchan --version` says."""
    status, said, complained = start(["--version"], program)
    if status:
        raise error_of(status, complained)
    return said.strip()
