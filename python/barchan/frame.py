"""One frame of a run as NumPy arrays (.vtp, .vtu; in pieces .pvtp, .pvtu), grids (.vti), and the frames that a scene takes for the shape of a fill."""

import pathlib

import numpy

from . import files, vtk_xml
from .errors import Unreadable, UnknownName, package

PARTICLES = ("PolyData", "UnstructuredGrid")


class Frame:
    """The particles of one moment, in the order of their ids: those of two frames stand side by side while none enters or leaves.

    `x`: positions (n, 3), m; `arrays`: the fields by name, SI units, (n,) or (n, components); `time`: s; `names` and `kinds`: of the phases by number;
    `units`: of the fields by name; `domain`: (3, 2) bounds in m or None; `step`, `number`: of the run, or None.

    `frame["velocity"]` is a field of all particles, `frame["velocity", "sand"]` of one phase, `frame.of("sand")` the frame of one phase alone.
    Throws Unreadable for a file that is damaged or holds no particles, UnknownName for a phase or a field that is not there.
    """

    path = None
    step = number = domain = None
    names, kinds, units = (), (), {}

    def __init__(self, path, time=None, phase=None, order="id"):
        """`time`: that of the list of the series, if it is given, else the frame's own; `phase`: only the particles of the phase with this name;
        `order="file"`: as the file has them, which changes whenever the program sorts its particles."""
        self.path = pathlib.Path(path)
        if not files.is_file(self.path):
            raise Unreadable(f"{path}: there is no such frame")
        listed = pieces(self.path)
        parts = [_Particles(file, self.path) for file in listed or [self.path]]
        about = parts[0]
        own = about.numbers("TimeValue")
        self.time = float(own[0]) if time is None and len(own) else time
        if listed:
            self.x, self.arrays = _together(parts, listed, self.path)
        else:
            self.x, self.arrays = about.x, about.arrays
        self.names, self.kinds = about.words("phase_names"), about.words("phase_kinds")
        self.units = dict((line + " ").split(" ", 1) for line in about.words("units") if line)
        self.units = {name: unit.strip() for name, unit in self.units.items()}
        domain = about.numbers("domain")
        self.domain = domain.reshape(3, 2) if domain.shape == (6,) else None
        self.step, self.number = (int(value[0]) if len(value) and value.dtype.kind in "iu" else None for value in (about.numbers("step"), about.numbers("frame")))
        if phase is not None:
            self.keep(self.mask(phase))
        ids = self.arrays.get("id", self.x[:0])
        if order == "id" and ids.ndim == 1 and (ids[1:] < ids[:-1]).any():
            self.keep(numpy.argsort(ids, kind="stable"))

    @property
    def fields(self):
        """Names of the fields."""
        return list(self.arrays)

    @property
    def phases(self):
        """Names of the phases by number."""
        return list(self.names)

    def mask(self, phase):
        """Which particles are of the phase with this name: (n,) of bool."""
        if phase not in self.names:
            raise UnknownName.of("phase", phase, self.names, self.path or "frame")
        return self["phase"] == list(self.names).index(phase)

    def of(self, phase):
        """A frame of the particles of one phase."""
        return self.copy().keep(self.mask(phase))

    def copy(self):
        """A frame that can be cut with `keep` while this one stays."""
        other = object.__new__(type(self))
        other.__dict__.update(self.__dict__)
        return other

    def __getitem__(self, name):
        if isinstance(name, tuple):
            name, phase = name
            return self[name][self.mask(phase)]
        if name in self.arrays:
            return self.arrays[name]
        if name in ("x", "position"):
            return self.x
        raise UnknownName.of("field", name, ["position", *self.arrays], self.path or "frame")

    def __contains__(self, name):
        return name in self.arrays or name == "position"

    def __len__(self):
        return len(self.x)

    def __repr__(self):
        time = "" if self.time is None else f" at {self.time:g} s"
        return f"<barchan.Frame{time}: {len(self)} particles of {', '.join(self.names)}; {', '.join(self.arrays)}>"

    def keep(self, chosen):
        """Only these particles, by a mask or their indices; returns the frame itself."""
        self.x = self.x[chosen]
        self.arrays = {name: values[chosen] for name, values in self.arrays.items()}
        return self

    def bed(self, phase, width=None, up=None):
        """The surface of the bed of a phase of spheres along x, and how much lies there (barchan.bed.Bed, with the arguments of barchan.bed.bed). Throws SceneError, UsageError."""
        from .bed import bed
        return bed(self, phase, width, up)

    def to_pandas(self):
        """A pandas.DataFrame, one row a particle, with its id as the index: x, y, z, the name of its phase, and the fields, vectors as velocity_x, ..."""
        pandas = package("pandas", "python3-pandas", "to_pandas()")
        columns = dict(zip("xyz", self.x.T))
        for name, values in self.arrays.items():
            ends = {3: "xyz", 6: ("xx", "yy", "zz", "xy", "yz", "xz")}.get(values.shape[1] if values.ndim == 2 else 1, ())
            columns.update({f"{name}_{end}": values[:, k] for k, end in enumerate(ends)} if len(ends) else {name: values})
        frame = pandas.DataFrame(columns)
        if "phase" in frame and self.names:
            frame["phase"] = pandas.Categorical.from_codes(frame["phase"], list(self.names))
        return frame.set_index("id") if "id" in frame else frame


