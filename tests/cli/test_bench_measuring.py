#!/usr/bin/python3
"""What bench/accuracy and bench/stability measure, on data whose answer is known.

    /usr/bin/python3 tests/cli/test_bench_measuring.py PROGRAM ROOT"""

import math
import pathlib
import sys
import types
import unittest

import numpy

ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2])
sys.path[:0] = [str(ROOT / "bench/accuracy"), str(ROOT / "bench/stability")]
import cases_grains  # noqa: E402
import cases_surface  # noqa: E402
import cases_wind  # noqa: E402
import ensemble  # noqa: E402
import harness  # noqa: E402
import square_patch_reference  # noqa: E402


class Synthetic(harness.Frame):
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
