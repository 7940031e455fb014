"""One frame of a run as NumPy arrays (.vtp, .vtu; in pieces .pvtp, .pvtu), grids (.vti), and the frames that a scene takes for the shape of a fill.

This is the one file of the package that knows VTK.
"""

import pathlib
import xml.etree.ElementTree as ElementTree

import numpy

from .errors import PackageMissing, Unreadable, UnknownName, package

try:
    from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkObject, vtkPoints, vtkStringArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader, vtkXMLPolyDataWriter, vtkXMLUnstructuredGridReader
except ImportError as error:
    raise PackageMissing(f"frames need VTK's Python modules, which are not installed ({error}): apt install python3-paraview "
                         "(for /usr/bin/python3), or pip install vtk") from error


def without_warnings():
    """VTK no longer writes its own messages about malformed files to the terminal."""
    vtkObject.GlobalWarningDisplayOff()


class Frame:
    """The particles of one moment.

    `x`: positions (n, 3), m; `arrays`: the fields by name, SI units, (n,) or (n, components); `time`: s; `names` and `kinds`: of the phases by number;
    `units`: of the fields by name; `domain`: (3, 2) bounds in m or None; `step`, `number`: of the run, or None.

    `frame["velocity"]` is a field of all particles, `frame["velocity", "sand"]` of one phase, `frame.of("sand")` the frame of one phase alone.
    Throws Unreadable when VTK finds no particles, UnknownName for a phase or a field that is not there.
    """

    path = None
    step = number = domain = None
    names, kinds, units = (), (), {}

    def __init__(self, path, time=None, phase=None):
        """`time`: that of the list of the series, if it is given, else the frame's own; `phase`: only the particles of the phase with this name."""
        self.path = pathlib.Path(path)
        if not self.path.is_file():
            raise Unreadable(f"{path}: there is no such frame")
        files = pieces(self.path)
        parts = [_particles(file, self.path) for file in files or [self.path]]
        about = parts[0].about
        own = numbers(about.GetArray("TimeValue"))
        self.time = float(own[0]) if time is None and len(own) else time
        if files:
            self.x, self.arrays = _together(parts, files, self.path)
        else:
            self.x, self.arrays = parts[0].x, parts[0].arrays
        self.names = strings(about.GetAbstractArray("phase_names"))
        self.kinds = strings(about.GetAbstractArray("phase_kinds"))
        self.units = dict((line + " ").split(" ", 1) for line in strings(about.GetAbstractArray("units")) if line)
        self.units = {name: unit.strip() for name, unit in self.units.items()}
        domain, step, number = (numbers(about.GetArray(name)) for name in ("domain", "step", "frame"))
        self.domain = domain.reshape(3, 2) if len(domain) == 6 else None
        self.step, self.number = (int(value[0]) if len(value) else None for value in (step, number))
        if phase is not None:
            self.keep(self.mask(phase))

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

    def by_id(self):
        """The particles in the order of their ids; returns the frame itself."""
        return self.keep(numpy.argsort(self["id"]))

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


class _particles:
    """What stands in one file: `x`, `arrays`, `about` (VTK's field data). `frame`: the file of the frame, for messages."""

    def __init__(self, path, frame):
        if not path.is_file():
            raise Unreadable(f"{frame}: its piece {path} is not there" if path != frame else f"{path}: there is no such frame")
        data = _read(vtkXMLUnstructuredGridReader() if path.suffix == ".vtu" else vtkXMLPolyDataReader(), path)
        if data is None or data.GetPoints() is None:
            raise Unreadable(f"{path}: no particles: the file is damaged or no frame (.vtp or .vtu, in pieces .pvtp or .pvtu)")
        arrays, self.about = data.GetPointData(), data.GetFieldData()
        self.x = vtk_to_numpy(data.GetPoints().GetData())
        self.arrays = {arrays.GetArrayName(k): vtk_to_numpy(arrays.GetArray(k)) for k in range(arrays.GetNumberOfArrays()) if arrays.GetArray(k)}
        if any(len(values) != len(self.x) for values in self.arrays.values()):
            raise Unreadable(f"{path}: damaged: a field has another length than the positions")


