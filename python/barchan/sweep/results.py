"""The table of a sweep: for each case the values of its keys, how it ended, and what was asked of its history."""

import csv
import io
import math
import pathlib
import re

import numpy

from .. import files
from ..errors import BarchanError, SceneError, UnknownName, Unreadable, nearest
from ..report.shapes import RUN, fitting
from ..tables import bare, table

WAYS = {"last": lambda v: v[-1], "first": lambda v: v[0], "mean": numpy.mean, "max": numpy.max, "min": numpy.min}
USUAL = (("largest_speed", "max"), ("largest_density_error", "max"))  # of every history; besides, the means of these columns:
USUAL_MEANS = r".*(_flux|friction_velocity)$"


def measure(text):
    """(column, way) of COLUMN[:last|first|mean|max|min]. Throws SceneError."""
    column, colon, way = text.rpartition(":")
    if not colon:
        return text, "last"
    if way not in WAYS or not column:
        raise SceneError(f"--measure {text}: expected COLUMN or COLUMN:{'|'.join(WAYS)}{nearest(way, WAYS)}")
    return column, way


def usual(folders):
    """The measures of a sweep that names none."""
    for folder in folders:
        try:
            names = [bare(full) for full in table(folder / "history.csv")]
        except BarchanError:
            continue
        return [each for each in USUAL if each[0] in names] + [(name, "mean") for name in names if re.fullmatch(USUAL_MEANS, name)]
    return list(USUAL)


def value(history, column, way, start):
    """A measure of one history, over its rows from the time `start` on; nan if there is none."""
    v = history[column]
    v = v[history["time"] >= start] if start else v
    return float(WAYS[way](v)) if len(v) else math.nan


def row(ended, measures, start=0.):
    """A line of the table, as a dictionary; and the names of columns that this history does not have, with a message for each."""
    run, missing = {}, {}
    try:
        run = fitting(files.document(files.below(ended.folder, ended.folder / "run.json")), RUN, "run.json", [])
    except Unreadable:
        pass
    line = {"run": ended.folder.name, **ended.case.values, "status": ended.status, "end_reason": reason(ended, run), "simulated_time": run.get("simulated_time", math.nan),
            "steps": run.get("steps", 0), "wall_seconds": run.get("wall_seconds", math.nan)}
    history = None
    try:
        history = table(files.below(ended.folder, ended.folder / "history.csv")) if run else None
    except BarchanError:
        pass
    for column, way in measures:
        line[f"{column}:{way}"] = math.nan
        if history is None or not history.length:
            continue
        try:
            line[f"{column}:{way}"] = value(history, column, way, start)
        except UnknownName as error:
            missing[column] = error.message
    return line, missing


def reason(ended, run):
    """Why a run ended, in one line."""
    if ended.status == 2 or not run.get("end_reason") or run["end_reason"] == "running":
        lines = [each.removeprefix("barchan: ") for each in ended.said.splitlines() if each and not each.startswith("barchan: warning:")]
        return lines[0] if lines else f"ended with status {ended.status}"
    return " ".join(str(run["end_reason"]).split())


def write(file, lines):
    """The table as a .csv, whole or not at all; nan where nothing was measured."""
    out = io.StringIO(newline="")
    writer = csv.DictWriter(out, list(lines[0]) if lines else ["run"], lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: repr(v) if isinstance(v, float) else v for key, v in line.items()} for line in lines)
    files.write_whole(file, out.getvalue())


def read(file):
    """The table of a sweep, from its folder or its .csv: a list of dictionaries; numbers are float where a column holds nothing but numbers."""
    file = pathlib.Path(file)
    with (file / "sweep.csv" if file.is_dir() else file).open(newline="") as source:
        lines = list(csv.DictReader(source))
    for key in lines[0] if lines else ():
        try:
            numbers = [float(line[key]) for line in lines]
        except ValueError:
            continue
        for line, number in zip(lines, numbers):
            line[key] = number
    return lines