class _Particles:
    """What stands in one file: `x`, `arrays`, and what it says about all of them. `frame`: the file of the frame, for messages."""

    def __init__(self, path, frame):
        if not files.is_file(path):
            raise Unreadable(f"{frame}: its piece {path} is not there" if path != frame else f"{path}: there is no such frame")
        self._document = vtk_xml.Document(path, PARTICLES)
        count, points = self._document.count("NumberOfPoints"), self._document.sections.get("Points", [])
        if len(points) != 1 or points[0].components != 3:
            raise Unreadable(f"{path}: no particles: the file is damaged or no frame (.vtp or .vtu, in pieces .pvtp or .pvtu)")
        self.x = self._document.numbers(points[0], count).reshape(count, 3)
        self.arrays = {name: self._document.numbers(array, count) for name, array in self._document.named("PointData").items()}

    def numbers(self, name):
        """The values of an array of the frame as a whole in one row; an empty row where there is none."""
        array = self._document.named("FieldData").get(name)
        return numpy.empty(0) if array is None else self._document.numbers(array, 1 if array.tuples is None else array.tuples).ravel()

    def words(self, name):
        """Its texts: strings in a .vtp, the characters of the lines in a .vtu."""
        array = self._document.named("FieldData").get(name)
        return [] if array is None else self._document.words(array)


def _together(parts, listed, frame):
    """Positions and arrays of the pieces of a frame, by phase, of a phase piece by piece: the order of a frame in one file."""
    def moment(part):
        return [part.numbers(name).tolist() for name in ("TimeValue", "step", "frame")]

    for part, file in zip(parts, listed):
        if moment(part) != moment(parts[0]) or [(name, values.shape[1:]) for name, values in part.arrays.items()] != [(name, values.shape[1:]) for name, values in parts[0].arrays.items()]:
            raise Unreadable(f"{frame}: its pieces {listed[0].name} and {file.name} are of different frames")
    x = numpy.concatenate([part.x for part in parts])
    arrays = {name: numpy.concatenate([part.arrays[name] for part in parts]) for name in parts[0].arrays}
    order = numpy.argsort(arrays["phase"], kind="stable") if "phase" in arrays else slice(None)
    return x[order], {name: values[order] for name, values in arrays.items()}


def pieces(path):
    """The files that the list of a frame in pieces (.pvtp, .pvtu) names; of another file none. Throws Unreadable."""
    if path.suffix not in (".pvtp", ".pvtu"):
        return []
    found = [files.named(path, piece.get("Source")) for piece in files.xml(path).iter("Piece")]
    if not found:
        raise Unreadable(f"{path}: it lists no piece")
    return [files.below(path.parent, file) for file in found]


class Grid:
    """What a [[grid]] measured (.vti): `axes` x, y, z of the points in m, and arrays by name, (nz, ny, nx) or (nz, ny, nx, components)."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        document = vtk_xml.Document(path, ("ImageData",))
        extent, start, step = (_row(document, name, kind, size) for name, kind, size in (("WholeExtent", int, 6), ("Origin", float, 3), ("Spacing", float, 3)))
        n = [extent[2 * k + 1] - extent[2 * k] + 1 for k in range(3)]
        count = n[0] * n[1] * n[2]
        if min(n) < 1 or document.piece.get("Extent") != document.about.get("WholeExtent"):
            raise Unreadable(f"{path}: no grid: the file is damaged or no .vti")
        self.arrays = {name: values.reshape(*n[::-1], *values.shape[1:])
                       for name, values in ((name, document.numbers(array, count)) for name, array in document.named("PointData").items())}
        if not self.arrays:
            raise Unreadable(f"{path}: a grid without arrays")
        self.axes = [start[k] + step[k] * numpy.arange(n[k]) for k in range(3)]

    def __getitem__(self, name):
        if name not in self.arrays:
            raise UnknownName.of("field", name, self.arrays, self.path)
        return self.arrays[name]


def _row(document, name, kind, size):
    """A row of numbers that an attribute of a grid holds."""
    try:
        row = [kind(word) for word in document.about.get(name, "").split()]
        if len(row) == size and numpy.isfinite(row).all():
            return row
    except (ValueError, OverflowError):
        pass
    raise Unreadable(f"{document.path}: {name}={document.about.get(name)!r:.60} is no row of {size} numbers")


def check(path):
    """Throws Unreadable unless a frame is whole, its cells too: what VTK's readers, which trust a file, may be given."""
    path = pathlib.Path(path)
    for file in pieces(path) or [path]:
        document = vtk_xml.Document(file, PARTICLES)
        for array in document.named("FieldData").values():
            document.words(array) if array.type == "String" else document.numbers(array)
        document.check_cells(document.count("NumberOfPoints"))
    Frame(path)


def write_particles(path, x, phase, **arrays):
    """Writes particles of one phase at x (n, 3) with these arrays as a .vtp frame, as a scene takes it for the shape of a fill."""
    vtk_xml.write_particles(path, x, {**arrays, "phase": numpy.zeros(len(x), numpy.uint8), "id": numpy.arange(len(x), dtype=numpy.int64)}, {"phase_names": [phase]})