def _together(parts, files, frame):
    """Positions and arrays of the pieces of a frame, by phase, of a phase piece by piece: the order of a frame in one file."""
    def moment(part):
        return [numbers(part.about.GetArray(name)).tolist() for name in ("TimeValue", "step", "frame")]

    for part, file in zip(parts, files):
        if moment(part) != moment(parts[0]) or list(part.arrays) != list(parts[0].arrays):
            raise Unreadable(f"{frame}: its pieces {files[0].name} and {file.name} are of different frames")
    x = numpy.concatenate([part.x for part in parts])
    arrays = {name: numpy.concatenate([part.arrays[name] for part in parts]) for name in parts[0].arrays}
    order = numpy.argsort(arrays["phase"], kind="stable") if "phase" in arrays else slice(None)
    return x[order], {name: values[order] for name, values in arrays.items()}


def pieces(path):
    """The files that the list of a frame in pieces (.pvtp, .pvtu) names; of another file none. Throws Unreadable."""
    if path.suffix not in (".pvtp", ".pvtu"):
        return []
    try:
        return [path.parent / piece.get("Source") for piece in ElementTree.parse(path).getroot().iter("Piece")]
    except (ElementTree.ParseError, TypeError, ValueError) as error:
        raise Unreadable(f"{path}: {error}") from error


def _read(reader, path):
    """What a reader of VTK finds in a file. VTK's messages about it, which say less than ours, are not shown."""
    shown = vtkObject.GetGlobalWarningDisplay()
    vtkObject.GlobalWarningDisplayOff()
    try:
        reader.SetFileName(str(path))
        reader.Update()
        return reader.GetOutput()
    finally:
        vtkObject.SetGlobalWarningDisplay(shown)


def numbers(array):
    """The values of an array of VTK in one row; of None an empty row."""
    return numpy.empty(0) if array is None else vtk_to_numpy(array).ravel()


def strings(array):
    """Words of a field of a frame: VTK strings in a .vtp, the characters of the lines in a .vtu."""
    if array is None:
        return []
    if array.IsA("vtkStringArray"):
        return [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    return vtk_to_numpy(array).astype(numpy.uint8).tobytes().decode(errors="replace").split("\n")


class Grid:
    """What a [[grid]] measured (.vti): `axes` x, y, z of the points in m, and arrays by name, (nz, ny, nx) or (nz, ny, nx, components)."""

    def __init__(self, path):
        data = _read(vtkXMLImageDataReader(), path)
        if data is None or data.GetNumberOfPoints() == 0:
            raise Unreadable(f"{path}: no grid: the file is damaged or no .vti")
        self.path = pathlib.Path(path)
        n, start, step = data.GetDimensions(), data.GetOrigin(), data.GetSpacing()
        self.axes = [start[k] + step[k] * numpy.arange(n[k]) for k in range(3)]
        arrays = data.GetPointData()
        self.arrays = {}
        for k in range(arrays.GetNumberOfArrays()):
            values = vtk_to_numpy(arrays.GetArray(k))
            self.arrays[arrays.GetArrayName(k)] = values.reshape(*n[::-1], *values.shape[1:])

    def __getitem__(self, name):
        if name not in self.arrays:
            raise UnknownName.of("field", name, self.arrays, self.path)
        return self.arrays[name]


def write_particles(path, x, phase, **arrays):
    """Writes particles of one phase at x (n, 3) with these arrays as a .vtp frame, as a scene takes it for the shape of a fill."""
    points, vertices = vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(numpy.ascontiguousarray(x, float), deep=True))
    for k in range(len(x)):
        vertices.InsertNextCell(1, [k])
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetVerts(vertices)
    for name, values in {**arrays, "phase": numpy.zeros(len(x), numpy.uint8), "id": numpy.arange(len(x), dtype=numpy.int64)}.items():
        array = numpy_to_vtk(numpy.ascontiguousarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    names = vtkStringArray()
    names.SetName("phase_names")
    names.InsertNextValue(phase)
    data.GetFieldData().AddArray(names)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.EncodeAppendedDataOff()
    writer.SetHeaderTypeToUInt64()
    if not writer.Write():
        raise OSError(f"cannot write {path}")
