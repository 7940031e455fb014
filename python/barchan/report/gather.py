"""All that a report says of a run, read from its folder. What is missing is None or empty, and a remark says why: a report of a broken run is needed most."""

import dataclasses
import datetime
import json
import os
import pathlib
import socket
import subprocess
import tomllib

from .. import program
from ..errors import BarchanError, NoSeries
from ..series import Series, Tables, open as open_series
from ..tables import table

STATUS = {"end": 0, "TERMINATE": 0, "breakdown": 3, "output failed": 4, "SIGHUP": 129, "SIGINT": 130, "SIGQUIT": 131, "SIGTERM": 143, "SIGXCPU": 152}
MOST_SECONDS_OF_PLAN = 120


@dataclasses.dataclass
class Gathered:
    folder: pathlib.Path
    name: str
    run: dict                       # run.json
    series: Series | None = None
    state: str = "ended"            # ended, running, killed, broken, stopped, failed
    status: int | None = None       # exit status of the program, None while it runs or when nobody knows
    reason: str = ""                # end_reason
    history: dict | None = None     # tables.Table
    profiles: dict = dataclasses.field(default_factory=dict)
    saltation: dict = dataclasses.field(default_factory=dict)
    grids: dict = dataclasses.field(default_factory=dict)
    plan: dict | None = None
    scene_text: str | None = None
    scene: dict | None = None       # the document, with what --set changed
    scene_file: str = ""
    pictures: list = dataclasses.field(default_factory=list)
    films: list = dataclasses.field(default_factory=list)
    remarks: list = dataclasses.field(default_factory=list)  # what could not be read, and why
    written: str = ""               # when run.json was written

    @property
    def title(self):
        return self.run.get("scene", {}).get("title") or self.name

    @property
    def end_time(self):
        """The time.end of the scene in s, None if nobody knows."""
        if self.plan:
            return self.plan.get("end")
        return (self.scene or {}).get("time", {}).get("end")


