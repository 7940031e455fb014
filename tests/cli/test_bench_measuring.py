#!/usr/bin/python3
"""What bench/accuracy and bench/stability measure, on data whose answer is known; and bench/barchan_bench, which all programs of bench/ share.

    /usr/bin/python3 tests/cli/test_bench_measuring.py PROGRAM ROOT"""

import ast
import contextlib
import io
import math
import pathlib
import re
import sys
import tempfile
import types
import unittest

import numpy

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "build/barchan"
ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2])
sys.path[:0] = [str(ROOT / "bench"), str(ROOT / "bench/accuracy"), str(ROOT / "bench/stability")]
import cases_grains  # noqa: E402
import cases_surface  # noqa: E402
import cases_wind  # noqa: E402
import ensemble  # noqa: E402
import harness  # noqa: E402
import square_patch_reference  # noqa: E402
from barchan_bench import frame as frames, run, store, table  # noqa: E402

# What reads frames, series and tables, and what starts processes: modules, and functions of modules and objects. In bench/ one file starts processes and none reads.
READERS = {"vtk", "vtkmodules", "paraview", "meshio", "xml", "csv", "pandas", "loadtxt", "genfromtxt", "fromfile", "memmap"}
STARTERS = {"subprocess", "multiprocessing", "pty", "system", "popen", "fork", "forkpty", "posix_spawn", "posix_spawnp", "create_subprocess_exec",
            "create_subprocess_shell", *(f"{verb}{end}" for verb in ("exec", "spawn") for end in ("l", "le", "lp", "lpe", "v", "ve", "vp", "vpe"))}
HOMES = {"barchan_bench/run.py": STARTERS, "barchan_bench/store.py": {"csv"}}  # frames, series and tables: the package of python/, through barchan_bench/frame.py
ELSEWHERE = {  # a file, what it may use besides, and why
    "robustness/meshes.py": ({"meshio", "vtkmodules"}, "writes and reads shapes, by other readers than the program's"),
    "robustness/mutants.py": ({"subprocess"}, "starts compilers and the programs of the tests"),
}


