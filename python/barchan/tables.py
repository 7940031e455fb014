"""Tables that a run writes (.csv): history, probes, profiles."""

import pathlib

import numpy

from . import files
from .errors import Unreadable, UnknownName, package


def bare(name):
    """The name of a column without its unit."""
    return name.split(" [")[0]


class Table(dict):
    """Columns of a .csv by their names, "time [s]" for example, in the file's order; a name without its unit finds its column too. Each is an array (rows,)."""

    path = None

    def __missing__(self, name):
        found = [full for full in self if bare(full) == name]
        if len(found) != 1:
            raise UnknownName.of("column", name, self, self.path or "table")
        return self[found[0]]

    def __contains__(self, name):
        return dict.__contains__(self, name) or any(bare(full) == name for full in self)

    def unit(self, name):
        """The unit of a column, "" if it has none."""
        full = name if dict.__contains__(self, name) else next((f for f in self if bare(f) == name), None)
        if full is None:
            raise UnknownName.of("column", name, self, self.path or "table")
        return full.split(" [")[1].rstrip("]") if " [" in full else ""

    def rows(self):
        """Dictionaries of numbers by names without units, one a row."""
        names = [bare(full) for full in self]
        return [dict(zip(names, map(float, row))) for row in zip(*self.values())]

    @property
    def length(self):
        """Number of rows."""
        return len(next(iter(self.values()), ()))

    def to_pandas(self):
        """A pandas.DataFrame with these columns; `time [s]`, where it is there, is the index."""
        frame = package("pandas", "python3-pandas", "to_pandas()").DataFrame(dict(self))
        return frame.set_index("time [s]") if "time [s]" in frame else frame


def table(path):
    """The columns of a table that a run wrote. Lines that begin with # are remarks; a last line without an end was cut off and is left out.
    Throws Unreadable."""
    path = pathlib.Path(path)
    text = files.text(path, files.MOST_OF_A_TABLE)
    lines = [line for line in text[:text.rfind("\n") + 1].split("\n") if line and not line.startswith("#")]
    if not lines:
        raise Unreadable(f"{path}: the first line, with the names of the columns, is missing")
    names = lines[0].split(",")
    try:
        values = numpy.loadtxt(lines[1:], delimiter=",", ndmin=2, comments=None) if len(lines) > 1 else numpy.empty((0, len(names)))
    except (ValueError, MemoryError) as error:
        raise Unreadable(f"{path}: {error}") from error
    if values.shape[1] != len(names):
        raise Unreadable(f"{path}: {len(names)} names of columns, but rows of {values.shape[1]} numbers")
    result = Table(zip(names, values.T))
    result.path = path
    return result
