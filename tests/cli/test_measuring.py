#!/usr/bin/python3
"""What a run measures, as files: read by VTK and numpy, equal to one another, whole after a kill, and no bit of the frames
changed by it.

    /usr/bin/python3 test_measuring.py PROGRAM SOURCE_DIR
"""

import argparse
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader

SCENE = """
spacing = 0.02
[domain]
size = [0.4, 0.2]
periodic = ["x"]
[phases.air]
kind = "fluid"
density = 1.2
viscosity = 1e-3
sound-speed = 20
[phases.floor]
kind = "wall"
[phases.sand]
kind = "grains"
density = 2000
[interactions]
kernel = "wendland-c2"
air-air = 3.0
air-floor = 3.0
sand-sand = 1.1
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom", "top"] }}
[[fill]]
phase = "sand"
shape = {{ points = [[0.11, 0.11]] }}
velocity = [0.25, 0]
[[fill]]
phase = "air"
shape = "the-rest"
velocity = ["1 + 0.1*sin(2*pi*x/0.4)", 0]
{measuring}
[time]
end = {end}
[output]
every = 0.01
history-every = {rows}
"""

MEASURING = """
[[probe]]
name = "middle"
phase = "air"
at = [0.2, 0.1]
every = 1.5e-3
start = 0.01
[[profile]]
name = "line"
phase = "air"
from = [0.2, 0]
to = [0.2, 0.2]
count = 9
every = 1.1e-3
[[profile]]
name = "slices"
phase = "air"
box = { min = [0, 0], max = [0.4, 0.2] }
[[profile]]
name = "grains"
phase = "sand"
box = { min = [0, 0], max = [0.4, 0.2] }
along = "x"
count = 4
[[profile]]
name = "late"
phase = "air"
from = [0.2, 0]
to = [0.2, 0.2]
start = 1000
[[grid]]
name = "g"
phase = "air"
min = [0, 0.05]
spacing = 0.05
[[wall-shear]]
name = "floor"
phase = "air"
wall = "floor"
count = 5
"""

FILES = {
    "probe_middle": ["csv"],
    "profile_line": ["csv", "vtp"],
    "profile_slices": ["csv", "vtp"],
    "profile_grains": ["csv", "vtp"],
    "profile_late": ["csv", "vtp"],
    "grid_g": ["vti"],
    "wall_shear_floor": ["csv", "vtp"],
}


def read_csv(file):
    names = file.read_text().splitlines()[0].split(",")
    return dict(zip(names, numpy.loadtxt(file, delimiter=",", skiprows=1, unpack=True, ndmin=2)))


def read_vtk(file):
    reader = vtkXMLImageDataReader() if file.suffix == ".vti" else vtkXMLPolyDataReader()
    reader.SetFileName(str(file))
    reader.Update()
    if reader.GetErrorCode():
        raise AssertionError(f"{file}: error {reader.GetErrorCode()}")
    return reader.GetOutput()


def arrays(data):
    points = data.GetPointData()
    return {points.GetArrayName(k): vtk_to_numpy(points.GetArray(k)) for k in range(points.GetNumberOfArrays())}


