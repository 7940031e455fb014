"""Starts Barchan and other commands. No other file of bench/ starts a process (tests/cli/test_bench_measuring.py).

`scene` runs a scene to its end: a file, the name of one in scenes/, or its text. `generate` writes the particles with which a scene begins. `command` runs
any other command line to its end, `start` only starts one. A program needs numpy and VTK only when it asks an `Ended` for a history or a series.
"""

import dataclasses
import json
import os
import pathlib
import subprocess
import tempfile
import threading
import time

from barchan_bench import ROOT

DEVNULL, PIPE = subprocess.DEVNULL, subprocess.PIPE
TimedOut = subprocess.TimeoutExpired  # of the methods of what `start` returns


class Broken(RuntimeError):
    """A command that did not end with status 0; the message has its status and the beginning of what it said, `ended` all of it."""

    def __init__(self, message, ended=None):
        super().__init__(message)
        self.ended = ended


class Seconds(float):
    """User CPU seconds, and the particle-steps done in them."""
    work = 0.0

    @classmethod
    def of(cls, user, report):
        """`user` seconds of the run with this run.json."""
        seconds = cls(user)
        seconds.work = float(report["steps"]) * sum(report["particles"].values())
        return seconds

    def __add__(self, other):
        total = Seconds(float(self) + float(other))
        total.work = self.work + getattr(other, "work", 0.0)
        return total

    __radd__ = __add__


@dataclasses.dataclass
class Ended:
    """A command that has ended; of a run of a scene, its folder too."""
    status: int | None  # exit status; negative: the signal that ended it; None: it took longer than its time-out
    stdout: str
    stderr: str
    user: float         # user CPU seconds of this command and what it started, not of others that run at the same time
    wall: float         # s
    memory: int         # kB, the largest resident set
    scene: pathlib.Path | None = None
    out: pathlib.Path | None = None
    report: dict | None = None  # run.json, if the run wrote one

    def checked(self, what):
        """Throws Broken unless the status is 0; returns itself."""
        if self.status != 0:
            raise Broken(f"{what} ended with status {self.status}: {self.stderr.strip()[:300]}", self)
        return self

    @property
    def name(self):
        """Of the series: the scene's file without its ending."""
        return self.scene.stem

    def history(self, file="history.csv"):
        """A table that the run wrote (frame.Table)."""
        from barchan_bench import frame
        return frame.table(self.out / file)

    def series(self):
        """Times and files of the frames, in order."""
        from barchan_bench import frame
        return frame.series(self.out / f"{self.name}.pvd")

    @property
    def seconds(self):
        """User CPU seconds with the particle-steps done in them."""
        return Seconds.of(self.user, self.report)


def start(words, *, environment=None, folder=None, stdout=None, stderr=None):
    """Starts a command line and returns at once: a subprocess.Popen (pid, poll, send_signal, wait, communicate). `environment`: variables beside the
    own ones; `folder`: where it runs; `stdout`, `stderr`: None leaves them as they are, PIPE gives them to communicate, DEVNULL drops them."""
    return subprocess.Popen([str(word) for word in words], stdout=stdout, stderr=stderr, text=True, cwd=folder,
                            env={**os.environ, **environment} if environment else None)


def command(words, *, environment=None, folder=None, timeout=None, check=False, shown=False):
    """Runs a command line to its end. After `timeout` seconds it is killed. With `check` a status other than 0 throws Broken. With `shown` all that it
    says goes to the terminal while it runs, and the texts of the result are empty."""
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as complained:
        begin, late = time.monotonic(), []
        process = start(words, environment=environment, folder=folder, stdout=None if shown else said, stderr=None if shown else complained)
        timer = threading.Timer(timeout, lambda: (late.append(True), process.kill())) if timeout else None
        try:
            if timer:
                timer.start()
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        except BaseException:  # Ctrl-C, for example
            process.kill()
            process.wait()
            raise
        finally:
            if timer:
                timer.cancel()
        wall = time.monotonic() - begin
        texts = []
        for file in (said, complained):
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
    ended = Ended(None if late else process.returncode, *texts, used.ru_utime, wall, used.ru_maxrss)
    return ended.checked(" ".join(map(str, words[:3])) + " ...") if check else ended


def scene_file(scene, folder=None, name="case.toml"):
    """The file of a scene: a text (it has line breaks) is written to folder/name; a name, with its ending or without, is looked for in scenes/ and scenes/verification."""
    if "\n" in str(scene):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(scene)
        return folder / name
    places = [pathlib.Path(scene)] + [ROOT / top / f"{scene}{end}" for top in ("scenes", "scenes/verification") for end in (".toml", "")]
    found = next((place for place in places if place.is_file()), None)
    if found is None:
        raise FileNotFoundError(f"no scene {scene}: neither a file nor a name in scenes/ or scenes/verification/")
    return found


def settings(sets):
    """Options of the command line for settings KEY=VALUE."""
    return [word for each in sets for word in ("--set", each)]


def words(program, scene, out, sets=(), *, threads=1, quiet=True, options=()):
    """The command line of a run of the file `scene` into the folder `out`. `threads`: None leaves the number to the program. `options` stand at the end."""
    return [str(program), "run", str(scene), "--out", str(out), *(["--quiet"] if quiet else []), *(["--threads", str(threads)] if threads else []),
            *settings(sets), *map(str, options)]


def scene(program, scene, out, sets=(), *, threads=1, quiet=True, options=(), before=(), check=True, **more):
    """Runs a scene (see scene_file; a text is kept in `out`) to its end, into the folder `out`. `before`: words in front of the command line; `more`: of
    `command`."""
    out = pathlib.Path(out)
    file = scene_file(scene, out)
    ended = command([*before, *words(program, file, out, sets, threads=threads, quiet=quiet, options=options)], **more)
    ended.scene, ended.out = file, out
    if (out / "run.json").exists():
        ended.report = json.loads((out / "run.json").read_text())
    return ended.checked(file.name) if check else ended


def generate(program, scene, file, sets=(), **more):
    """Writes the particles with which a scene begins into `file`; `more`: of `command`."""
    return command([program, "generate", scene_file(scene), "-o", file, *settings(sets)], **more)


def version(program):
    """What `barchan --version` says."""
    return command([program, "--version"], check=True).stdout
