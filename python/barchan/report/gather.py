"""All that a report says of a run, read from its folder. What is missing is None or empty, and a remark says why: a report of a broken run is needed most."""

import dataclasses
import datetime
import hashlib
import json
import os
import pathlib
import socket
import subprocess
import tomllib

from .. import files, program
from ..errors import BarchanError, NoSeries, SceneError, Unreadable
from ..run_scene import MOST_OF_A_SCENE, belongs, candidates, with_settings
from ..series import Series, Tables, open as open_series
from .shapes import RUN, SALTATION, fitting

STATUS = {"end": 0, "TERMINATE": 0, "breakdown": 3, "output failed": 4, "SIGHUP": 129, "SIGINT": 130, "SIGQUIT": 131, "SIGTERM": 143, "SIGXCPU": 152}
MOST_SECONDS_OF_PLAN = 120


@dataclasses.dataclass(frozen=True)
class Begin:
    """The bytes by which one tells a kind of file, and where they stand."""
    start: int
    word: bytes


PNG, MP4 = Begin(0, b"\x89PNG\r\n\x1a\n"), Begin(4, b"ftyp")


@dataclasses.dataclass
class Gathered:
    folder: pathlib.Path
    name: str
    run: dict                       # run.json, as far as its values have the types that they should have
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
        end = self.plan.get("end") if self.plan else self.said("time", "end")
        return end if isinstance(end, (int, float)) else None

    def said(self, *keys):
        """What the scene says under these keys, None where it says nothing."""
        at = self.scene
        for key in keys:
            at = at.get(key) if isinstance(at, dict) else None
        return at


def gather(folder, with_plan=True, scene=None):
    """Reads the run in this folder; `scene`: the file of its scene, where a person names it. Throws NoSeries if there is none, SceneError for a `scene` that is none."""
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
    run, written = {}, ""
    try:
        run = fitting(files.document(files.below(folder, folder / "run.json")), RUN, "run.json", remarks)
        written = datetime.datetime.fromtimestamp((folder / "run.json").stat().st_mtime, datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
    except (Unreadable, OSError, OverflowError, ValueError) as error:  # a file may have any date
        remarks.append(f"{folder / 'run.json'} cannot be read: {error}")
    g = Gathered(folder, series.name if series else pathlib.PurePath(run.get("scene", {}).get("file", folder.name)).stem, run, series, remarks=remarks, written=written)
    g.reason = run.get("end_reason", "")
    g.state, g.status = state_of(run)
    read_tables(g)
    read_scene(g, scene)
    if with_plan:
        read_plan(g)
    g.pictures, g.films = pictures_of(g)
    return g


def pictures_of(g):
    """The pictures and the films in the folder `pictures` of the run: files of these formats that lie there, none that a link leads to elsewhere."""
    def those(ending, begin):
        found = []
        for file in sorted((g.folder / "pictures").glob(f"*.{ending}")):
            try:
                with files.opened(files.below(g.folder, file)) as content:
                    if content.read(12)[begin.start:].startswith(begin.word):
                        found.append(file)
                    else:
                        g.remarks.append(f"{file}: is no .{ending}")
            except (Unreadable, OSError) as error:
                g.remarks.append(str(error))
        return found
    return those("png", PNG), those("mp4", MP4)


def state_of(run):
    """How a run stands and its exit status, from run.json: a run that is `running` though its process has gone was killed."""
    reason = run.get("end_reason", "")
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
    process = int(run.get("process", 0))
    if not 0 < process < 1 << 31:
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        pass
    try:  # numbers of processes are used again
        return b"barchan" in pathlib.Path(f"/proc/{process}/cmdline").read_bytes()
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
    source = Series(g.folder / f"{g.name}.pvd", [])  # knows the names of files, reads no frame
    g.history = attempt(lambda: source.history, None)
    listed = {name for each in g.run.get("measured", []) for name in each.get("files", [])}
    g.profiles, g.grids, g.saltation = attempt(lambda: source.profiles, Tables()), attempt(lambda: source.grids, {}), attempt(lambda: source.saltation, {})
    g.saltation = {name: fitting(said, SALTATION, f"saltation_{name}.json", g.remarks) for name, said in g.saltation.items()}
    if listed:  # a folder may hold tables of another run
        g.profiles = Tables({name: each for name, each in g.profiles.items() if f"{name}.csv" in listed})


def read_scene(g, named=None):
    """The text of the scene: of a file that belongs to the run (run_scene.py), or that a person has `named`."""
    said = g.run.get("scene", {}).get("file", "")
    g.scene_file = said
    if named is not None:
        try:
            show_scene(g, pathlib.Path(named))
        except Unreadable as error:
            raise SceneError(f"--scene {error}") from error
        return
    if not said:
        return
    there = candidates(g.folder, said)
    for place in there:
        if belongs(g.folder, place, g.run.get("scene", {}).get("sha256", "")):
            try:
                return show_scene(g, place)
            except Unreadable as error:
                g.remarks.append(str(error))
    lost = "its text is not shown, and the plan of the run is unknown; --scene FILE names the file"
    if not there:
        g.remarks.append(f"the scene's file {said} is no longer there: {lost}")
    elif g.scene_text is None:
        g.remarks.append(f"{said} is no scene in the folder of the run, nor has it the checksum that run.json states (it was changed, or it is another file): {lost}")


def show_scene(g, place):
    """Takes the text of this file for that of the scene. Throws Unreadable for what is no scene."""
    content = files.content(place, MOST_OF_A_SCENE)
    try:
        text = content.decode()
        scene = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise Unreadable(f"{place}: is no scene: {str(error)[:200]}") from error
    if not isinstance(scene.get("phases"), dict):
        raise Unreadable(f"{place}: is no scene: it has no phases")
    g.scene_file, g.scene_text = str(place), text
    g.scene = with_settings(scene, g.run.get("scene", {}).get("set", []))
    checksum = g.run.get("scene", {}).get("sha256")
    if checksum and checksum != hashlib.sha256(content).hexdigest():
        g.remarks.append(f"{place} was changed after the run began, or is another file: text and plan on this page are those of the file as it is now")


def read_plan(g):
    """What `barchan plan` says of the scene with the settings of the run."""
    if g.scene_text is None:
        return
    try:
        words = [str(program.find_program()), "plan", str(pathlib.Path(g.scene_file).absolute()), "--json", *program.settings(g.run.get("scene", {}).get("set", []))]
        ended = subprocess.run(words, capture_output=True, text=True, timeout=MOST_SECONDS_OF_PLAN, stdin=subprocess.DEVNULL)
        if ended.stdout.strip().startswith("{"):
            g.plan = json.loads(ended.stdout)
        if ended.returncode:
            g.remarks.append("barchan plan: " + ended.stderr.strip().removeprefix("barchan: ")[:600])
    except subprocess.TimeoutExpired:
        g.remarks.append(f"barchan plan took longer than {MOST_SECONDS_OF_PLAN} s: the matrix has no neighbours and sums (--no-plan leaves it out)")
    except (BarchanError, OSError, ValueError) as error:
        g.remarks.append(f"barchan plan: {error}")
