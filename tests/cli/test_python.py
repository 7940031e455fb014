#!/usr/bin/python3
"""The Python package: arrays of a run, runs and their errors, scenes from dictionaries, beds and bodies from arrays, `python3 -m barchan`, the examples and the notebook.

    /usr/bin/python3 tests/cli/test_python.py PROGRAM ROOT
"""

import ast
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
import warnings
from unittest import mock

import numpy

PROGRAM = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/barchan").resolve()
ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2]).resolve()
sys.path.insert(0, str(ROOT / "python"))
os.environ["BARCHAN_PROGRAM"] = str(PROGRAM)
import barchan  # noqa: E402
from barchan.frame import write_particles  # noqa: E402

BALLS = {  # two discs that fall on a floor
    "title": 'Two "balls"', "spacing": 0.02, "domain": {"size": [0.4, 0.4], "gravity": [0, -9.81]},
    "phases": {"ball": {"kind": "grains", "density": 2000, "diameter": 0.02, "stiffness": 1e5, "restitution": 0.5}, "floor": {"kind": "wall"}},
    "interactions": {"ball-floor": {"law": "linear"}, "ball-ball": {"law": "linear"}},
    "fill": [{"phase": "floor", "shape": {"sides": ["bottom"]}}, {"phase": "ball", "shape": {"points": [[0.1, 0.05], [0.3, 0.06]]}}],
    "time": {"end": 0.02, "largest-speed": 2}, "output": {"every": 0.005, "history-every": 0.002},
}


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)


