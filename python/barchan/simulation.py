"""Steps a run from Python: reads fields between steps, changes the controls of the scene, stops."""

import json
import os
import pathlib
import subprocess
import tempfile
from collections.abc import MutableMapping

import numpy

from .errors import Breakdown, Mistake, ProgramNotFound, SceneError, Stopped, UnknownName, error_of, nearest
from .program import _SceneFile, _series, _warn, _warnings_of, find_program, settings


class Controls(MutableMapping):
    """The numbers of [controls] by their names. Setting one acts from the next step on."""

    def __init__(self, simulation, values):
        self._simulation, self._values = simulation, values

    def __getitem__(self, name):
        return self._values[self._known(name)]

    def __setitem__(self, name, value):
        self._simulation._ask({"do": "control", "name": self._known(name), "value": float(value)})
        self._values[name] = float(value)

    def __delitem__(self, name):
        raise Mistake("a control of the scene stays")

    def __iter__(self):
        return iter(self._values)

    def __len__(self):
        return len(self._values)

    def _known(self, name):
        if name not in self._values:
            raise UnknownName(f"the scene has no control {name!r}{nearest(name, list(self._values))}")
        return name


class Simulation:
    """A run that goes on when it is told to. It writes the frames, the history and the checkpoint of `barchan run`, with the same bits as long as no control is set.

        with barchan.Simulation("scene.toml") as sim:
            while sim.time < 1:
                sim.step(100)
                if sim["velocity", "sand"][:, 0].max() > 2:
                    sim.controls["pull"] = 0

    The program runs as a process of its own: its end does not end Python. A failed step ends it (`run` goes back to an earlier one) and raises Breakdown.
    """

    def __init__(self, scene, out=None, set=None, threads=None, restart=None, instructions=None, name="scene", program=None):
        """Starts it, and waits before the first step. Arguments as of `barchan.run`. Throws SceneError, Mistake, ProgramNotFound."""
        out = None if out is None else pathlib.Path(out)
        self._file = _SceneFile(scene, out or pathlib.Path("out") / name, name)
        self.out = out or pathlib.Path("out") / self._file.path.stem
        options = [word for key, value in (("--threads", threads), ("--restart", restart), ("--instructions", instructions)) if value is not None for word in (key, value)]
        requests, self._requests = os.pipe()
        self._answers, answers = os.pipe()
        self._said = tempfile.TemporaryFile()
        words = [program or find_program(), "run", self._file.path, "--out", self.out, "--quiet", "--steering", f"{requests},{answers}", *options, *settings(set)]
        try:
            self._process = subprocess.Popen([str(word) for word in words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=self._said, pass_fds=(requests, answers))
        except OSError as error:
            raise ProgramNotFound(f"{words[0]}: {error}") from error
        finally:
            os.close(requests)
            os.close(answers)
        self._answers = os.fdopen(self._answers, "rb")
        self.series = None  # barchan.Series, after close()
        self._update()
        self.controls = Controls(self, self._state["controls"])

    @property
    def phases(self):
        """Names of the phases, with the number of their particles and the names of their fields."""
        self._update()
        return self._state["phases"]

    @property
    def history(self):
        """The row of history.csv of now, a dictionary of its columns."""
        row = self._ask({"do": "history"})
        return dict(zip(row["names"], row["values"]))

    def __getitem__(self, key):
        """`sim["velocity", "sand"]`: a field of a phase as an array, one row a particle, in the order of the ids; positions in a periodic domain may lie outside of it. "id": the ids."""
        field, phase = key if isinstance(key, tuple) else (key, None)
        phases = self._state["phases"]
        if phase is None:
            if len(phases) > 1:
                raise Mistake(f"the scene has several phases: expected sim[{field!r}, PHASE] with one of {', '.join(phases)}")
            phase = next(iter(phases))
        if phase not in phases:
            raise UnknownName(f"the scene has no phase {phase!r}{nearest(phase, list(phases))}")
        if field not in phases[phase]["fields"]:
            raise UnknownName(f"the phase {phase!r} has no field {field!r}{nearest(field, phases[phase]['fields'])}")
        heading = self._ask({"do": "array", "phase": phase, "field": field})
        values = numpy.frombuffer(self._answers.read(heading["bytes"]), dtype=heading["type"])
        return values if heading["columns"] == 1 else values.reshape(heading["rows"], heading["columns"])

    def step(self, count=1):
        """Makes `count` steps, fewer where the scene ends."""
        self._go({"do": "steps", "count": int(count)})

    def run(self, until=None, every=None, call=None):
        """Steps to the time `until` (s; the end of the scene), to the end of the step in which it lies. Every `every` seconds it calls `call(self)`, and stops when that
        returns False."""
        until = float("inf") if until is None else float(until)
        if call is None:
            return self._go({"do": "until", "time": min(until, 1e300)})
        if not every or not every > 0:
            raise Mistake("expected every > 0, the seconds of the run between two calls")
        k = int(self.time / every) + 1
        while not self.ended and self.time < until * (1 - 1e-12):
            self._go({"do": "until", "time": min(k * every, until)})
            k += 1
            if call(self) is False:
                return None
        return None

    def close(self):
        """Ends the run, with a last frame and a checkpoint, and returns its series (barchan.Series)."""
        if self._process.returncode is None:
            os.close(self._requests)
            self._end()
        return self.series

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _go(self, request):
        if self.ended:
            raise Mistake(f"the run has ended, at t = {self.time:g} s: expected a scene with a later time.end")
        self._state.update(self._ask(request))
        self.time, self.steps, self.ended = self._state["time"], self._state["steps"], self._state["ended"]

    def _update(self):
        self._state = self._ask({"do": "state"})
        self.time, self.steps, self.ended = self._state["time"], self._state["steps"], self._state["ended"]

    def _ask(self, request):
        if self._process.returncode is not None:
            raise Mistake("the simulation is closed: expected a new one")
        try:
            os.write(self._requests, (json.dumps(request) + "\n").encode())
        except BrokenPipeError:
            pass  # the program has ended: there is no answer
        line = self._answers.readline()
        if not line:
            os.close(self._requests)
            self._end()
            raise Stopped(f"the run ended at t = {self.time:g} s")
        answer = json.loads(line)
        if "error" in answer:
            raise Mistake(answer["error"])
        return answer

    def _end(self):
        """The program is at its end, or on its way there."""
        status = self._process.wait()
        self._answers.close()
        self._said.seek(0)
        complained = self._said.read().decode(errors="replace")
        self._said.close()
        self.series = _series(self.out, self._file.path.stem)
        if status:
            error = error_of(status, complained)
            if isinstance(error, SceneError):
                self._file.take_back()
            if isinstance(error, (Breakdown, Stopped)):
                error.series = self.series
            raise error
        _warn(_warnings_of(complained))
