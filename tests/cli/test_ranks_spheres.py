#!/usr/bin/python3
"""Grains whose contacts ranks share out: any number of ranks and threads writes the bytes of one process.

    test_ranks_spheres.py PROGRAM SOURCE_DIR
"""

import csv
import json
import sys
import unittest

from test_ranks import SOURCE, Folder, has_mpi

# A block of spheres that falls onto a floor and spreads, beside a rigid block that is in their way, in either number of dimensions.
HEAP = """
dimensions = {dimensions}
spacing = 1e-3
[domain]
size = {size}
periodic = {periodic}
gravity = {gravity}
[phases.sand]
kind = "grains"
density = 2650
diameter = {{ mean = 0.9e-3, spread = 0.1 }}
spacing = 1e-3
restitution = 0.5
friction = 0.5
{rolling}
stiffness = 200
{more}
[phases.floor]
kind = "wall"
[interactions]
sand-sand = {{ law = "linear" }}
sand-floor = {{ law = "linear" }}
{touches}
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"] }}
[[fill]]
phase = "sand"
shape = {{ box = {{ min = {low}, max = {high} }} }}
velocity = {velocity}
{fill}
[time]
end = {end}
largest-speed = 1.5
[output]
every = {half}
history-every = {half}
fields = ["radius"]
"""
BODY = """
[phases.block]
kind = "rigid"
density = 3000
"""


def heap(dimensions, end, rolling="rolling-friction = 0.2", body=False):
    """About 2000 spheres: four chunks."""
    flat = dimensions == 2
    return HEAP.format(
        dimensions=dimensions, end=end, half=end / 2, rolling=rolling, more=BODY if body else "",
        touches='sand-block = { law = "linear" }' if body else "",
        size="[0.08, 0.06]" if flat else "[0.016, 0.03, 0.010]", periodic='["x"]' if flat else '["x", "z"]',
        gravity="[0, -9.81]" if flat else "[0, -9.81, 0]", low="[0.01, 0.001]" if flat else "[0.001, 0.001, 0]",
        high="[0.07, 0.035]" if flat else "[0.015, 0.016, 0.010]",
        velocity='["0.6*sin(900*y + 400*x)", "-0.3 + 0.3*cos(700*x)"]' if flat
        else '["0.6*sin(900*y + 400*x + 500*z)", "-0.3 + 0.3*cos(700*x)", "0.4*sin(800*y)"]',
        fill="" if not body else '[[fill]]\nphase = "block"\nshape = { box = { min = [0.02, 0.04], max = [0.05, 0.045] } }\nvelocity = [0, -1]')


