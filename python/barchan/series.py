"""A run in its folder: its frames, and all that it wrote beside them."""

import functools
import pathlib

import numpy

from . import files
from .errors import NoSeries, UnknownName, Unreadable, nearest, package
from .tables import table

KINDS = ("profile_", "probe_", "gauge_", "wall_shear_", "saltation_")


def entries(pvd):
    """(time in s, file) of each frame that a .pvd lists, in order. Throws Unreadable, also when it names a file that is not below its folder."""
    pvd = pathlib.Path(pvd)
    return [(_time(pvd, each.get("timestep")), files.named(pvd, each.get("file"))) for each in files.xml(pvd).iter("DataSet")]


def _time(pvd, said):
    try:
        time = float(said)
        if numpy.isfinite(time):
            return time
    except (TypeError, ValueError):
        pass
    raise Unreadable(f"{pvd}: timestep={said!r:.60} is no time")


class Tables(dict):
    """What a run measured, by the name of its file without its ending (profile_across); a name alone (across) finds its table if there is one of that name."""

    def __missing__(self, name):
        found = [full for full in self if any(full == kind + str(name) for kind in KINDS)]
        if len(found) != 1:
            raise UnknownName.of("table", name, self, "the run")
        return self[found[0]]


class Series:
    """The frames of a run. `len`, an index (negative from the end), a slice and a loop give frames, each read when it is asked for.

    `folder`, `name`: of the run; `times`: (frames,) in s; `files`: of the frames.
    """

    def __init__(self, pvd, listed=None):
        """`listed`: some of the frames of the .pvd, as `entries` gives them."""
        self.pvd = pathlib.Path(pvd)
        self.folder, self.name = self.pvd.parent, self.pvd.stem
        listed = entries(self.pvd) if listed is None else listed
        self._listed = listed
        self.times = numpy.array([time for time, _ in listed])
        self.files = [file for _, file in listed]

    def __len__(self):
        return len(self.files)

    def __repr__(self):
        span = f", {self.times[0]:g} to {self.times[-1]:g} s" if len(self) else ""
        return f"<barchan.Series {self.pvd}: {len(self)} frames{span}>"

    def __getitem__(self, k):
        if isinstance(k, slice):
            return Series(self.pvd, self._listed[k])
        if not -len(self) <= k < len(self):
            raise IndexError(f"{self.pvd} has {len(self)} frames: there is no frame {k}")
        from .frame import Frame
        time, file = self._listed[k]
        return Frame(files.below(self.folder, file), time)

    def __iter__(self):
        return (self[k] for k in range(len(self)))

    def frame(self, t=None, phase=None, number=None):
        """The frame nearest to the time t (s), or with this number; of one phase only, if it is named. Throws ValueError for a time outside of the run by more
        than half of the time between two frames."""
        if (t is None) == (number is None):
            raise TypeError("frame(t=SECONDS) or frame(number=K)")
        if not len(self):
            raise NoSeries(f"{self.pvd} lists no frame yet")
        if t is not None:
            slack = .5 * numpy.diff(self.times).max() if len(self) > 1 else 1e-12
            if not self.times[0] - slack <= t <= self.times[-1] + slack:
                raise ValueError(f"{self.pvd}: no frame near {t:g} s: the frames go from {self.times[0]:g} to {self.times[-1]:g} s")
            number = int(abs(self.times - t).argmin())
        found = self[number]
        return found if phase is None else found.of(phase)

    @functools.cached_property
    def _first(self):
        if not len(self):
            raise NoSeries(f"{self.pvd} lists no frame yet")
        return self[0]

    @property
    def phases(self):
        """Names of the phases by number."""
        return self._first.phases

    @property
    def kinds(self):
        """Kind of each phase by its name: fluid, grains, ..."""
        return dict(zip(self._first.names, self._first.kinds))

    @property
    def fields(self):
        """Names of the fields of a frame."""
        return self._first.fields

    @property
    def units(self):
        """Units of the fields by name."""
        return self._first.units

    def tracks(self, phase=None, every=1):
        """The ways of particles as one pandas.DataFrame: a row for each particle and frame, by id and time (s), with the columns of Frame.to_pandas(). `phase`: of one phase
        only, else of all; `every`: each so many frames. A particle that enters or leaves has the rows of the frames in which it is."""
        pandas = package("pandas", "python3-pandas", "tracks()")
        frames = [frame if phase is None else frame.of(phase) for frame in self[::every]]
        if not frames:
            raise NoSeries(f"{self.pvd} lists no frame yet")
        return pandas.concat([frame.to_pandas() for frame in frames], keys=[frame.time for frame in frames], names=["time"]).swaplevel().sort_index()

    def bed(self, phase, width=None, every=1, up=None):
        """The surface of the bed of a phase of spheres as one pandas.DataFrame: a row for each time (s) and place x (m), with height and solid (m) and the arguments of Frame.bed().
        Throws SceneError, UsageError."""
        pandas = package("pandas", "python3-pandas", "bed()")
        from .bed import about, bed
        known = about(self.folder)
        beds = [(frame.time, bed(frame, phase, width, up, known)) for frame in self[::every]]
        if not beds:
            raise NoSeries(f"{self.pvd} lists no frame yet")
        tables = [pandas.DataFrame({"height": bed.height, "solid": bed.solid}, index=pandas.Index(bed.x, name="x")) for _, bed in beds]
        return pandas.concat(tables, keys=[time for time, _ in beds], names=["time"])

    @functools.cached_property
    def history(self):
        """history.csv: columns by name (barchan.Table). Read once: open the series again to see later rows of a run that goes on."""
        return table(files.below(self.folder, self.folder / "history.csv"))

    @functools.cached_property
    def profiles(self):
        """What profiles, probes, wall shear and saltation measured: tables by name (barchan.Table)."""
        return Tables({file.stem: table(files.below(self.folder, file)) for kind in KINDS for file in sorted(self.folder.glob(f"{kind}*.csv"))})

    @functools.cached_property
    def grids(self):
        """What [[grid]] measured, by name (barchan.frame.Grid)."""
        from .frame import Grid
        return {file.stem.removeprefix("grid_"): Grid(files.below(self.folder, file)) for file in sorted(self.folder.glob("grid_*.vti"))}

    @functools.cached_property
    def saltation(self):
        """What saltation_NAME.json says, by name."""
        return {file.stem.removeprefix("saltation_"): files.document(files.below(self.folder, file)) for file in sorted(self.folder.glob("saltation_*.json"))}

    @functools.cached_property
    def run(self):
        """run.json as a dictionary: what ran, how fast, why it ended, warnings."""
        return files.document(files.below(self.folder, self.folder / "run.json"))

    @property
    def bad(self):
        """The first bad state of a run that broke down (barchan.Frame), None if there is none."""
        from .frame import Frame
        found = [f for end in (".vtp", ".vtu", ".pvtp", ".pvtu") if (f := self.folder / f"{self.name}_bad{end}").exists()]
        return Frame(files.below(self.folder, found[0])) if found else None


def open(where):
    """The series of a run: of a folder (out/dune) or of a list of frames (out/dune/dune.pvd). Throws NoSeries, Unreadable."""
    where = pathlib.Path(where)
    if where.is_file():
        if where.suffix != ".pvd":
            more = f"; one frame is read with barchan.Frame({str(where)!r})" if where.suffix in (".vtp", ".vtu", ".pvtp", ".pvtu") else ""
            raise NoSeries(f"{where}: expected the folder of a run or a .pvd{more}")
        return Series(where)
    if not where.is_dir():
        beside = [p.name for p in where.parent.iterdir() if p.is_dir()] if where.parent.is_dir() else []
        raise NoSeries(f"{where}: there is no such folder{nearest(where.name, beside)}")
    found = sorted(where.glob("*.pvd"))
    if not found:
        below = sorted(p.parent.name for p in where.glob("*/*.pvd"))
        raise NoSeries(f"{where}: no series (.pvd) in this folder" + (f"; there are some in {', '.join(below[:8])}" if below else ""))
    if len(found) > 1:
        raise NoSeries(f"{where}: {len(found)} series in this folder; name one: {', '.join(p.name for p in found)}")
    return Series(found[0])
