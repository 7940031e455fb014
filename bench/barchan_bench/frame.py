"""Reads what a run writes: frames (.vtp, .vtu), series (.pvd) and tables (.csv). No other file of bench/ reads them (tests/cli/test_bench_measuring.py)."""

import xml.etree.ElementTree as ElementTree

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkObject, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter, vtkXMLUnstructuredGridReader


class Unreadable(ValueError):
    """A file in which VTK finds no particles, or a list of frames that is no XML."""


def without_warnings():
    """VTK no longer writes its own messages about malformed files to the terminal."""
    vtkObject.GlobalWarningDisplayOff()


class Frame:
    """One frame: positions x (n, 3) in m and arrays by name (SI units), of the phase with this name or of all; names of the phases by number; time in s,
    of the list of the series if it is given, else the frame's own."""

    def __init__(self, path, time=None, phase=None):
        reader = vtkXMLUnstructuredGridReader() if str(path).endswith(".vtu") else vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        data = reader.GetOutput()
        if data is None or data.GetPoints() is None:
            raise Unreadable(f"{path}: no particles")
        arrays, about = data.GetPointData(), data.GetFieldData()
        own = about.GetArray("TimeValue")
        self.time = own.GetValue(0) if time is None and own and own.GetNumberOfValues() else time
        self.x = vtk_to_numpy(data.GetPoints().GetData())
        self.arrays = {arrays.GetArrayName(k): vtk_to_numpy(arrays.GetArray(k)) for k in range(arrays.GetNumberOfArrays()) if arrays.GetArray(k)}
        self.names = strings(about.GetAbstractArray("phase_names"))
        if phase is not None:
            self.keep(self.arrays["phase"] == self.names.index(phase))

    def __getitem__(self, name):
        return self.arrays[name]

    def keep(self, chosen):
        """Only these particles, by a mask or their indices; returns the frame."""
        self.x = self.x[chosen]
        self.arrays = {name: values[chosen] for name, values in self.arrays.items()}
        return self

    def by_id(self):
        """The particles in the order of their ids; returns the frame."""
        return self.keep(numpy.argsort(self.arrays["id"]))


def strings(array):
    """Words of a field of a frame: VTK strings in a .vtp, the characters of the lines in a .vtu."""
    if array is None:
        return []
    if array.IsA("vtkStringArray"):
        return [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    return vtk_to_numpy(array).astype(numpy.uint8).tobytes().decode(errors="replace").split("\n")


def series(pvd):
    """(time in s, file) of each frame that a .pvd lists, in order."""
    try:
        entries = ElementTree.parse(pvd).getroot().iter("DataSet")
        return [(float(e.get("timestep")), pvd.parent / e.get("file")) for e in entries]
    except ElementTree.ParseError as error:
        raise Unreadable(f"{pvd}: {error}") from error


class Table(dict):
    """Columns of a .csv by their names, "time [s]" for example, in the file's order; a name without its unit finds its column too."""

    def __missing__(self, name):
        found = [full for full in self if full.split(" [")[0] == name]
        if len(found) != 1:
            raise KeyError(f"{len(found)} columns {name}; columns are {', '.join(self)}")
        return self[found[0]]

    def __contains__(self, name):
        return dict.__contains__(self, name) or any(full.split(" [")[0] == name for full in self)

    def rows(self):
        """Dictionaries of numbers by names without units, one a row."""
        names = [full.split(" [")[0] for full in self]
        return [dict(zip(names, map(float, row))) for row in zip(*self.values())]


def table(path):
    """The columns of a table that a run wrote; lines that begin with # are remarks."""
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    names = lines[0].split(",")
    values = numpy.loadtxt(lines[1:], delimiter=",", ndmin=2) if len(lines) > 1 else numpy.empty((0, len(names)))
    return Table(zip(names, values.T))


def write_particles(path, x, phase, **arrays):
    """A .vtp of particles of one phase at x (n, 3) with these arrays, as a scene takes it for the shape of a fill."""
    points, vertices = vtkPoints(), vtkCellArray()
    points.SetData(numpy_to_vtk(x, deep=True))
    for k in range(len(x)):
        vertices.InsertNextCell(1, [k])
    data = vtkPolyData()
    data.SetPoints(points)
    data.SetVerts(vertices)
    for name, values in {**arrays, "phase": numpy.zeros(len(x), numpy.uint8), "id": numpy.arange(len(x), dtype=numpy.int64)}.items():
        array = numpy_to_vtk(values, deep=True)
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
    writer.Write()