@unittest.skipUnless(has_mpi(), "no MPI here")
class Spheres(Folder):
    def compare(self, text, *runs):
        """Of one process of a thread, and of so many ranks of so many threads."""
        self.run_on(0, text, "one")
        for ranks, threads in runs:
            self.run_on(ranks, text, f"of-{ranks}-{threads}", threads=threads)
            self.same("one", f"of-{ranks}-{threads}")
        return json.loads((self.at / f"of-{runs[-1][0]}-{runs[-1][1]}/run.json").read_text())

    def column(self, out, name):
        with open(self.at / out / "history.csv") as file:
            return [float(row[name]) for row in csv.DictReader(file)]

    def test_flat(self):
        report = self.compare(heap(2, 0.012), (1, 1), (2, 1), (2, 2), (3, 1))
        self.assertGreater(report["ranks"]["messages"], 0)  # the work was shared out
        self.assertGreater(report["budgets"]["neighbour_rebuilds"], 2)

    def test_in_space(self):
        self.compare(heap(3, 0.006), (2, 1), (3, 2))

    def test_without_rolling(self):
        self.compare(heap(3, 0.004, rolling=""), (3, 1))

    def test_a_rigid_body_among_them(self):
        self.compare(heap(2, 0.01, body=True), (2, 1), (3, 1))

    def test_a_restart_on_other_ranks(self):
        text = heap(3, 0.006)
        self.run_on(0, text, "one")
        for before, after in ((3, 2), (2, 0), (0, 3)):
            out = f"{before}-{after}"
            self.run_on(before, text, out, "--set", "time.end=0.003")
            self.run_on(after, text, out, "--restart", "latest")
            self.same("one", out)

    def scene(self, name, runs, sets):
        words = [word for s in sets for word in ("--set", s)]
        for ranks, threads in ((0, 1), *runs):
            ended = self.start_file(ranks, SOURCE / "scenes" / name, f"of-{ranks}-{threads}", *words, threads=threads)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.same("of-0-1", f"of-{ranks}-{threads}")

    def test_some_sleep_and_some_wake(self):
        sets = ("time.end=0.008", "output.every=0.004", "output.history-every=0.0005", "phases.sand.sleep=true", "fill.2.velocity=[0.32, -0.3]",
                "phases.sand.stiffness=100", "phases.striker.stiffness=100", "time.largest-speed=0.5")
        self.scene("splash.toml", ((2, 1), (3, 2)), sets)
        asleep = self.column("of-0-1", "asleep")
        self.assertGreater(max(asleep), 0)
        self.assertTrue(any(later < earlier for earlier, later in zip(asleep, asleep[1:])), asleep)

    def test_sizes_that_differ_much(self):
        """Cells of several levels; a large grain falls into small ones of two chunks."""
        text = heap(2, 0.003).replace("{ mean = 0.9e-3, spread = 0.1 }", "{ mean = 0.65e-3, spread = 0.5 }").replace(
            "[interactions]", '[phases.boulder]\nkind = "grains"\ndensity = 2650\ndiameter = 1.5e-2\nfriction = 0.5\nstiffness = 200\n'
            '[interactions]\nsand-boulder = { law = "linear" }') + (
            '[[fill]]\nphase = "boulder"\nshape = { points = [[0.03, 0.0435]] }\nvelocity = [0.5, -1]\n')
        self.compare(text, (2, 1), (3, 2))

    def test_a_narrow_period(self):
        """Two spheres touch on both sides of a periodic axis, and cross it."""
        text = heap(3, 0.002).replace("[0.016, 0.03, 0.010]", "[0.15, 0.03, 0.0015]").replace(
            "[0.015, 0.016, 0.010]", "[0.15, 0.016, 0.0015]").replace("spacing = 1e-3", "spacing = 1.5e-3").replace(
            "mean = 0.9e-3", "mean = 1.2e-3")
        self.compare(text, (2, 1), (3, 2))

    def between_walls(self, dimensions):
        """A heap on a step, a wall of two shapes whose tops lie in one plane; a lid of another wall comes down on it."""
        flat = dimensions == 2
        boxes = [("step", "[0.02, 0]", "[0.04, 0.0009]"), ("step", "[0.04, 0]", "[0.06, 0.0009]"), ("lid", "[0.02, 0.0352]", "[0.06, 0.04]")] if flat else [
            ("step", "[0.004, 0, 0.002]", "[0.008, 0.0009, 0.008]"), ("step", "[0.008, 0, 0.002]", "[0.012, 0.0009, 0.008]"),
            ("lid", "[0.002, 0.0162, 0.002]", "[0.014, 0.02, 0.008]")]
        walls = "".join(f'[phases.{name}]\nkind = "wall"\n' for name in ("step", "lid"))
        fills = "".join(f'[[fill]]\nphase = "{name}"\nshape = {{ box = {{ min = {low}, max = {high} }} }}\n' for name, low, high in boxes)
        return heap(dimensions, 0.004).replace("[interactions]", walls + '[interactions]\nsand-step = { law = "linear" }\nsand-lid = { law = "linear" }') + (
            fills + f'[[motion]]\nphase = "lid"\nvelocity = {"[0.2, -0.5]" if flat else "[0.2, -0.5, 0.1]"}\n')

    def test_walls_by_their_shapes(self):
        for dimensions in (2, 3):
            with self.subTest(dimensions):
                self.compare(self.between_walls(dimensions), (2, 1), (3, 2))
                self.assertGreater(max(self.column("one", "contacts")), 500)

    def test_a_restart_between_walls(self):
        text = self.between_walls(3)
        self.run_on(0, text, "one")
        for before, after in ((2, 0), (0, 3)):
            out = f"{before}-{after}"
            self.run_on(before, text, out, "--set", "time.end=0.002")
            self.run_on(after, text, out, "--restart", "latest")
            self.same("one", out)

    def test_water_over_them(self):
        self.scene("water_over_sand.toml", ((2, 1), (3, 1)), ("time.end=0.0006", "output.every=0.0003", "output.history-every=0.0002"))

    def test_forces_on_walls_that_turn(self):
        self.scene("rotating_drum.toml", ((2, 1),), ("time.end=0.004", "output.every=0.004", "output.history-every=0.001"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