def strays(bench):
    """Places of bench/ that read what a run writes, or start a process, outside of their one file."""
    found = []
    for file in sorted(bench.rglob("*.py")):
        name = str(file.relative_to(bench))
        allowed = HOMES.get(name, set()) | ELSEWHERE.get(name, (set(),))[0]
        for node in ast.walk(ast.parse(file.read_text())):
            used = set()
            if isinstance(node, ast.Import):
                used = {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                used = {(node.module or "").split(".")[0], *(alias.name for alias in node.names)}
            elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                used = {node.func.attr}
            found += [f"{name}:{node.lineno}: {word}" for word in sorted(used & (READERS | STARTERS) - allowed)]
    return found


class Synthetic(frames.Frame):
    """A frame from arrays."""

    def __init__(self, x, time=0., names=("water",), **arrays):
        self.time, self.x, self.names = time, numpy.column_stack([x, numpy.zeros(len(x))]), list(names)
        self.arrays = {"phase": numpy.zeros(len(x), int), **arrays}


def lattice(nx, ny, dx=1.):
    x, y = numpy.meshgrid((numpy.arange(nx) + .5) * dx, (numpy.arange(ny) + .5) * dx)
    return numpy.column_stack([x.ravel(), y.ravel()])


class Surface(unittest.TestCase):
    def test_damped_cosine(self):
        t = numpy.arange(0, 6.8, .0567)
        omega, gamma = cases_surface.damped_cosine(t, 3 * numpy.exp(-.01 * t) * numpy.cos(5.5 * t + .3))
        self.assertAlmostEqual(omega, 5.5, places=6)
        self.assertAlmostEqual(gamma, .01, places=6)

    def test_wave_amplitude_of_the_exact_wave_on_moved_particles(self):
        rng, k = numpy.random.default_rng(1), math.pi
        x = lattice(100, 50, .02) + rng.uniform(-.004, .004, (5000, 2))
        mode = numpy.column_stack([-numpy.cosh(k * x[:, 1]) * numpy.sin(k * x[:, 0]), numpy.sinh(k * x[:, 1]) * numpy.cos(k * x[:, 0]),
                                   0 * x[:, 0]]) / math.sinh(k)
        self.assertAlmostEqual(cases_surface.wave_amplitude(Synthetic(x, velocity=.7 * mode), k), .7, places=12)

    def test_front_overlooks_a_lone_drop(self):
        x = numpy.vstack([lattice(20, 10), [[35., .5]]])
        self.assertAlmostEqual(cases_surface.front(Synthetic(x), 1.), 20.)

    def test_energy_of_compression_is_the_work(self):
        scene = {"dimensions": 2, "spacing": .1, "domain": {"gravity": [0, -10]},
                 "phases": {"water": {"density": 1000, "sound-speed": 20}}}
        frame = Synthetic(numpy.array([[0., 2.]]), velocity=numpy.array([[3., 4, 0]]), density=numpy.array([1010.]))
        kinetic, height, squeezed = cases_surface.Energy(scene, "water").parts(frame)
        self.assertAlmostEqual(kinetic, .5 * 10 * 25)
        self.assertAlmostEqual(height, 10 * 10 * 2)
        rho = numpy.linspace(1000, 1010, 100001)
        work = 10 * numpy.trapz(20**2 * (rho - 1000) / rho**2, rho)  # m p/rho^2 drho
        self.assertAlmostEqual(squeezed, work, places=6)

    def test_patch_reference_starts_with_the_series_of_le_touze(self):
        _, pressure, _ = square_patch_reference.patch(.1, [.49 + .49j], steps=20)
        series = sum(-32 / (m * n * math.pi**2 * ((n * math.pi) ** 2 + (m * math.pi) ** 2)) * math.sin(m * math.pi / 2) * math.sin(n * math.pi / 2)
                     for m in range(1, 200, 2) for n in range(1, 200, 2))
        self.assertAlmostEqual(pressure[0], series, places=3)
        self.assertAlmostEqual(series, -.1473, places=4)


class Grains(unittest.TestCase):
    def test_holes_of_a_lattice(self):
        x = lattice(20, 20)
        whole, _ = cases_grains.largest_hole(x, [0, 0], [20, 20], 1., [True, True], fine=8)
        self.assertAlmostEqual(whole, math.sqrt(.5), delta=.1)
        gone, middle = cases_grains.largest_hole(numpy.delete(x, 210, axis=0), [0, 0], [20, 20], 1., [True, True], fine=8)
        self.assertAlmostEqual(gone, 1., delta=.1)
        self.assertLess(numpy.abs(middle - x[210]).max(), .3)

    def test_pairs_across_periodic_sides(self):
        x = lattice(10, 10)
        i, _, _ = cases_grains.pairs(x, x, 1.2, [10, 10], [True, True])
        self.assertEqual(len(i), 400)
        i, _, _ = cases_grains.pairs(x, x, 1.2, [10, 10], [True, False])
        self.assertEqual(len(i), 380)

    def test_friction_of_a_shear_flow(self):
        """mu (du/dy)^2 by area, in a periodic wave of velocity that the kernel resolves."""
        scene = {"dimensions": 2, "spacing": .025, "domain": {"size": [1, 1], "periodic": ["x", "y"]},
                 "phases": {"air": {"density": 2, "viscosity": .5, "artificial-viscosity": 0, "sound-speed": 1}, "sand": {"density": 1}},
                 "interactions": {"air-air": {"radius": 3.0}, "air-sand": {"radius": 2.5}, "sand-sand": 1.1}}
        x = lattice(40, 40, .025)
        u = numpy.column_stack([numpy.sin(2 * math.pi * x[:, 1]), 0 * x[:, 0], 0 * x[:, 0]])
        frame = Synthetic(x, names=("air", "sand"), velocity=u, density=numpy.full(1600, 2.))
        self.assertAlmostEqual(cases_grains.Budget(scene).friction(frame) / (.5 * (2 * math.pi) ** 2), 1, delta=.03)


class Wind(unittest.TestCase):
    def test_speed_of_a_logarithmic_profile(self):
        wind = types.SimpleNamespace(size=[40, 20], dx=1.)
        x = lattice(40, 20)
        u = numpy.column_stack([numpy.log(x[:, 1] / .01), 0 * x[:, 0], 0 * x[:, 0]])
        got = cases_wind.speed([Synthetic(x, velocity=u)], wind, 39., 4., 8.2)
        self.assertAlmostEqual(got, math.log(820), delta=.01)

    def test_a_scene_survives_being_written(self):
        for name in ("paper/dune", "paper/flat_bed"):
            self.assertEqual(harness.tomllib.loads(harness.toml(harness.document(name))), harness.document(name))
            fixed = harness.tomllib.loads(harness.toml(cases_wind.held_fixed(harness.document(name))))
            self.assertEqual(fixed["phases"]["sand"]["kind"], "wall")
            self.assertNotIn("sand-sand", fixed["interactions"])


class Package(unittest.TestCase):
    def folder(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return pathlib.Path(folder.name)

    def test_one_reader_and_one_place_that_starts_processes(self):
        self.assertEqual(strays(ROOT / "bench"), [])

    def test_a_second_one_is_found(self):
        for text in ("import subprocess", "from subprocess import run", "import os\nos.execvp('barchan', [])", "import os\nos.system('barchan')",
                     "from os import popen", "def f():\n  import asyncio\n  asyncio.create_subprocess_exec('barchan')", "import vtk",
                     "from vtkmodules.vtkIOXML import vtkXMLPolyDataReader", "import meshio", "import xml.etree.ElementTree as tree", "from xml import etree",
                     "import csv", "import numpy\nnumpy.loadtxt('history.csv')", "from numpy import genfromtxt", "import numpy\nnumpy.fromfile('a.vtp')"):
            bench = self.folder()
            (bench / "accuracy").mkdir()
            (bench / "accuracy/planted.py").write_text(text + "\n")
            self.assertEqual(len(strays(bench)), 1, text)
            (bench / "barchan_bench").mkdir()
            (bench / "accuracy/planted.py").rename(bench / "barchan_bench/page.py")
            self.assertEqual(len(strays(bench)), 1, text)

    def test_a_run_from_its_scene_to_its_frames(self):
        out = self.folder()
        text = (ROOT / "scenes/verification/couette.toml").read_text()
        # Long enough: Linux may count all of a run of a few milliseconds as the system's, none as the user's.
        ended = run.scene(PROGRAM, text, out, ["time.end=2", "output.every=1"])
        self.assertEqual((ended.status, ended.name, ended.report["end_reason"]), (0, "case", "end"))
        self.assertTrue(0 < ended.user and 0 < ended.wall and ended.memory > 1000)
        self.assertEqual(ended.seconds.work, ended.report["steps"] * sum(ended.report["particles"].values()))
        times = [time for time, _ in ended.series()]
        self.assertEqual((times[0], times[-1], len(times)), (0, 2, 3))
        whole, part = frames.Frame(ended.series()[-1][1]), frames.Frame(ended.series()[-1][1], 7., "water")
        self.assertEqual((whole.time, part.time, len(part.x)), (2, 7., ended.report["particles"]["water"]))
        self.assertTrue((numpy.diff(part["id"]) > 0).all() and (part["phase"] == whole.names.index("water")).all())
        self.assertEqual(ended.history()["time"][-1], 2)
        run.generate(PROGRAM, "couette", out / "start.vtu", check=True)
        start, first = frames.Frame(out / "start.vtu"), frames.Frame(ended.series()[0][1])
        self.assertEqual(start.names, first.names)
        self.assertTrue((start.x == first.x).all())

    def test_runs_that_do_not_end_well(self):
        with self.assertRaisesRegex(run.Broken, "couette.toml ended with status 2: .*spacing"):
            run.scene(PROGRAM, "verification/couette", self.folder(), ["spacing=-1"])
        late = run.scene(PROGRAM, "couette", self.folder(), ["time.end=1000"], timeout=.5, check=False)
        self.assertIsNone(late.status)
        self.assertLess(late.wall, 30)
        self.assertEqual(run.command([sys.executable, "-c", "import os; os.kill(os.getpid(), 9)"]).status, -9)
        self.assertEqual(run.command([sys.executable, "-c", "import os; print(os.environ['A'])"], environment={"A": "b"}).stdout, "b\n")
        with self.assertRaises(FileNotFoundError):
            run.scene_file("no such scene")

    def test_user_seconds_are_those_of_one_command(self):
        busy = [sys.executable, "-c", "import os\nwhile os.times().user < .4: sum(range(10000))"]
        self.assertAlmostEqual(run.command(busy).user, .4, delta=.2)
        self.assertLess(run.command([sys.executable, "-c", "pass"]).user, .2)

    def test_settings_come_before_what_is_added(self):
        words = run.words("barchan", "a.toml", "out", ["time.end=1"], threads=None, options=["--set", "time.end=2"])
        self.assertEqual(words, ["barchan", "run", "a.toml", "--out", "out", "--quiet", "--set", "time.end=1", "--set", "time.end=2"])

    def test_tables(self):
        file = self.folder() / "history.csv"
        file.write_text("# a remark\ntime [s],step,u [m/s]\n0,0,1e-3\n.5,1,nan\n")
        history = frames.table(file)
        self.assertEqual(list(history), ["time [s]", "step", "u [m/s]"])
        self.assertEqual((history["time"][1], history["time [s]"][1], history["u"][0]), (.5, .5, 1e-3))
        self.assertTrue(math.isnan(history["u"][1]) and "u" in history and "v" not in history)
        self.assertEqual(history.rows()[0], {"time": 0, "step": 0, "u": 1e-3})
        with self.assertRaisesRegex(KeyError, 'history.csv: no column "v".*it has time'):
            history["v"]
        file.write_text("time [s],step\n")
        self.assertEqual((len(frames.table(file)["time"]), frames.table(file).rows()), (0, []))

    def test_what_is_no_frame_is_unreadable(self):
        for name, read in (("a.vtp", frames.Frame), ("a.vtu", frames.Frame), ("a.pvd", frames.series)):
            file = self.folder() / name
            file.write_text("<VTKFile")
            with self.assertRaises(frames.Unreadable):
                read(file)

    def test_particles_that_are_written_are_read(self):
        file, x = self.folder() / "bed.vtp", numpy.arange(6.).reshape(2, 3)
        frames.write_particles(file, x, "sand", radius=numpy.array([1., 2.]))
        read = frames.Frame(file, phase="sand")
        self.assertTrue((read.x == x).all() and (read["radius"] == [1, 2]).all() and (read["id"] == [0, 1]).all())

    def test_a_figure_beside_its_bound(self):
        table.rows.clear()
        with contextlib.redirect_stdout(io.StringIO()) as said:
            for value, at_least in ((1., False), (3., False), (3., True), (1., True)):
                table.report("case", "scheme", 2, "error", value, 2., 0., at_least)
            table.attempt("case", "scheme", 2, lambda: run.command([sys.executable, "-c", "raise SystemExit(3)"], check=True))
        self.assertEqual([r["good"] for r in table.rows], [True, False, True, False, False])
        self.assertEqual(["MISSED" in line for line in said.getvalue().splitlines()], [False, True, False, True, True])
        self.assertEqual(table.head("a", "b"), "| a | b |\n| --- | --- |")

    def test_results_come_back_as_they_were_kept(self):
        file = self.folder() / "results/case.csv"
        flat = [{"what": "a, b", "value": 1.5, "word": "1.5", "n": 2}, {"what": "", "value": None, "good": True, "more": [1, [2.0, "x"]]}]
        many = {"processor": "it's \"one\"", "rows": flat, "by": {"2 ranks": {"x": 1e-300, "ways": {}}, "3": {"x": -0.1, "ways": {"2": "[x]"}}},
                "deep": {"facts": {"[a]": 1}, "lists": {"one": [{"k": 1}], "[[two]]": [{"k": {"j": 2}}]}}, "none": [], "empty": {}}
        for results in (flat, many, {"a": {"x": 1}}, {"a": {"b": {"c": 2}}}):
            store.keep(file, results)
            self.assertEqual(store.load(file), results)
        self.assertIsNone(store.load(file.with_name("other.csv")))
        store.keep(file, {"runs": [{"u": 1, "t": [0] * 1000}]}, leave=("t",))
        self.assertEqual(store.load(file), {"runs": [{"u": 1}]})

    def test_no_history_and_no_path_of_this_machine_is_kept(self):
        file = self.folder() / "case.csv"
        for wrong in ({"t": [0.] * 51}, {"words": f"{ROOT}/scenes/dune.toml: wrong"}, {"a > b": 1}):
            with self.assertRaises(ValueError):
                store.keep(file, wrong)
            self.assertFalse(file.exists())
        absolute = re.compile(r"(?:^|[\s,\"(])/(?!usr/)\w+/\w+", re.M)
        self.assertEqual([(str(f), found[0]) for f in sorted((ROOT / "bench").rglob("*.csv")) if (found := absolute.search(f.read_text()))], [])


class Ensemble(unittest.TestCase):
    def test_members_differ_and_forces_follow(self):
        scene = {"spacing": 1, "time": {"end": 1.}, "phases": {"sand": {"density": 2}},
                 "fill": [{"phase": "sand"}, {"phase": "air", "velocity": {"log-profile": {"friction-velocity": 1., "roughness": 1}}}],
                 "forcing": [{"phase": "air", "acceleration": [100, 0]}]}
        options = types.SimpleNamespace(runs=24, ustar_factor=2., density_factor=.5, set=[])
        runs = list(ensemble.members(scene, ["a", "b"], options))
        self.assertEqual(len({(m["friction_velocity"], m["precision"], program) for m, program, _ in runs}), 12)
        self.assertEqual(len({m["seed"] for m, _, _ in runs}), 24)
        self.assertIn("forcing.0.acceleration=[400.0, 0.0]", runs[1][2])
        self.assertIn("phases.sand.density=1.0", runs[1][2])

    def test_verdict(self):
        good = {"status": 0, "message": "", "density_error": .01, "grains_left": 0}
        result = {"runs": [good] * 3, "ustar_factor": 1, "density_factor": 1}
        self.assertTrue(ensemble.verdict(result)[1])
        for bad in ({"density_error": .03}, {"grains_left": 1}, {"status": 3, "message": "why"}):
            self.assertFalse(ensemble.verdict(dict(result, runs=[good, dict(good, **bad)]))[1], bad)
        stopped = dict(result, runs=[good, dict(good, status=3, message="why")], ustar_factor=2)
        self.assertTrue(ensemble.verdict(stopped)[1])
        self.assertFalse(ensemble.verdict(dict(stopped, runs=[dict(good, status=-11)]))[1])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