class Reading(Case):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.shared.cleanup)
        cls.out = pathlib.Path(cls.shared.name) / "balls"
        cls.ran = barchan.run(BALLS, out=cls.out, name="balls", threads=1)

    def test_two_lines_to_an_array(self):
        velocity = barchan.open(self.out)[-1]["velocity"]
        self.assertEqual(velocity.shape, (len(barchan.open(self.out)[-1]), 3))
        ball = barchan.open(self.out)[-1]["velocity", "ball"]
        self.assertLess(abs(ball[:, 1] + 9.81 * .02).max(), 1e-9)  # free fall

    def test_times_phases_fields(self):
        series = barchan.open(self.out / "balls.pvd")
        self.assertLess(abs(series.times - numpy.arange(5) * .005).max(), 1e-12)
        self.assertEqual((series.phases, series.kinds), (["ball", "floor"], {"ball": "grains", "floor": "wall"}))
        self.assertLessEqual({"id", "phase", "velocity", "density"}, set(series.fields))
        self.assertEqual(series.units["velocity"], "m/s")
        self.assertEqual((len(series[1:3]), series[1:3].times[0], len(list(series))), (2, .005, 5))
        frame = series.frame(t=.011)
        self.assertEqual((frame.time, frame.number), (.01, 2))
        self.assertEqual(len(series.frame(t=.01, phase="ball")), 2)
        self.assertEqual((frame.of("ball").x.shape, frame["position"].shape), ((2, 3), frame.x.shape))
        self.assertLess(abs(frame.domain - [[0, .4], [0, .4], [0, 0]]).max(), 1e-12)

    def test_the_numbers_are_those_of_another_reader(self):
        series = barchan.run({**BALLS, "output": {**BALLS["output"], "format": "vtu"}}, out=self.folder / "vtu", name="balls", threads=1)
        try:
            import meshio
        except ImportError:
            self.skipTest("python3-meshio is not there")
        mesh = meshio.read(series.files[-1])
        stored = barchan.Frame(series.files[-1], order="file")
        self.assertTrue((mesh.points == stored.x).all() and (mesh.point_data["velocity"] == stored["velocity"]).all())
        ours, vtp = series[-1], barchan.open(self.out)[-1]
        self.assertTrue((vtp["velocity"] == ours["velocity"]).all() and vtp.names == ours.names and vtp.units == ours.units)

    def test_particles_are_in_the_order_of_their_ids(self):
        from barchan import vtk_xml
        file, x = self.folder / "mixed.vtp", numpy.array([[2., 0, 0], [0, 0, 0], [1, 0, 0]])
        vtk_xml.write_particles(file, x, {"phase": numpy.zeros(3, numpy.uint8), "id": numpy.array([2, 0, 1])}, {"phase_names": ["sand"]})
        self.assertEqual(barchan.Frame(file)["id"].tolist(), [0, 1, 2])
        self.assertEqual(barchan.Frame(file, phase="sand").x[:, 0].tolist(), [0, 1, 2])
        self.assertEqual(barchan.Frame(file, order="file").x[:, 0].tolist(), [2, 0, 1])

    def test_files_as_vtk_writes_them(self):
        """Appended as raw bytes and as base64, inline as base64 and as text, each without a compressor, with zlib and with LZ4: the numbers that VTK reads."""
        try:
            from vtkmodules.util.numpy_support import vtk_to_numpy
            from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter
        except ImportError:
            self.skipTest("python3-paraview is not there")
        reader, whole = vtkXMLPolyDataReader(), barchan.open(self.out).files[-1]
        reader.SetFileName(str(whole))
        reader.Update()
        data, ours = reader.GetOutput(), barchan.Frame(whole, order="file")
        self.assertTrue((vtk_to_numpy(data.GetPoints().GetData()) == ours.x).all() and (vtk_to_numpy(data.GetPointData().GetArray("velocity")) == ours["velocity"]).all())
        for mode in ("raw", "appended", "binary", "ascii"):
            for compressor in ("None", "ZLib", "LZ4"):
                for head in ("UInt32", "UInt64"):
                    writer, file = vtkXMLPolyDataWriter(), self.folder / "a.vtp"
                    writer.SetInputData(data)
                    writer.SetFileName(str(file))
                    getattr(writer, f"SetDataModeTo{'Appended' if mode == 'raw' else mode.capitalize()}")()
                    writer.SetEncodeAppendedData(mode != "raw")
                    getattr(writer, f"SetCompressorTypeTo{compressor}")()
                    getattr(writer, f"SetHeaderTypeTo{head}")()
                    writer.Write()
                    read = barchan.Frame(file, order="file")
                    self.assertEqual((read.names, read.kinds, read.units, read.step, read.number), (ours.names, ours.kinds, ours.units, ours.step, ours.number))
                    for name, values in {**ours.arrays, "position": ours.x}.items():
                        self.assertEqual((read[name].dtype, read[name].shape), (values.dtype, values.shape))
                        self.assertLessEqual(abs(read[name] - values).max(), 1e-5 * abs(values).max() if mode == "ascii" else 0, (mode, compressor, name))

    def test_history_and_run(self):
        series = barchan.open(self.out)
        t, energy = series.history["time"], series.history["ball_kinetic_energy"]
        mass = 2000 * math.pi / 6 * .02 ** 2  # of a sphere by metre of depth, in a slab one diameter thick
        self.assertGreater(len(t), 9)
        self.assertLess(abs(energy - 2 * .5 * mass * (9.81 * t) ** 2).max() / energy.max(), .02)
        self.assertEqual((series.history.unit("ball_kinetic_energy"), series.run["end_reason"]), ("J/m", "end"))
        self.assertEqual((dict(series.profiles), series.grids, series.bad), ({}, {}, None))

    def test_a_row_that_was_cut_off_is_left_out(self):
        shutil.copytree(self.out, self.folder / "cut")
        file = self.folder / "cut/history.csv"
        rows = barchan.open(self.folder / "cut").history.length
        file.write_text(file.read_text() + "0.0123,7,")
        self.assertEqual(barchan.open(self.folder / "cut").history.length, rows)
        file.write_text(file.read_text() + "\n")
        with self.assertRaisesRegex(barchan.Unreadable, "history.csv"):
            barchan.open(self.folder / "cut").history

    def test_what_is_not_there_is_said(self):
        series = barchan.open(self.out)
        for act, kind, words in ((lambda: series[-1]["velocty"], KeyError, 'no field "velocty"; did you mean "velocity"'),
                                 (lambda: series[-1]["velocity", "bal"], KeyError, 'no phase "bal"; did you mean "ball"'),
                                 (lambda: series.history["times"], KeyError, 'no column "times"; did you mean'),
                                 (lambda: series.profiles["crest"], KeyError, 'no table "crest"'),
                                 (lambda: series.frame(t=1), ValueError, "no frame near 1 s: the frames go from 0 to 0.02 s"),
                                 (lambda: series[9], IndexError, "has 5 frames: there is no frame 9"),
                                 (lambda: barchan.open(self.out.parent / "bals"), FileNotFoundError, 'no such folder; did you mean "balls"'),
                                 (lambda: barchan.open(self.folder), barchan.NoSeries, "no series"),
                                 (lambda: barchan.open(self.out.parent), barchan.NoSeries, "some in balls"),
                                 (lambda: barchan.open(series.files[0]), barchan.NoSeries, "expected the folder of a run or a .pvd; one frame is read with"),
                                 (lambda: barchan.Frame(self.folder / "a.vtp"), barchan.Unreadable, "there is no such frame")):
            with self.assertRaisesRegex(kind, re.escape(words)):
                act()

    def test_a_damaged_frame_is_said(self):
        whole = barchan.open(self.out).files[0].read_bytes()
        for k, damaged in enumerate((whole[:300], whole[:len(whole) // 2], b"", b"<VTKFile")):
            file = self.folder / f"{k}.vtp"
            file.write_bytes(damaged)
            with self.assertRaisesRegex(barchan.Unreadable, f"{k}.vtp"):
                barchan.Frame(file)

    def test_pandas_is_named_if_it_is_missing(self):
        with mock.patch.dict(sys.modules, {"pandas": None}), self.assertRaisesRegex(ImportError, "needs the Python package pandas.*apt install python3-pandas"):
            barchan.open(self.out)[0].to_pandas()

    def test_pandas(self):
        try:
            import pandas  # noqa: F401
        except ImportError:
            self.skipTest("python3-pandas is not there")
        frame = barchan.open(self.out)[-1].to_pandas()
        self.assertEqual(set(frame["phase"]), {"ball", "floor"})
        self.assertIn("velocity_y", frame)
        self.assertEqual(barchan.open(self.out).history.to_pandas().index.name, "time [s]")

    def test_the_package_has_the_version_of_the_program(self):
        import tomllib
        self.assertEqual(tomllib.loads((ROOT / "python/pyproject.toml").read_text())["project"]["version"], barchan.version().split()[1])

    def test_beds(self):
        """Grains of a hexagonal lattice under a slope, one in flight over it, and a gap of the ground: the slope is found within 2 %, the volume is that of the grains."""
        r = 5e-4
        x, y = numpy.meshgrid(numpy.arange(200) * 2 * r, numpy.arange(80) * 3 ** .5 * r)
        x[1::2] += r
        slope = lambda x: 0.01 + 0.25 * x
        chosen = (y < slope(x)) & ((x < 0.12) | (x > 0.15))
        places = numpy.column_stack([x[chosen], y[chosen], 0 * x[chosen]])
        places = numpy.concatenate([places, [[0.1, 0.09, 0]]])
        file = self.folder / "slope.vtp"
        write_particles(file, places, "sand", radius=numpy.full(len(places), r))
        bed = barchan.Frame(file).bed("sand", width=8e-3)
        self.assertAlmostEqual(bed.volume / (len(places) * 4 / 3 * numpy.pi * r ** 3 / (2 * r)), 1, places=12)
        self.assertAlmostEqual(bed.solid.sum() * bed.width / bed.volume, 1, places=12)
        lie = numpy.isfinite(bed.height)
        self.assertFalse(lie[(bed.x > 0.125) & (bed.x < 0.145)].any())
        lie &= (bed.x < 0.11) | (bed.x > 0.16)
        found = numpy.polyfit(bed.x[lie], bed.height[lie], 1)
        self.assertAlmostEqual(found[0], 0.25, delta=5e-3)
        self.assertAlmostEqual(numpy.polyval(found, 0.1), slope(0.1), delta=r)
        with self.assertRaises(ValueError):
            barchan.Frame(file).of("sand").keep([]).bed("sand")

    def test_tracks(self):
        try:
            import pandas  # noqa: F401
        except ImportError:
            self.skipTest("python3-pandas is not there")
        series = barchan.open(self.out)
        tracks = series.tracks("ball")
        self.assertEqual(tracks.index.names, ["id", "time"])
        self.assertEqual(len(tracks), sum(len(frame.of("ball")) for frame in series))
        first = series[-1].of("ball")
        one = tracks.loc[first["id"][0]]
        self.assertEqual(list(one.index), list(series.times))
        self.assertEqual(one["velocity_y"].iloc[-1], first["velocity"][0, 1])
        self.assertEqual(len(series.tracks("ball", every=2).loc[first["id"][0]]), (len(series) + 1) // 2)
        self.assertEqual(len(series.tracks()), sum(len(frame) for frame in series))


class Beds(Case):
    """Beds of grains: what is up, radii, the slab of 2D, what lies and what falls."""

    SAND = {"kind": "grains", "density": 2000, "diameter": {"mean": 0.01, "spread": 0.4}, "stiffness": 1e5, "restitution": 0.3, "friction": 0.5}
    POURED = {  # two phases of grains of different sizes; one is poured
        "spacing": 0.01, "dimensions": 2, "domain": {"size": [0.4, 0.6], "gravity": [0, -9.81], "open": ["top"]},
        "phases": {"sand": SAND, "floor": {"kind": "wall"}},
        "interactions": {"sand-floor": {"law": "linear"}, "sand-sand": {"law": "linear"}},
        "fill": [{"phase": "floor", "shape": {"sides": ["bottom", "left", "right"]}}, {"phase": "sand", "shape": {"box": {"min": [0.02, 0.01], "max": [0.38, 0.1]}}}],
        "influx": [{"phase": "sand", "box": {"min": [0.15, 0.5], "max": [0.25, 0.58]}, "flux": 20}],
        "time": {"end": 0.3, "largest-speed": 5}, "output": {"every": 0.1, "history-every": 0.1, "fields": ["radius"]},
    }

    def frame(self, x, r=5e-4, **arrays):
        file = self.folder / "made.vtp"
        write_particles(file, numpy.asarray(x, float), "sand", **({"radius": numpy.full(len(x), r)} | arrays))
        return barchan.Frame(file)

    def test_up_is_against_gravity(self):
        """A flat bed in 3D, 3 diameters high along z, in a box 20 long along y."""
        d = 1e-3
        x = numpy.stack(numpy.meshgrid(*(d * (.5 + numpy.arange(n)) for n in (20, 20, 3))), -1).reshape(-1, 3)
        frame = self.frame(x)
        with self.assertRaisesRegex(barchan.UsageError, 'no run.json.*up="y" or up="z"'):
            frame.bed("sand")
        self.assertTrue(numpy.allclose(frame.bed("sand", up="z").height, 3 * d, atol=.1 * d))
        for gravity, words in (([-9.81, 0, 0], "gravity is along -x"), ([0, 9.81, 0], r"gravity is along \+y")):
            (self.folder / "run.json").write_text(json.dumps({"scene": {"gravity": gravity}}))
            with self.assertRaisesRegex(barchan.UsageError, words):
                frame.bed("sand")
        (self.folder / "run.json").write_text(json.dumps({"scene": {"gravity": [1, 0, -9.81]}}))
        self.assertTrue(numpy.allclose(frame.bed("sand").height, 3 * d, atol=.1 * d))
        self.assertTrue((frame.bed("sand", up="y").height > 15 * d).all())
        with self.assertRaisesRegex(barchan.UsageError, "up='x': expected"):
            frame.bed("sand", up="x")

    def test_radii_that_are_not_in_the_frame(self):
        scene = {**self.POURED, "time": {**self.POURED["time"], "end": 1e-3}, "output": {"every": 1e-3}}
        ran = barchan.run(scene, out=self.folder / "out", name="poured", threads=1)
        with self.assertRaisesRegex(barchan.SceneError, r'diameters of "sand" differ.*output.fields = \["radius"\]'):
            ran[-1].bed("sand")
        # a frame without run.json: its bed is fuller than equal spheres can be
        packed = numpy.stack(numpy.meshgrid(.01 * numpy.arange(40), .01 * numpy.arange(10), [0]), -1).reshape(-1, 3)
        with self.assertRaisesRegex(barchan.SceneError, r'more than spheres of one diameter.*output.fields = \["radius"\]'):
            self.frame(packed, radius=numpy.zeros(len(packed)), smoothing_length=numpy.full(len(packed), .007)).bed("sand")
        self.assertGreater(self.frame(packed, radius=numpy.zeros(len(packed)), smoothing_length=numpy.full(len(packed), .005)).bed("sand").volume, 0)  # one diameter, next to a phase with sizes

    def test_volume_and_height_of_poured_grains(self):
        """The mass is that of the history, with the scene and without; the height is that of the bed and not of the stream."""
        ran = barchan.run(self.POURED, out=self.folder / "out", name="poured", threads=1)
        mass = ran.history["sand_mass"]
        for k, frame in enumerate(ran):
            self.assertAlmostEqual(frame.bed("sand").volume * 2000 / mass[k], 1, delta=1e-9)
        last = ran[-1]
        self.assertGreater(last["position", "sand"][:, 1].max(), 0.4)
        bed = last.bed("sand")
        self.assertTrue(((bed.height > 0.025) & (bed.height < 0.09)).all(), bed.height)
        (ran.folder / "poured.toml").unlink()
        self.assertAlmostEqual(last.bed("sand").volume * 2000 / mass[-1], 1, delta=1e-9)  # of the mass in history.csv
        (ran.folder / "history.csv").unlink()
        self.assertAlmostEqual(last.bed("sand").volume * 2000 / mass[-1], 1, delta=.05)   # of the mean of the frame's diameters

    def test_the_slab_is_that_of_the_largest_grains(self):
        """A phase of small grains lies in the slab of the large ones."""
        phases = {"big": {**self.SAND, "diameter": 0.02}, "small": {**self.SAND, "diameter": {"mean": 0.008, "log-normal": 0.2}}}
        scene = {**self.POURED, "phases": {**phases, "floor": {"kind": "wall"}}, "interactions": {f"{a}-{b}": {"law": "linear"} for a in phases for b in (*phases, "floor") if a <= b or b == "floor"},
                 "time": {"end": 1e-3, "largest-speed": 2}, "output": {"every": 1e-3, "fields": ["radius"]},
                 "fill": [self.POURED["fill"][0], {"phase": "big", "shape": {"points": [[0.1, 0.3]]}}, {"phase": "small", "shape": {"box": {"min": [0.02, 0.01], "max": [0.38, 0.1]}}}]}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")   # small grains fill less of the slab
            ran = barchan.run({k: v for k, v in scene.items() if k != "influx"}, out=self.folder / "out", name="two", threads=1)
        energy, small = ran.history["small_kinetic_energy"][-1], ran[-1].of("small")
        fast = (small["velocity"] ** 2).sum(axis=1)
        self.assertLess(numpy.ptp(fast), 1e-6 * fast.max())   # all fall alike, so the mass follows from the energy
        self.assertAlmostEqual(ran[-1].bed("small").volume * 2000 / (2 * energy / fast.mean()), 1, delta=.01)

    def test_a_stream_is_not_the_bed(self):
        """A bed of ten rows under a dilute stream: the height is that without the stream."""
        r, some = 5e-4, numpy.random.default_rng(1)
        x, y = numpy.meshgrid(numpy.arange(60) * 2 * r, numpy.arange(12) * 3 ** .5 * r)
        x[1::2] += r
        flat = numpy.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
        alone = self.frame(flat).bed("sand").height
        for grains in (50, 250, 500):
            stream = numpy.column_stack([.02 + .01 * some.random(grains), .015 + .2 * some.random(grains), numpy.zeros(grains)])
            self.assertTrue(numpy.allclose(self.frame([*flat, *stream]).bed("sand").height, alone, atol=.2 * r))

    def test_a_bed_over_an_outlet(self):
        """Grains over the outlet of a hopper, with nothing below them, have the height of the neighbouring columns."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")   # an instrument starts later
            ran = barchan.run(ROOT / "scenes/hopper_belt.toml", out=self.folder / "out", set={"time.end": 1e-4, "output.every": 1e-4, "output.fields": ["radius"]}, threads=1)
        bed = ran[0].bed("sand")
        there = bed.solid > 0
        self.assertTrue((abs(bed.height[there] - 0.155) < 2e-3).all(), bed.height[there])
        self.assertTrue(numpy.isnan(bed.height[~there]).all())

    def test_a_layer_of_one_grain(self):
        """Its height is the top of the grains: dense, with gaps, on a slope, and next to a deep bed."""
        r = 5e-4
        x = numpy.arange(100) * 2 * r
        for step, slope in ((1, 0), (3, 0), (1, .3), (1, .5)):
            places = numpy.column_stack([x[::step], slope * x[::step], 0 * x[::step]])
            bed = self.frame(places).bed("sand")
            self.assertTrue((abs(bed.height - slope * bed.x - r) < 1.5 * r).all(), (step, slope, bed.height))
        a, b = numpy.meshgrid(numpy.arange(60) * 2 * r, numpy.arange(12) * 3 ** .5 * r)
        deep = numpy.column_stack([a.ravel(), b.ravel(), 0 * a.ravel()])
        layer = numpy.column_stack([.06 + x[:40], 0 * x[:40] + .7 * r, 0 * x[:40]])
        height = self.frame([*deep, *layer]).bed("sand").height
        self.assertTrue((abs(height[17:] - 1.7 * r) < .5 * r).all(), height)


class Running(Case):
    def test_a_wrong_scene_leaves_nothing(self):
        wrong = {**BALLS, "time": {**BALLS["time"], "ende": 1}}
        with self.assertRaises(barchan.SceneError) as caught:
            barchan.run(wrong, out=self.folder / "a/b", name="balls")
        self.assertEqual(caught.exception.status, 2)
        self.assertRegex(str(caught.exception), r'balls.toml:\d+:\d+: time.ende: .*end')
        self.assertFalse((self.folder / "a").exists())
        with self.assertRaisesRegex(barchan.SceneError, "time.end"):
            barchan.run(BALLS, out=self.folder / "a", set={"time.end": -1})
        self.assertFalse((self.folder / "a").exists())

    def test_a_breakdown_keeps_its_frames(self):
        with self.assertRaises(barchan.Breakdown) as caught, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            barchan.run(ROOT / "scenes/verification/hop.toml", out=self.folder / "hop", set={"time.end": .2}, threads=1)
        self.assertEqual((caught.exception.status, caught.exception.series.name), (3, "hop"))
        self.assertIn("escaped through the lower side", str(caught.exception))
        self.assertGreater(len(caught.exception.series), 100)
        self.assertGreater(caught.exception.series.bad.time, caught.exception.series.times[-1])

    def test_a_folder_that_cannot_be(self):
        (self.folder / "file").write_text("")
        scene = self.folder / "balls.toml"
        barchan.scene.dump(BALLS, scene)
        with self.assertRaises(barchan.OutputError) as caught:
            barchan.run(scene, out=self.folder / "file")
        self.assertEqual(caught.exception.status, 4)

    def test_a_signal(self):
        script = self.folder / "barchan"  # stands in for a run that is stopped
        for status, kind in ((130, barchan.Stopped), (143, barchan.Stopped), (5, barchan.Mistake), (99, barchan.Mistake)):
            script.write_text(f"#!/bin/sh\necho 'barchan: warning: beware' >&2\necho 'barchan: what happened' >&2\nexit {status}\n")
            script.chmod(0o755)
            with warnings.catch_warnings(record=True) as given, self.assertRaisesRegex(kind, "^what happened$") as caught:
                warnings.simplefilter("always")
                barchan.run(BALLS, out=self.folder / "out", program=script)
            self.assertEqual((caught.exception.status, [str(w.message) for w in given]), (status, ["beware"]))

    def test_plan_generate_compare_schema(self):
        plan = barchan.plan(BALLS, set={"time.end": .5})
        self.assertEqual((plan["end"], plan["phases"]["ball"]["particles"], plan["title"]), (.5, 2, 'Two "balls"'))
        a = barchan.generate(BALLS, self.folder / "a.vtp")
        barchan.generate(BALLS, self.folder / "b.vtp", set={"fill.1.shape.points": [[.1, .05], [.3, .07]]})
        self.assertEqual(len(a.of("ball")), 2)
        self.assertTrue(barchan.compare(self.folder / "a.vtp", self.folder / "a.vtp"))
        found = barchan.compare(self.folder / "a.vtp", self.folder / "b.vtp")
        self.assertFalse(found)
        self.assertGreater(len(found), 0)
        self.assertIn("properties", barchan.schema())
        self.assertIn("barchan", barchan.version())
        with self.assertRaises(barchan.OutputError):
            barchan.compare(self.folder / "none.vtp", self.folder / "a.vtp")

    def test_a_program_that_is_not_there(self):
        with mock.patch.dict(os.environ, {"BARCHAN_PROGRAM": "/nowhere/barchan"}), self.assertRaisesRegex(barchan.ProgramNotFound, "/nowhere/barchan"):
            barchan.version()

    def command(self, *words, **more):
        return subprocess.run([*words], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(ROOT / "python"), **more}, cwd=self.folder)

    def test_module_does_what_the_program_does(self):
        for words in (["--version"], ["schema"], ["plan", "none.toml"], ["rum"], []):
            ours, its = self.command("/usr/bin/python3", "-m", "barchan", *words), self.command(PROGRAM, *words)
            self.assertEqual((ours.returncode, ours.stdout, ours.stderr), (its.returncode, its.stdout, its.stderr))

    def test_program_starts_the_module(self):
        ended = self.command(PROGRAM, "report", "nowhere")
        self.assertEqual((ended.returncode, ended.stdout), (2, ""))
        self.assertIn("barchan: nowhere: there is no such folder", ended.stderr)
        (self.folder / "numpy.py").write_text("raise SystemExit(77)")  # a file of the folder it is started in is no module
        self.assertEqual(self.command(PROGRAM, "sweep", "--help").returncode, 0)
        ended = self.command(PROGRAM, "report", ".", BARCHAN_PYTHON="/nowhere/python3")
        self.assertEqual(ended.returncode, 4)
        self.assertRegex(ended.stderr, "^barchan: barchan report needs /nowhere/python3: .*apt install python3")
        (self.folder / "bare").write_text("#!/bin/sh\nexec /usr/bin/python3 -S \"$@\"\n")  # without the packages of Debian
        (self.folder / "bare").chmod(0o755)
        ended = self.command(PROGRAM, "report", ".", BARCHAN_PYTHON=str(self.folder / "bare"))
        self.assertEqual((ended.returncode, ended.stderr.count("\n")), (4, 1))
        self.assertIn("numpy", ended.stderr)


PUSHED = {  # water between two plates, pushed by a control
    "spacing": 0.02, "controls": {"pull": 0.0}, "domain": {"size": [0.4, 0.2], "periodic": ["x"]},
    "phases": {"water": {"kind": "fluid", "density": 1000, "viscosity": 1e-3, "sound-speed": 10}, "plates": {"kind": "wall"}},
    "interactions": {"water-water": 2.1, "water-plates": 2.1},
    "fill": [{"phase": "plates", "shape": {"sides": ["bottom", "top"]}}, {"phase": "water", "shape": "the-rest"}],
    "forcing": [{"phase": "water", "acceleration": ["pull", 0]}],
    "time": {"end": 0.06, "largest-speed": 1}, "output": {"every": 0.02, "history-every": 0.01},
}


class Stepping(Case):
    def test_it_has_the_bits_of_a_run(self):
        ran = barchan.run(PUSHED, out=self.folder / "ran", set={"controls.pull": 2}, threads=1)
        with barchan.Simulation(PUSHED, out=self.folder / "stepped", set={"controls.pull": 2}, threads=1) as sim:
            self.assertEqual((sim.time, sim.steps), (0, 0))
            sim.step(3)
            self.assertEqual(sim.steps, 3)
            sim.run(until=0.033)
            self.assertGreaterEqual(sim.time, 0.033)
            self.assertLess(sim.time, 0.035)
            sim.run()
            self.assertTrue(sim.ended)
            self.assertAlmostEqual(sim.time, 0.06, 12)
            with self.assertRaisesRegex(barchan.UsageError, "has ended, at t = 0.06 s"):
                sim.step()
            last = sim["velocity", "water"]
        self.assertTrue(barchan.compare(ran, sim.series))
        self.assertEqual((self.folder / "ran/history.csv").read_bytes(), (self.folder / "stepped/history.csv").read_bytes())
        self.assertTrue((sim.series[-1]["velocity", "water"][:, :2] == last.astype(numpy.float32)).all() or
                        numpy.allclose(sim.series[-1]["velocity", "water"][:, :2], last, rtol=1e-6, atol=1e-9))
        for act in (lambda: sim["velocity", "water"], sim.step, sim.run, lambda: sim.run(call=print), lambda: sim.history, lambda: sim.phases, lambda: sim.controls.update(pull=1)):
            with self.assertRaisesRegex(barchan.UsageError, "is closed, at t = 0.06 s.*restart="):
                act()
        self.assertIs(sim.close(), sim.series)

    def test_a_control_acts_from_the_next_step_on(self):
        with barchan.Simulation(PUSHED, out=self.folder / "out", threads=1) as sim:
            sim.step(5)
            self.assertEqual(abs(sim["velocity", "water"]).max(), 0)
            begin = sim.time
            sim.controls["pull"] = 3
            self.assertEqual(dict(sim.controls), {"pull": 3.0})
            seen = []
            sim.run(until=0.04, every=0.01, call=lambda s: seen.append((s.time, s.history["water_mean_vx [m/s]"])))
            self.assertEqual(len(seen), 4)
            for time, speed in seen:  # the plates hold a little of it
                self.assertTrue(0.85 * 3 * (time - begin) < speed < 3.001 * (time - begin), (time, speed))
            self.assertIs(sim.run(every=1e-3, call=lambda _: False), None)
            self.assertFalse(sim.ended)
        self.assertEqual(sim.series.run["end_reason"], "the program that steers it")
        # What was set stands in the checkpoint.
        with barchan.Simulation(PUSHED, out=self.folder / "out", threads=1, restart="latest") as sim:
            self.assertEqual(sim.controls["pull"], 3.0)
            self.assertGreater(sim.steps, 5)
            sim.run()

        with self.assertRaisesRegex(barchan.SceneError, "another scene"):  # it would not count: the checkpoint has the control
            barchan.Simulation(PUSHED, out=self.folder / "out", restart="latest", set={"controls.pull": 5, "time.end": 0.1})

    def test_a_call_after_each_step(self):
        with barchan.Simulation(PUSHED, out=self.folder / "out", threads=1) as sim:
            seen = []
            sim.run(until=0.01, call=lambda s: seen.append((s.steps, s.time)))
            self.assertEqual([steps for steps, _ in seen], list(range(1, len(seen) + 1)))
            self.assertTrue(seen[-2][1] < 0.01 * (1 - 1e-12) <= seen[-1][1])
            sim.run(call=lambda s: s.steps < len(seen) + 3)
            self.assertEqual(sim.steps, len(seen) + 3)

    def test_wrong_calls_have_names(self):
        with barchan.Simulation(PUSHED, out=self.folder / "out", threads=1) as sim:
            self.assertEqual((str(sim.controls), repr(sim.controls)), ("{'pull': 0.0}",) * 2)
            for act, words in ((lambda: sim.controls["pul"], 'no control "pul"; did you mean "pull"\\?; it has pull'), (lambda: sim["velocity", "air"], 'no phase "air".*it has water, plates'),
                               (lambda: sim["radius", "water"], 'no field "radius".*it has id, .*velocity')):
                with self.assertRaisesRegex(barchan.UnknownName, words):
                    act()
            for act, words in ((lambda: sim["velocity"], "several phases"), (lambda: sim.run(call=print, every=0), "every: expected"), (lambda: sim.run(every=.1), "every: expected"),
                               (lambda: sim.run(call=print, every=math.nan), "every: nan"), (lambda: sim.run(until="soon"), "until: 'soon' is no finite number"),
                               (lambda: sim.run(call=3), "call: expected a function"), (lambda: sim.step(-1), "count: expected"), (lambda: sim.step(1.5), "count: expected"),
                               (lambda: sim.controls.update(pull=math.nan), "'pull': nan is no finite"), (lambda: sim.controls.pop("pull"), "cannot be deleted")):
                with self.assertRaisesRegex(ValueError, words) as caught:
                    act()
                self.assertIsInstance(caught.exception, barchan.UsageError)
            self.assertEqual((sim.steps, sim.controls["pull"]), (0, 0))
            self.assertEqual(sorted(sim["id", "water"]), list(sim["id", "water"]))
        with self.assertRaisesRegex(barchan.SceneError, "unknown key"):
            barchan.Simulation({**PUSHED, "colour": 1}, out=self.folder / "none")

    def test_a_breakdown_ends_it_and_not_python(self):
        with self.assertRaises(barchan.Breakdown) as found:
            with barchan.Simulation(PUSHED, out=self.folder / "out", threads=1) as sim:
                sim.step(5)
                sim.controls["pull"] = 1e6
                sim.run()
        self.assertGreater(len(found.exception.series), 0)


class Scenes(Case):
    def test_every_scene_comes_back(self):
        files = sorted((ROOT / "scenes").rglob("*.toml"))
        self.assertGreater(len(files), 50)
        for file in files:
            document = tomllib.loads(file.read_text())
            self.assertEqual(tomllib.loads(barchan.scene.dumps(document)), document, file)

    def test_odd_values_come_back(self):
        odd = {"a": 'say "\\n"', "tab": "\t\n\r\x01\x7f\u00e9\u4e2d", "": 1, "a b": 2, "a.b": {"c d": {"e": []}}, "empty": {}, "none": [], "big": 2 ** 63 - 1, "low": -2 ** 63,
               "small": 5e-324, "third": 1 / 3, "inf": math.inf, "yes": True, "nested": [[1, 2.5], ["x", {"y": [{"z": False}]}]], "tables": [{"k": 1}, {}, {"k": {"l": {}}}],
               "phases": {"one": {"two": {"three": 3}}, "plain": 4}, "deep": {"a": {"b": [{"c": 1}]}}}
        self.assertEqual(tomllib.loads(barchan.scene.dumps(odd)), odd)
        self.assertTrue(math.isnan(tomllib.loads(barchan.scene.dumps({"x": math.nan}))["x"]))
        plain = tomllib.loads(barchan.scene.dumps({"n": numpy.float64(.1), "v": numpy.arange(3), "p": pathlib.Path("a/b"), "t": (1, 2), "b": numpy.bool_(True)}))
        self.assertEqual(plain, {"n": .1, "v": [0, 1, 2], "p": "a/b", "t": [1, 2], "b": True})
        for wrong in ({"a": {"b": None}}, {"x": [1, object()]}, {"big": 2 ** 63}):
            with self.assertRaises(TypeError):
                barchan.scene.dumps(wrong)
        with self.assertRaisesRegex(TypeError, "a.b: TOML has no NoneType"):
            barchan.scene.dumps({"a": {"b": None}})

    def test_the_program_reads_what_is_written(self):
        for name in ("splash.toml", "verification/poiseuille.toml"):
            text = barchan.scene.dumps(barchan.scene.load(ROOT / "scenes" / name))
            file = self.folder / pathlib.Path(name).name
            file.write_text(text)
            for each in ("splash_bed.vtp",):
                shutil.copy(ROOT / "scenes" / each, self.folder)
            barchan.generate(ROOT / "scenes" / name, self.folder / "a.vtp")
            barchan.generate(file, self.folder / "b.vtp")
            self.assertTrue(barchan.compare(self.folder / "a.vtp", self.folder / "b.vtp"), name)


class Shapes(Case):
    def test_grains_from_arrays(self):
        x = numpy.array([[.05, .1], [.2, .1], [.3, .12]])
        file = barchan.write_grains(self.folder / "bed.vtp", x, [.01, .009, .0095], phase="ball")
        scene = {**BALLS, "fill": [BALLS["fill"][0], {"phase": "ball", "shape": {"file": file}}]}
        scene["phases"] = {**BALLS["phases"], "ball": {**BALLS["phases"]["ball"], "diameter": {"mean": .019, "spread": .1}}}
        scene["output"] = {**BALLS["output"], "fields": ["radius"]}
        made = barchan.generate(scene, self.folder / "start.vtp").of("ball")
        self.assertLess(abs(made.x[:, :2] - x).max(), 1e-15)
        self.assertLess(abs(made["radius"] - [.01, .009, .0095]).max(), 1e-15)

    def body(self, shape, dimensions=2):
        size = [1.] * dimensions
        scene = {"spacing": .05, "dimensions": dimensions, "domain": {"size": size}, "phases": {"body": {"kind": "elastic", "density": 1000, "young": 1e6, "poisson": .3}},
                 "interactions": {"body-body": {"radius": 2.6}}, "fill": [{"phase": "body", "shape": {"surface": shape}, "velocity": [1.] + [0.] * (dimensions - 1)}],
                 "time": {"end": .01}, "output": {"every": .01}}
        return barchan.generate(scene, self.folder / "body.vtp")

    def test_bodies_from_arrays(self):
        turn = numpy.linspace(0, 2 * math.pi, 100, endpoint=False)
        disc = barchan.write_outline(self.folder / "disc.csv", .5 + .3 * numpy.column_stack([numpy.cos(turn), numpy.sin(turn)]))
        self.assertAlmostEqual(len(self.body(disc)) * .05 ** 2, math.pi * .3 ** 2, delta=.02)
        corners = numpy.array([[x, y, z] for x in (.2, .6) for y in (.2, .6) for z in (.2, .6)])
        faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
        cube = self.body(barchan.write_surface(self.folder / "cube.obj", corners, faces), 3)
        self.assertEqual(len(cube), 8 ** 3)

    def test_wrong_arrays_are_refused(self):
        good = numpy.zeros((3, 2))
        for act, words in ((lambda: barchan.write_grains(self.folder / "a.vtp", [1, 2], 1), r"expected an array \(n, 2 or 3\), found \(2,\)"),
                           (lambda: barchan.write_grains(self.folder / "a.vtp", good, [1, 2]), "expected one or 3"),
                           (lambda: barchan.write_grains(self.folder / "a.vtp", good, -1), "above 0"),
                           (lambda: barchan.write_grains(self.folder / "a.vtk", good, 1), "ends in .vtp"),
                           (lambda: barchan.write_grains(self.folder / "a.vtp", [[0, 0], [0, math.nan]], 1), "row 1 is not finite"),
                           (lambda: barchan.write_outline(self.folder / "a.csv", good[:2]), "at least 3"),
                           (lambda: barchan.write_surface(self.folder / "a.obj", numpy.zeros((3, 3)), [[0, 1, 3]]), "indices go from 0 to 2"),
                           (lambda: barchan.write_surface(self.folder / "a.obj", numpy.zeros((3, 3)), [[0., 1, 2]]), "of integers")):
            with self.assertRaisesRegex(barchan.SceneError, words):
                act()
        self.assertEqual(list(self.folder.iterdir()), [])


class Examples(Case):
    def run_code(self, code):
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "OMP_NUM_THREADS": "1", "MPLBACKEND": "Agg"}
        ended = subprocess.run(["/usr/bin/python3", "-W", "error::UserWarning", "-"], input=code, capture_output=True, text=True, env=environment, cwd=self.folder)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended.stdout

    def test_scripts(self):
        scripts = sorted((ROOT / "python/examples").glob("*.py"))
        self.assertGreaterEqual(len(scripts), 2)
        for script in scripts:
            self.assertTrue(ast.get_docstring(ast.parse(script.read_text())), script)
            self.assertTrue(self.run_code(script.read_text()), script)

    def test_notebook(self):
        for notebook in sorted((ROOT / "python/examples").glob("*.ipynb")):
            document = json.loads(notebook.read_text())
            self.assertEqual(document["nbformat"], 4)
            cells = ["".join(cell["source"]) for cell in document["cells"] if cell["cell_type"] == "code"]
            self.assertGreater(len(cells), 2)
            self.assertTrue(self.run_code("\n".join(cells)), notebook)

    def test_pages(self):
        """The examples of docs/python.md, in order."""
        page = (ROOT / "docs/python.md").read_text()
        blocks = re.findall(r"```python\n(.*?)```", page, re.S)
        self.assertGreater(len(blocks), 4)
        shutil.copytree(ROOT / "scenes", self.folder / "scenes")
        self.run_code("import warnings\nwarnings.simplefilter('ignore')\n" + "\n".join(blocks))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
