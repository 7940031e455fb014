#!/usr/bin/python3
"""Weight along -z: what has heights goes along z. A scene that is turned gives the turned result; what cannot is refused by name.

    test_up.py PROGRAM SOURCE_DIR
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
SOURCE = pathlib.Path(sys.argv[2])
sys.path.insert(0, str(SOURCE / "python"))
import barchan  # noqa: E402

# Of a scene with weight along -y: "(a, b)" stands for the numbers along the axis of heights and along the third one.
SCENE = """dimensions = 3
spacing = 1e-3
[domain]
size = [0.012, (0.02, 0.008)]
gravity = [0, (-9.81, 0)]
open = ["right"]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
stiffness = 500
friction = 0.4
[phases.ball]
kind = "rigid"
density = 2650
[phases.floor]
kind = "wall"
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom", "left", "front", "back"] }
[[fill]]
phase = "sand"
FILL
[time]
end = 0.03
largest-speed = 1
[output]
every = 0.03
"""
AXES = {"y": (1, 2), "z": (2, 1)}


def turned(text, up):
    """The scene with the axis of heights `up`: y and z change places."""
    import re
    def pair(match):
        return match.group(1) + ", " + match.group(2) if up == "y" else match.group(2) + ", " + match.group(1)
    return re.sub(r"\(([^(),]+), ([^(),]+)\)", pair, text)


class Up(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def barchan(self, *words, status=0):
        done = subprocess.run([PROGRAM, *words], cwd=self.path, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, status, done.stdout)
        return done.stdout

    def run_of(self, up, fill, more=""):
        """x, heights and third coordinates of the grains at the end, by id; what run.json and the last row of history say."""
        (self.path / f"{up}.toml").write_text(turned(SCENE.replace("FILL", fill).replace("[phases.ball]\nkind = \"rigid\"\ndensity = 2650\n", "") + more, up))
        self.barchan("run", f"{up}.toml", "--quiet", "--threads", "1", "--out", up)
        frame = barchan.open(self.path / up)[-1]
        grains = frame.of("sand")
        order = numpy.argsort(grains["id"])
        high, third = AXES[up]
        with open(self.path / up / "history.csv", newline="") as file:
            last = list(csv.DictReader(file))[-1]
        return grains.x[order][:, [0, high, third]], last

    def test_grains_that_fall_and_slide(self):
        points = ", ".join(f"[{2 + 1.3 * i}e-3, ({3 + 1.1 * (i % 3)}e-3, {2 + 1.05 * (i // 2)}e-3)]" for i in range(7))
        fill = f"shape = {{ points = [{points}] }}\nvelocity = [0.05, (-0.1, 0.03)]"
        one, other = self.run_of("y", fill)[0], self.run_of("z", fill)[0]
        self.assertEqual(one.shape, other.shape)
        self.assertLess(numpy.abs(one - other).max(), 1e-9)
        self.assertGreater(one[:, 1].min(), 0.45e-3)  # the bottom holds them

    def test_a_bed_settles(self):
        for fill in ('shape = { bed = 5e-3 }\npacking = "settled"',
                     'shape = { bed = 3e-3, dune = { height = 3e-3, length = 8e-3, at = 6e-3 } }\npacking = "settled"',
                     'shape = { box = { min = [0, (0, 0)], max = [6e-3, (4e-3, 8e-3)] } }\npacking = "settled"'):
            with self.subTest(fill):
                one, other = (self.run_of(up, fill)[0] for up in "yz")
                self.assertAlmostEqual(len(other) / len(one), 1.0, delta=0.1)
                for q in (0.02, 0.5, 0.98):
                    self.assertAlmostEqual(numpy.quantile(one[:, 1], q), numpy.quantile(other[:, 1], q), delta=0.5e-3)
                self.assertLess(other[:, 2].max(), 8e-3)

    def test_grains_enter(self):
        for more in ('[[influx]]\nphase = "sand"\nside = "right"\nflux = 0.3\ndecay-height = 4e-3\nspeed = 0.4\nangle = -10\n',
                     '[[influx]]\nphase = "sand"\nbox = { min = [4e-3, (12e-3, 2e-3)], max = [8e-3, (14e-3, 6e-3)] }\nflux = 2e-3\nvelocity = [0, (-0.2, 0)]\n'):
            with self.subTest(more):
                fill = "shape = { points = [[2e-3, (1e-3, 2e-3)]] }"
                (one, first), (other, second) = (self.run_of(up, fill, more) for up in "yz")
                self.assertGreater(len(one), 10)
                self.assertAlmostEqual(len(other) / len(one), 1.0, delta=0.2)
                self.assertAlmostEqual(one[:, 1].mean(), other[:, 1].mean(), delta=2e-3)
                self.assertEqual(first.keys() & {k for k in first if "_in" in k}, second.keys() & {k for k in second if "_in" in k})

    def test_what_has_its_heights_along_y_is_refused(self):
        scene = turned(SCENE.replace("FILL", "shape = { bed = 2e-3, dune = { form = \"formula\", formula = \"1e-3*x\" } }"), "z")
        scene += '[[saltation]]\nname = "layer"\nphase = "sand"\nevery = 1e-3\n'
        (self.path / "s.toml").write_text(scene)
        said = self.barchan("plan", "s.toml", status=2)
        for key in ("fill.1.shape.dune.form", "saltation.0"):
            self.assertIn(f"{key}: ", said)
        self.assertEqual(said.count("expected a scene whose gravity is along -y"), 2, said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
