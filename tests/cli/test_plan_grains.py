#!/usr/bin/python3
"""`plan` of grains: a loose bed is measured until its contacts are made, which are most of what its run costs.

    test_plan_grains.py PROGRAM SOURCE_DIR
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import meshio
import numpy

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())

# Grains that stand apart and fall on each other within the first twentieth of the run.
LOOSE = """
dimensions = {dimensions}
spacing = 1e-3
[domain]
size = {size}
gravity = {gravity}
[phases.sand]
kind = "grains"
density = 2650
diameter = {{ mean = 1e-3, spread = 0.2 }}
restitution = 0.5
friction = 0.5
stiffness = 1e3
[phases.box]
kind = "wall"
[interactions]
sand-sand = {{ law = "linear" }}
sand-box = {{ law = "linear" }}
[[fill]]
phase = "box"
shape = {{ sides = {sides} }}
[[fill]]
phase = "sand"
shape = {{ box = {{ min = {zero}, max = {top} }} }}
packing = "staggered"
[time]
end = {end}
largest-speed = 0.5
[output]
every = 0
"""


class MeanWind(unittest.TestCase):
    """A column has one wind along x: `plan` says so where its grains have a dune."""

    def test_a_dune_in_a_column(self):
        dune = "fill.1.shape.dune={ form = \"asymmetric\", height = 2e-3, length = 0.02, at = 0.03, slip-face-angle = 30 }"
        for more in ([], ["--set", dune]):
            ended = subprocess.run([PROGRAM, "plan", pathlib.Path(sys.argv[2]) / "scenes/saltation.toml", *more], capture_output=True, text=True)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertEqual("is one mean along x, over a flat bed" in ended.stdout + ended.stderr, bool(more))


class Numbers(unittest.TestCase):
    """Numbers of grains that no material has, an influx that its box cannot take, a body that nothing bears."""

    def test_they_are_warned_of(self):
        scene = LOOSE.format(dimensions=2, size=[0.02, 0.03], gravity=[0, -9.81], sides='["bottom", "left", "right"]', zero=[0, 0], top=[0.02, 0.005], end=0.001)
        pour = '[[influx]]\nphase = "sand"\nbox = { min = [0.005, 0.02], max = [0.015, 0.025] }\nvelocity = [0, -0.5]\nflux = '
        body = '[phases.block]\nkind = "rigid"\ndensity = 500\n[interactions]'
        fill = '[[fill]]\nphase = "block"\nshape = { box = { min = [0.005, 0.01], max = [0.01, 0.015] } }\n[time]'
        with tempfile.TemporaryDirectory() as at:
            file = pathlib.Path(at) / "numbers.toml"
            for right, wrong, words in ((("friction = 0.5",) * 2, ("friction = 0.5", "friction = 5"), "beyond all materials"), (("spread = 0.2",) * 2, ("spread = 0.2", "spread = 2e-4"), "where metres were meant, 0.2"),
                                        (("[time]", pour + "1\n[time]"), ("[time]", pour + "50\n[time]"), "more than the box can take"),
                                        (("[time]", "[time]"), ("[time]", pour + "1\n[time]"), "enters  sand: about 0."),
                                        (("[interactions]", body + "\nblock-box = 1.1"), ("[interactions]", body), "it falls; expected one with what bears it")):
                for (before, after), warned in ((right, False), (wrong, True)):
                    text = scene.replace(before, after, 1)
                    file.write_text(text.replace("[time]", fill, 1) if "block" in after else text)
                    ended = subprocess.run([PROGRAM, "plan", file, "--threads", "1"], capture_output=True, text=True)
                    self.assertEqual(ended.returncode, 0, ended.stderr)
                    self.assertEqual(words in ended.stdout + ended.stderr, warned, (after, ended.stdout))


class Loose(unittest.TestCase):
    def planned(self, end):
        scene = LOOSE.format(dimensions=2, size=[0.02, 0.03], gravity=[0, -9.81], sides='["bottom", "left", "right"]', zero=[0, 0], top=[0.02, 0.015], end=end)
        with tempfile.TemporaryDirectory() as at:
            file = pathlib.Path(at) / "loose.toml"
            file.write_text(scene)
            ended = subprocess.run([PROGRAM, "plan", file, "--json", "--threads", "1"], capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        plan = json.loads(ended.stdout)
        return plan, plan["estimate"]

    def test_contacts_are_made_before_the_cost_is_taken(self):
        plan, estimate = self.planned(2)
        grains, pairs = plan["phases"]["sand"]["particles"], plan["interactions"]["sand-sand"]["pairs"]
        self.assertGreater(pairs, 2.5 * grains, "each grain touches three others and more, told from both sides")

    def test_the_rest_is_scaled_up(self):
        short, long = self.planned(1)[1], self.planned(4)[1]
        self.assertAlmostEqual(long["steps"] / short["steps"], 4, delta=0.1)
        self.assertGreater(long["processor_seconds"], 1.5 * short["processor_seconds"])


WATER = """
dimensions = 3
spacing = 1e-3
[domain]
size = [0.02, 0.05, 0.02]
periodic = ["x", "z"]
gravity = [0, -9.81, 0]
open = ["bottom"]
[phases.water]
kind = "column"
density = {density}
viscosity = 1e-6
speed = 0
held = true
[phases.sand]
kind = "grains"
material = "quartz-sand"
diameter = 1e-3
[interactions]
water-sand = {{ drag = "cheng", buoyancy = {buoyancy} }}
sand-sand = {{ law = "linear" }}
[[fill]]
phase = "sand"
shape = {{ points = [[0.005, 0.002, 0.005], [0.005, 0.04, 0.005]] }}
[time]
end = 0.1
largest-speed = 0.3
"""


class InWater(unittest.TestCase):
    def told(self, command, *words, **keys):
        with tempfile.TemporaryDirectory() as name:
            scene = pathlib.Path(name) / "w.toml"
            scene.write_text(WATER.format(**keys))
            said = subprocess.run([PROGRAM, command, str(scene), *words], capture_output=True, text=True, cwd=name)
            self.assertEqual(said.returncode, 0, said.stderr)
            history = pathlib.Path(name) / "out/w/history.csv"
            return said.stdout + said.stderr, history.read_text().splitlines() if history.exists() else []

    def test_a_dense_fluid_that_bears_nothing_is_warned_of(self):
        words = "does not bear it; add buoyancy = true"
        self.assertIn(words, self.told("plan", density=1000, buoyancy="false")[0])
        self.assertNotIn(words, self.told("plan", density=1000, buoyancy="true")[0])
        self.assertNotIn(words, self.told("plan", density=1.2, buoyancy="false")[0])

    def test_the_mass_of_what_leaves_falls(self):
        rows = self.told("run", "--threads", "1", density=1000, buoyancy="true")[1]
        mass = [float(row.split(",")[rows[0].split(",").index("sand_mass [kg]")]) for row in rows[1:]]
        self.assertAlmostEqual(mass[0] / (2 * 2650 * 3.141592653589793 / 6 * 1e-9), 1, places=9)
        self.assertAlmostEqual(mass[-1] / mass[0], 0.5, places=9)


BETWEEN = """spacing = 1e-3
[domain]
size = [0.03, 0.03]
gravity = [0, -9.81]
[phases.large]
kind = "grains"
material = "quartz-sand"
diameter = 2e-3
[phases.small]
kind = "grains"
material = "quartz-sand"
diameter = 8e-4
[phases.box]
kind = "wall"
[interactions]
large-large = { law = "linear" }
small-small = { law = "linear" }
large-small = { law = "linear" }
large-box = { law = "linear" }
small-box = { law = "linear" }
[[fill]]
phase = "box"
shape = { sides = ["left", "right", "bottom"] }
[[fill]]
phase = "large"
shape = { box = { min = [0, 0], max = [0.03, 0.02] } }
packing = "random"
[[fill]]
phase = "small"
shape = { box = { min = [0, 0], max = [0.03, 0.02] } }
leave-out = "earlier-fills"
[time]
end = 1e-3
largest-speed = 0.3
"""


BED = """spacing = 1e-3
[domain]
size = [0.04, 0.05]
gravity = [0, -9.81]
[phases.sand]
kind = "grains"
material = "quartz-sand"
diameter = { mean = 2e-3, spread = 0.1 }
[phases.box]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-box = { law = "linear" }
[[fill]]
phase = "box"
shape = { sides = ["bottom", "left", "right"] }
[[fill]]
phase = "sand"
shape = { bed = 0.02 }
packing = "settled"
[time]
end = 0.02
"""


class ABedThatSettles(unittest.TestCase):
    def test_it_is_level_between_side_walls(self):
        """Before, grains nearer to the right wall than the radius of the largest were lost in every trial: 158 of 189, and a slope."""
        with tempfile.TemporaryDirectory() as name:
            scene, start = pathlib.Path(name) / "b.toml", pathlib.Path(name) / "b.vtu"
            scene.write_text(BED)
            said = subprocess.run([PROGRAM, "generate", str(scene), "-o", str(start)], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            mesh = meshio.read(start)
            x = mesh.points[mesh.point_data["phase"] == 0]
            tops = [x[(x[:, 0] > low) & (x[:, 0] < low + 0.008), 1].max() for low in numpy.arange(0, 0.04, 0.008)]
            self.assertGreater(min(tops), 0.017)
            self.assertGreater(len(x), 180)


class SmallOnesBetweenLargeOnes(unittest.TestCase):
    def test_two_sizes_in_a_slab_are_warned_of(self):
        with tempfile.TemporaryDirectory() as name:
            scene = pathlib.Path(name) / "b.toml"
            for small, warned in (("8e-4", True), ("1.8e-3", False)):
                scene.write_text(BETWEEN.replace("8e-4", small))
                said = subprocess.run([PROGRAM, "plan", str(scene)], capture_output=True, text=True)
                self.assertEqual(said.returncode, 0, said.stderr)
                self.assertEqual("of the mass that one of" in said.stdout, warned, said.stdout)

    def test_no_two_overlap(self):
        with tempfile.TemporaryDirectory() as name:
            scene, start = pathlib.Path(name) / "b.toml", pathlib.Path(name) / "b.vtu"
            scene.write_text(BETWEEN)
            said = subprocess.run([PROGRAM, "generate", str(scene), "-o", str(start)], capture_output=True, text=True)
            self.assertEqual(said.returncode, 0, said.stderr)
            mesh = meshio.read(start)
            phase, x = mesh.point_data["phase"], mesh.points[:, :2]
            radius = numpy.where(phase == 0, 1e-3, 4e-4)[phase < 2]
            x = x[phase < 2]
            self.assertGreater((phase == 1).sum(), 30)
            apart = numpy.linalg.norm(x[:, None] - x[None], axis=2) - radius[:, None] - radius[None]
            numpy.fill_diagonal(apart, 1.0)
            self.assertGreater(apart.min(), -1e-9)
            self.assertGreater((x[:, 0] - radius).min(), -1e-9)
            self.assertLess((x[:, 0] + radius).max(), 0.03 + 1e-9)
            self.assertGreater((x[:, 1] - radius).min(), -1e-9)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