class Measuring(unittest.TestCase):
    program = None

    @classmethod
    def setUpClass(cls):
        cls.place = pathlib.Path(tempfile.mkdtemp(prefix="barchan_measuring_"))
        cls.addClassCleanup(shutil.rmtree, cls.place)
        cls.out = cls.run_scene("with", MEASURING, 0.03)

    @classmethod
    def start(cls, name, measuring, end):
        scene = cls.place / f"{name}.toml"
        scene.write_text(SCENE.format(measuring=measuring, end=end, rows=end / 100))
        out = cls.place / f"out_{name}"
        return out, subprocess.Popen(
            [cls.program, "run", scene, "--out", out, "--threads", "1", "--quiet", "--set", "title=scene"]
        )

    @classmethod
    def run_scene(cls, name, measuring, end):
        out, process = cls.start(name, measuring, end)
        if process.wait() != 0:
            raise AssertionError(f"{name} ended with {process.returncode}")
        return out

    def test_files_are_those_that_the_report_names(self):
        report = json.loads((self.out / "run.json").read_text())
        named = [file for m in report["measured"] for file in m["files"]]
        self.assertEqual(sorted(named), sorted(f"{stem}.{end}" for stem, ends in FILES.items() for end in ends))
        for file in named:
            self.assertTrue((self.out / file).exists(), file)
        samples = {m["name"]: m["samples"] for m in report["measured"]}
        self.assertEqual(samples["late"], 0)
        self.assertEqual(samples["slices"], 101)  # as history.csv, and the beginning
        self.assertIn("measuring", report["seconds"])

    def test_appended_data_stand_behind_white_space(self):
        """Two reads of 4096 bytes: without it VTK 9.1 and 9.2 with a later expat do not find the data (src/output/whole_file.hpp)."""
        appended = [file for file in self.out.rglob("*.vt?") if b"<AppendedData" in file.read_bytes()]
        self.assertEqual({file.suffix for file in appended}, {".vtp", ".vti"})
        for file in appended:
            self.assertRegex(file.read_bytes(), rb'<AppendedData encoding="raw">\s{8192,}_', file.name)

    def test_csv_and_vtp_hold_the_same_numbers(self):
        for stem, ends in FILES.items():
            if ends != ["csv", "vtp"]:
                continue
            table, data = read_csv(self.out / f"{stem}.csv"), read_vtk(self.out / f"{stem}.vtp")
            self.assertEqual(data.GetNumberOfLines(), 1)
            points = vtk_to_numpy(data.GetPoints().GetData())
            numpy.testing.assert_array_equal(points[:, 1], table["y [m]"])
            for name, values in arrays(data).items():
                columns = [c for c in table if c.split(" [")[0] in (name, name + "_x", name + "_y")]
                self.assertTrue(columns, name)
                for column, component in zip(columns, values.reshape(len(values), -1).T):
                    numpy.testing.assert_array_equal(table[column], component, err_msg=f"{stem} {column}")

    def test_probe_has_a_row_a_sample_and_averages_from_its_start(self):
        probe = read_csv(self.out / "probe_middle.csv")
        times = probe["time [s]"]
        self.assertEqual(len(times), 21)  # 0, 1.5e-3, ..., 30e-3
        late = numpy.flatnonzero(times >= 0.01 * (1 - 1e-9))
        u = probe["velocity_x [m/s]"]
        self.assertTrue(numpy.isnan(probe["velocity_mean_x [m/s]"][: late[0]]).all())
        self.assertAlmostEqual(probe["velocity_mean_x [m/s]"][-1], u[late].mean(), delta=1e-12)
        self.assertAlmostEqual(probe["velocity_rms_x [m/s]"][-1], u[late].std(), delta=1e-12)
        self.assertGreater(probe["velocity_rms_x [m/s]"][-1], 0)

    def test_values_are_those_of_the_flow(self):
        slices = read_csv(self.out / "profile_slices.csv")
        self.assertTrue((numpy.abs(slices["velocity_mean_x [m/s]"] - 1) < 0.5).all())
        self.assertAlmostEqual(slices["volume_fraction"].mean(), 1 - 1 / 200, delta=0.01)
        grains = read_csv(self.out / "profile_grains.csv")
        self.assertNotIn("pressure_mean [Pa]", grains)
        self.assertEqual(grains["velocity_mean_x [m/s]"][1], 0.25)
        self.assertTrue(numpy.isnan(grains["velocity_mean_x [m/s]"][3]))
        self.assertEqual(grains["samples"][1], 101)
        shear = read_csv(self.out / "wall_shear_floor.csv")
        self.assertEqual(len(shear["x [m]"]), 5)
        self.assertTrue((shear["shear_stress_mean_x [Pa]"] > 0).all())
        late = read_csv(self.out / "profile_late.csv")
        self.assertTrue(numpy.isnan(late["velocity_mean_x [m/s]"]).all())

    def test_image_opens(self):
        data = read_vtk(self.out / "grid_g.vti")
        self.assertEqual(data.GetDimensions(), (9, 4, 1))
        self.assertEqual(data.GetOrigin(), (0.0, 0.05, 0.0))
        numpy.testing.assert_allclose(data.GetSpacing()[:2], [0.05, 0.05])
        fields = arrays(data)
        self.assertEqual(fields["velocity_mean"].shape, (36, 3))
        self.assertTrue(numpy.isfinite(fields["velocity_mean"]).all())
        self.assertTrue((fields["velocity_mean"][:, 2] == 0).all())
        about = data.GetFieldData()
        self.assertEqual(about.GetArray("TimeValue").GetValue(0), 0.03)
        self.assertEqual(about.GetArray("moments").GetValue(0), 101)
        units = about.GetAbstractArray("units")
        self.assertIn("velocity_mean m/s", [units.GetValue(k) for k in range(units.GetNumberOfValues())])

    def test_frames_have_the_same_bits_without_measuring(self):
        out = self.run_scene("without", "", 0.03)
        done = subprocess.run(
            [self.program, "compare", self.out / "with.pvd", out / "without.pvd", "--tolerance", "0"],
            capture_output=True, text=True,
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual((self.out / "history.csv").read_bytes(), (out / "history.csv").read_bytes())
        self.assertNotIn("measured", json.loads((out / "run.json").read_text()))
        left = [file.name for file in out.iterdir() if file.name.startswith(("probe", "profile", "grid", "wall_shear"))]
        self.assertEqual(left, [])

    def test_killed_run_keeps_what_it_had(self):
        out, process = self.start("killed", MEASURING, 1000)
        try:
            deadline = time.monotonic() + 60
            while not (out / "killed_000003.vtp").exists() and time.monotonic() < deadline:
                time.sleep(0.01)
        finally:
            process.send_signal(signal.SIGKILL)
            process.wait()
        line = read_vtk(out / "profile_line.vtp")
        self.assertGreater(line.GetFieldData().GetArray("moments").GetValue(0), 10)
        self.assertEqual(read_vtk(out / "grid_g.vti").GetNumberOfPoints(), 36)
        self.assertEqual(len(read_csv(out / "profile_line.csv")["y [m]"]), 9)


TANK = """dimensions = {dimensions}
spacing = 0.025
[domain]
size = {size}
gravity = {gravity}
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 20
[phases.tank]
kind = "wall"
slip = "free-slip"
[interactions]
water-water = {{}}
water-tank = {{}}
[[fill]]
phase = "tank"
shape = {{ sides = {walls} }}
[[fill]]
phase = "water"
shape = {{ box = {{ min = {low}, max = {top} }} }}
pressure = "hydrostatic"
[[gauge]]
name = "middle"
phase = "water"
at = {middle}
[[gauge]]
name = "wall"
phase = "water"
at = {wall}
[time]
end = 0.02
"""


class Gauges(unittest.TestCase):
    """Water at rest is as deep as its fill: in the middle, at a wall, in a thin layer, and where weight is along -z."""

    def depth_of(self, depth, **values):
        dimensions = len(values["size"])
        sides = ["left", "right", "bottom"] + ["front", "back"] * (dimensions == 3)
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            (folder / "s.toml").write_text(TANK.format(dimensions=dimensions, walls=json.dumps(sides), low=[0] * dimensions, **values))
            subprocess.run([Measuring.program, "run", "s.toml", "--quiet", "--threads", "1"], cwd=folder, check=True)
            for name in ("middle", "wall"):
                table = read_csv(folder / "out" / "s" / f"gauge_{name}.csv")
                self.assertGreater(len(table["time [s]"]), 5)
                self.assertLess(numpy.abs(table["height [m]"] - depth).max(), 0.1 * 0.025, name)

    def test_a_tank(self):
        for depth in (0.3, 0.075):
            with self.subTest(depth=depth):
                self.depth_of(depth, size=[1, 0.5], gravity=[0, -9.81], top=[1, depth], middle=[0.5, 0], wall=[0, 0])

    def test_three_dimensions(self):
        self.depth_of(0.2, size=[0.5, 0.4, 0.3], gravity=[0, -9.81, 0], top=[0.5, 0.2, 0.3], middle=[0.25, 0, 0.15], wall=[0, 0, 0.15])
        self.depth_of(0.2, size=[0.5, 0.3, 0.4], gravity=[0, 0, -9.81], top=[0.5, 0.3, 0.2], middle=[0.25, 0.15, 0], wall=[0, 0.15, 0])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    arguments = parser.parse_args()
    Measuring.program = arguments.program.resolve()
    unittest.main(argv=[sys.argv[0], "-v"])
