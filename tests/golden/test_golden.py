#!/usr/bin/python3
"""The small dune against committed frames, read by two programs that are not ours.

    /usr/bin/python3 test_golden.py PROGRAM SOURCE_DIR                 compares
    /usr/bin/python3 test_golden.py PROGRAM SOURCE_DIR --regenerate    writes the golden frames anew

PROGRAM runs tests/golden/small_dune.toml twice, to .vtu (read by meshio) and to .vtp (read by VTK). The two series must
hold the same bits. The first and the last frame must agree with tests/golden/small_dune_*.vtu within TOLERANCES, here and
by `barchan compare`.

A golden frame is a frozen number: it says that something has changed, not that it was right before. Regenerate it after a
change that is meant to change results, and say in the commit why they changed.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
from typing import NamedTuple

import meshio
import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader, vtkXMLUnstructuredGridWriter


class Tolerance(NamedTuple):
    """Largest |a - b| over a phase, relative to the largest |golden| in that phase or to `floor`, whichever is larger."""

    relative: float
    floor: float  # SI: below it the phase's own magnitude means nothing
    reason: str


# What is compared is the same source on another processor or compiler: other instructions round differently, in the last
# bit, in every operation. Nothing else may differ. Each tolerance is about a thousand times the difference ("measured")
# between a build for AVX2 with fused multiply-add and one for SSE2 without, after 500 steps of a dune of 6500 particles. A
# wrong sign, a lost neighbour or a constant's seventh digit is orders above it.
#
# Grains that collide and particles that mix forget their beginning: the same two builds are a hundred thousand times
# further apart after 1000 steps and have nothing in common after 1600. So the golden run must stay near 500 steps; a longer
# one needs wider tolerances and sees less.
TOLERANCES = {
    # From the scene, not computed: copied bit for bit.
    "id": Tolerance(0, 0, "an identity"),
    "phase": Tolerance(0, 0, "an identity"),
    "smoothing_length": Tolerance(1e-15, 0, "a product of two numbers of the scene, one rounding"),
    # Computed.
    "position": Tolerance(1e-9, 1e-3, "the time integral of the velocity; measured 7e-13"),
    "velocity": Tolerance(1e-7, 1e-2, "the sum of all rounding; measured 7e-12 in air, 5e-10 in sand, pushed by air's pressure"),
    "density": Tolerance(1e-10, 1e-3, "the divergence of the velocity over a sound period; measured 7e-14"),
    "pressure": Tolerance(1e-8, 1.0, "c2 times a small difference of densities, rho c2 / p = 90 times its error; measured 6e-12"),
    "acceleration": Tolerance(1e-7, 10.0, "the pressure's error over a spacing, where gravity balances most of it"),
}


class Frame(NamedTuple):
    """A frame in the order of its ids, whoever read it."""

    time: float
    phase_names: list
    units: list
    arrays: dict  # with "position"; one row a particle


def sorted_by_id(time, phase_names, units, arrays):
    order = numpy.argsort(arrays["id"].ravel(), kind="stable")
    n = len(order)
    return Frame(time, phase_names, units, {name: a.reshape(n, -1)[order] for name, a in arrays.items()})


def read_by_meshio(file):
    mesh = meshio.read(file)
    text = {name: bytes(mesh.field_data[name].ravel()).decode().split("\n") for name in ("phase_names", "units")}
    arrays = dict(mesh.point_data, position=mesh.points)
    return sorted_by_id(float(mesh.field_data["TimeValue"].ravel()[0]), text["phase_names"], text["units"], arrays)


def read_by_vtk(file):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    data, about = reader.GetOutput(), reader.GetOutput().GetFieldData()
    if data.GetNumberOfVerts() != data.GetNumberOfPoints():
        raise AssertionError(f"{file}: {data.GetNumberOfVerts()} vertices for {data.GetNumberOfPoints()} particles")
    if data.GetPointData().GetGlobalIds() is None or data.GetPointData().GetGlobalIds().GetName() != "id":
        raise AssertionError(f"{file}: 'id' is not the global id")
    strings = {}
    for name in ("phase_names", "units"):
        array = about.GetAbstractArray(name)
        strings[name] = [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    arrays = {"position": vtk_to_numpy(data.GetPoints().GetData())}
    for k in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(k)
        arrays[array.GetName()] = vtk_to_numpy(array)
    return sorted_by_id(about.GetArray("TimeValue").GetValue(0), strings["phase_names"], strings["units"], arrays)


def differences(golden, new):
    """Everything that is out of tolerance, in words; an empty list if nothing is."""
    found = []
    if abs(golden.time - new.time) > 1e-12 * abs(golden.time):
        found.append(f"time: golden {golden.time!r}, new {new.time!r}")
    for name in ("phase_names", "units"):
        if getattr(golden, name) != getattr(new, name):
            found.append(f"{name}: golden {getattr(golden, name)}, new {getattr(new, name)}")
    if set(golden.arrays) != set(new.arrays):
        return found + [f"fields: golden {sorted(golden.arrays)}, new {sorted(new.arrays)}"]
    if not numpy.array_equal(golden.arrays["id"], new.arrays["id"]):
        return found + [f"the particles' ids differ: golden has {len(golden.arrays['id'])}, new {len(new.arrays['id'])}"]
    for name in golden.arrays:
        found += field_differences(name, golden, new)
    return found


def field_differences(name, golden, new):
    if name not in TOLERANCES:
        return [f"{name}: has no row in TOLERANCES; give it one, with its reason"]
    tolerance, a, b = TOLERANCES[name], golden.arrays[name], new.arrays[name]
    if a.shape != b.shape:
        return [f"{name}: {a.shape[1]} components in the golden frame, {b.shape[1]} in the new"]
    found = []
    for number, phase in enumerate(golden.phase_names):
        rows = numpy.flatnonzero(golden.arrays["phase"].ravel() == number)
        if not rows.size:
            continue
        distance = numpy.linalg.norm(a[rows].astype(float) - b[rows].astype(float), axis=1)
        scale = max(numpy.linalg.norm(a[rows].astype(float), axis=1).max(), tolerance.floor)
        outside = ~(distance <= tolerance.relative * scale)  # so that NaN is outside
        if outside.any():
            first = rows[numpy.argmax(outside)]
            found.append(
                f"{name} of {phase}: {outside.sum()} of {rows.size} particles differ by up to {distance.max() / scale:.2e}"
                f" of {scale:.4g}, allowed is {tolerance.relative:g} ({tolerance.reason});"
                f" first particle {int(golden.arrays['id'][first, 0])}: {a[first]} against {b[first]}"
            )
    return found


def run(program, source, directory, form):
    """Runs the small dune; returns its frames' files in order. One thread: the bits are the same for any number of them,
    and a scene this small gains nothing from more."""
    scene = source / "tests" / "golden" / "small_dune.toml"
    command = [program, "run", scene, "--out", directory / form, "--set", f"output.format={form}", "--threads", "1", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return sorted((directory / form).glob(f"small_dune_*.{form}"))


class Golden(unittest.TestCase):
    maxDiff = None
    program = source = None  # from the command line

    @classmethod
    def setUpClass(cls):
        cls.directory = pathlib.Path(tempfile.mkdtemp(prefix="barchan_golden_"))
        cls.addClassCleanup(shutil.rmtree, cls.directory)
        cls.vtu = run(cls.program, cls.source, cls.directory, "vtu")
        cls.vtp = run(cls.program, cls.source, cls.directory, "vtp")
        cls.golden = sorted((cls.source / "tests" / "golden").glob("small_dune_*.vtu"))

    def compare(self, *arguments):
        done = subprocess.run([self.program, "compare", *map(str, arguments)], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def test_golden_frames_are_there(self):
        names = [file.name for file in self.golden]
        self.assertEqual(
            names, [self.vtu[0].name, self.vtu[-1].name], "tests/golden must hold the first and the last frame; --regenerate"
        )

    def test_frames_agree_with_the_golden_ones(self):
        self.assertTrue(self.golden, "no golden frames in tests/golden; --regenerate")
        for file in self.golden:
            with self.subTest(frame=file.name):
                found = differences(read_by_meshio(file), read_by_meshio(self.directory / "vtu" / file.name))
                self.assertFalse(found, "\n" + "\n".join(found))

    def test_vtp_holds_the_bits_of_vtu(self):
        self.assertEqual([file.stem for file in self.vtu], [file.stem for file in self.vtp])
        for vtu, vtp in zip(self.vtu, self.vtp):
            with self.subTest(frame=vtu.stem):
                a, b = read_by_meshio(vtu), read_by_vtk(vtp)
                self.assertEqual((a.time, a.phase_names, a.units), (b.time, b.phase_names, b.units))
                self.assertEqual(sorted(a.arrays), sorted(b.arrays))
                for name in a.arrays:
                    self.assertEqual(a.arrays[name].tobytes(), b.arrays[name].tobytes(), name)

    def test_program_compares_the_two_series(self):
        status, text = self.compare(
            self.directory / "vtu" / "small_dune.pvd", self.directory / "vtp" / "small_dune.pvd", "--tolerance", 0
        )
        self.assertEqual(status, 0, text)

    def test_program_compares_with_the_golden_frames(self):
        """`barchan compare` knows one tolerance for all, so it gets the widest; the narrow ones are above."""
        self.assertTrue(self.golden, "no golden frames in tests/golden; --regenerate")
        widest = max(tolerance.relative for tolerance in TOLERANCES.values())
        for file in self.golden:
            status, text = self.compare(file, self.directory / "vtu" / file.name, "--tolerance", widest)
            self.assertEqual(status, 0, text)

    def test_both_find_a_planted_difference(self):
        """One particle's density is wrong by a hundred-thousandth: the table and the program both name the particle."""
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.vtu[-1]))
        reader.Update()
        data = reader.GetOutput()
        density = vtk_to_numpy(data.GetPointData().GetArray("density"))
        heaviest = int(numpy.argmax(density))
        density[heaviest] *= 1 + 1e-5
        planted = self.directory / "planted.vtu"
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetInputData(data)
        writer.SetFileName(str(planted))
        writer.EncodeAppendedDataOff()  # as Barchan writes its frames
        writer.Write()
        particle = data.GetPointData().GetArray("id").GetValue(heaviest)

        found = differences(read_by_meshio(self.vtu[-1]), read_by_meshio(planted))
        self.assertEqual(len(found), 1, found)
        self.assertIn(f"first particle {particle}:", found[0])
        status, text = self.compare(self.vtu[-1], planted, "--tolerance", 1e-6)
        self.assertEqual(status, 1, text)
        self.assertIn(f"density differs first at particle {particle}:", text)


def regenerate(program, source):
    golden = source / "tests" / "golden"
    for old in golden.glob("small_dune_*.vtu"):
        old.unlink()
    with tempfile.TemporaryDirectory(prefix="barchan_golden_") as directory:
        frames = run(program, source, pathlib.Path(directory), "vtu")
        for frame in (frames[0], frames[-1]):
            shutil.copy(frame, golden)
            print(golden / frame.name)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--regenerate", action="store_true")
    arguments = parser.parse_args()
    Golden.program, Golden.source = arguments.program.resolve(), arguments.source.resolve()
    if arguments.regenerate:
        regenerate(Golden.program, Golden.source)
    else:
        unittest.main(argv=[sys.argv[0], "-v"])