def gather(folder, with_plan=True):
    """Reads the run in this folder. Throws NoSeries if there is none, SceneError if it cannot be read at all."""
    folder = pathlib.Path(folder)
    remarks = []
    series = None
    try:
        series = open_series(folder)
    except BarchanError as error:
        if not (folder / "run.json").is_file():
            raise NoSeries(f"{error.message}; a report needs the folder of a run, as out/dune") from error
        remarks.append(error.message)
    folder = series.folder if series else folder
    try:
        run = json.loads((folder / "run.json").read_text())
        written = datetime.datetime.fromtimestamp((folder / "run.json").stat().st_mtime, datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
    except (OSError, ValueError) as error:
        run, written = {}, ""
        remarks.append(f"{folder / 'run.json'} cannot be read: {error}")
    g = Gathered(folder, series.name if series else pathlib.Path(run.get("scene", {}).get("file", folder.name)).stem, run, series, remarks=remarks, written=written)
    g.reason = str(run.get("end_reason", ""))
    g.state, g.status = state_of(run)
    read_tables(g)
    read_scene(g)
    if with_plan:
        read_plan(g)
    pictures = folder / "pictures"
    g.pictures, g.films = sorted(pictures.glob("*.png")), sorted(pictures.glob("*.mp4"))
    return g


def state_of(run):
    """How a run stands and its exit status, from run.json: a run that is `running` though its process has gone was killed."""
    reason = str(run.get("end_reason", ""))
    if not reason:
        return "killed", None
    if reason == "running":
        return ("running" if is_alive(run) else "killed"), None
    head = reason.split(":")[0]
    state = {"end": "ended", "TERMINATE": "ended", "breakdown": "broken", "output failed": "failed", "failed": "failed"}.get(head, "stopped")
    return state, STATUS.get(head)


def is_alive(run):
    """Whether the process of a run is there. Of another machine nobody knows: then it counts as running."""
    if run.get("host") != socket.gethostname():
        return True
    try:
        os.kill(int(run["process"]), 0)
    except (KeyError, TypeError, ValueError, ProcessLookupError):
        return False
    except PermissionError:
        pass
    try:  # numbers of processes are used again
        return b"barchan" in pathlib.Path(f"/proc/{run['process']}/cmdline").read_bytes()
    except OSError:
        return True


def read_tables(g):
    """history.csv and what the scene measures."""
    def attempt(read, default):
        try:
            return read()
        except (BarchanError, OSError, ValueError) as error:
            g.remarks.append(str(error))
            return default
    g.history = attempt(lambda: table(g.folder / "history.csv"), None)
    listed = {name for each in g.run.get("measured", []) for name in each.get("files", [])}
    source = Series(g.folder / f"{g.name}.pvd", [])  # knows the names of files, reads no frame
    g.profiles, g.grids, g.saltation = attempt(lambda: source.profiles, Tables()), attempt(lambda: source.grids, {}), attempt(lambda: source.saltation, {})
    if listed:  # a folder may hold tables of another run
        g.profiles = Tables({name: each for name, each in g.profiles.items() if f"{name}.csv" in listed})


def read_scene(g):
    """The text of the scene's file, if it is still there."""
    said = g.run.get("scene", {}).get("file", "")
    g.scene_file = said
    if not said:
        return
    places = [pathlib.Path(said)] + [above / said for above in g.folder.absolute().parents] + [g.folder / pathlib.Path(said).name]
    found = next((place for place in places if place.is_file()), None)
    if not found:
        g.remarks.append(f"the scene's file {said} is no longer there: its text is not shown, and the plan of the run is unknown")
        return
    g.scene_file = str(found)
    try:
        g.scene_text = found.read_text()
        g.scene = with_settings(tomllib.loads(g.scene_text), g.run.get("scene", {}).get("set", []))
    except (OSError, ValueError) as error:
        g.remarks.append(f"{found}: {error}")
    first = g.series.files[0] if g.series and len(g.series) else g.folder / "history.csv"
    if first.exists() and found.stat().st_mtime > first.stat().st_mtime:
        g.remarks.append(f"{found} was changed after the run began: text and plan on this page are those of the file as it is now")


def with_settings(scene, settings):
    """The document with the settings KEY=VALUE of the command line, as the program applies them; what does not fit is left out (the program has refused it)."""
    for each in settings:
        key, _, text = each.partition("=")
        try:
            value = tomllib.loads(f"value = {text}")["value"]
        except tomllib.TOMLDecodeError:
            value = text.strip()  # a word without quotation marks
        *path, last = key.strip().split(".")
        try:
            at = scene
            for part in path:
                at = at[int(part)] if isinstance(at, list) else at.setdefault(part, {})
            at[int(last) if isinstance(at, list) else last] = value
        except (LookupError, ValueError, TypeError, AttributeError):
            continue
    return scene


def read_plan(g):
    """What `barchan plan` says of the scene with the settings of the run."""
    if g.scene_text is None:
        return
    try:
        words = [str(program.find_program()), "plan", g.scene_file, "--json", *program.settings(g.run.get("scene", {}).get("set", []))]
        ended = subprocess.run(words, capture_output=True, text=True, timeout=MOST_SECONDS_OF_PLAN, stdin=subprocess.DEVNULL)
        if ended.stdout.strip().startswith("{"):
            g.plan = json.loads(ended.stdout)
        if ended.returncode:
            g.remarks.append("barchan plan: " + ended.stderr.strip().removeprefix("barchan: ")[:600])
    except subprocess.TimeoutExpired:
        g.remarks.append(f"barchan plan took longer than {MOST_SECONDS_OF_PLAN} s: the matrix has no neighbours and sums (--no-plan leaves it out)")
    except (BarchanError, OSError, ValueError) as error:
        g.remarks.append(f"barchan plan: {error}")
