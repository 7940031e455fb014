"""Steps a run from Python: reads fields between steps, changes the controls of the scene, stops."""

import json
import math
import os
import pathlib
import subprocess
import tempfile
from collections.abc import MutableMapping

import numpy

from .errors import Breakdown, Mistake, ProgramNotFound, SceneError, Stopped, UnknownName, UsageError, error_of
from .program import _SceneFile, _series, _warn, _warnings_of, find_program, settings


class Controls(MutableMapping):
    """The numbers of [controls] by their names. Setting one acts from the next step on. Throws UnknownName, which lists the controls, and UsageError for what is no finite number."""

    def __init__(self, simulation, values):
        self._simulation, self._values = simulation, values

    def __getitem__(self, name):
        return self._values[self._known(name)]

    def __setitem__(self, name, value):
        self._simulation._ask({"do": "control", "name": self._known(name), "value": _finite(value, f"the control {name!r}")})
        self._values[name] = float(value)

    def __delitem__(self, name):
        raise UsageError(f"the control {self._known(name)!r} cannot be deleted: it belongs to the scene")

    def __repr__(self):
        return repr(dict(self._values))

    def __iter__(self):
        return iter(self._values)

    def __len__(self):
        return len(self._values)

    def _known(self, name):
        if name not in self._values:
            raise UnknownName.of("control", name, self._values, "the scene")
        return name


def _finite(value, what):
    """The value as a float. Throws UsageError for what is no finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise UsageError(f"{what}: {value!r} is no finite number")
    return number


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
        """Starts it, and waits before the first step. Arguments as of `barchan.run`. Throws SceneError, Mistake, ProgramNotFound; afterwards wrong calls throw UsageError or UnknownName."""
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
                raise UsageError(f"the scene has several phases: expected sim[{field!r}, PHASE] with one of {', '.join(phases)}")
            phase = next(iter(phases))
        if phase not in phases:
            raise UnknownName.of("phase", phase, phases, "the scene")
        if field != "id" and field not in phases[phase]["fields"]:
            raise UnknownName.of("field", field, ["id", *(name for name in phases[phase]["fields"] if name != "id")], f"the phase {phase!r}")
        heading = self._ask({"do": "array", "phase": phase, "field": field})
        values = numpy.frombuffer(self._answers.read(heading["bytes"]), dtype=heading["type"])
        return values if heading["columns"] == 1 else values.reshape(heading["rows"], heading["columns"])

    def step(self, count=1):
        """Makes `count` steps, fewer where the scene ends. Throws UsageError after the end of the scene and after close()."""
        if not _finite(count, "count") >= 0 or int(count) != count:
            raise UsageError(f"count: expected a whole number of steps, 0 or more, found {count!r}")
        self._go({"do": "steps", "count": int(count)})

    def run(self, until=None, every=None, call=None):
        """Steps to the time `until` (s; default: the end of the scene), to the end of the step in which it lies. With `call` it calls `call(self)` every `every` seconds of the run, or after
        each step without `every`, and stops when that returns False. Throws UsageError for wrong arguments, after the end of the scene and after close()."""
        until = 1e300 if until is None or until == math.inf else _finite(until, "until")
        if call is not None and not callable(call):
            raise UsageError(f"call: expected a function of the simulation, found {call!r}")
        if every is not None and (call is None or not _finite(every, "every") > 0):
            raise UsageError("every: expected the seconds of the run between two calls, above 0, and a function `call`")
        self._open()
        if call is None:
            return self._go({"do": "until", "time": until})
        k = int(self.time / every) + 1 if every else 0
        while not self.ended and self.time < until * (1 - 1e-12):
            self._go({"do": "until", "time": min(k * every, until)} if every else {"do": "steps", "count": 1})
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
        self._open()
        if self.ended:
            raise UsageError(f"the run has ended, at t = {self.time:g} s: expected a scene with a later time.end")
        self._state.update(self._ask(request))
        self.time, self.steps, self.ended = self._state["time"], self._state["steps"], self._state["ended"]

    def _update(self):
        self._state = self._ask({"do": "state"})
        self.time, self.steps, self.ended = self._state["time"], self._state["steps"], self._state["ended"]

    def _open(self):
        """Throws UsageError after close() and after the end of the program."""
        if self._process.returncode is not None:
            raise UsageError(f"the simulation is closed, at t = {self.time:g} s: its frames are in `series`; to step on, start barchan.Simulation(..., restart=\"latest\")")

    def _ask(self, request):
        self._open()
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
