#!/usr/bin/python3
"""Mistakes of new users: each is answered by what to type instead, in one message, with status 2 and without an output folder.

    test_mistakes.py PROGRAM SOURCE_DIR

COMMANDS: what was typed, and what the message must contain. SCENES: what was written in the place of what in a small scene, and what the
message must contain.
"""
import shlex
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()

SCENE = """spacing = 0.1
[domain]
size = [1, 1]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
[phases.ground]
kind = "wall"
[interactions]
water-water = 2.1
water-ground = 2.1
[[fill]]
phase = "ground"
shape = { sides = ["bottom"] }
[[fill]]
phase = "water"
shape = { box = { min = [0, 0], max = [1, 0.5] } }
[time]
end = 0.01
"""

COMMANDS = [
    # the command
    ("", "no command"),
    ("rnu s.toml", 'did you mean "run"?'),
    ("start s.toml", 'did you mean "barchan run SCENE"?'),
    ("check s.toml", 'did you mean "barchan plan SCENE"?'),
    ("resume s.toml", 'did you mean "barchan run SCENE --restart latest"?'),
    ("help", 'did you mean "barchan --help"?'),
    ("version", 'did you mean "barchan --version"?'),
    ("init mine", 'did you mean "barchan new NAME"?'),
    ("ls", 'did you mean "barchan list"?'),
    ("s.toml", 'did you mean "barchan run s.toml"?'),
    ("gears", 'did you mean "barchan run gears"?'),
    ("--versoin", "did you mean --version?"),
    # the scene
    ("run", "SCENE is missing; expected `barchan run SCENE`, as in `barchan run dune`"),
    ("run dnue", 'did you mean "dune"?'),
    ("run Dune", 'did you mean "dune"?'),
    ("run gersho", 'did you mean "gresho"?'),
    ("run examples/dune.toml", 'did you mean "dune"?'),
    ("run t.toml", 'did you mean "s.toml"?'),
    ("run s.tml", 'did you mean "s.toml"?'),
    ("run folder", "is a directory; expected a scene file (.toml)"),
    ("run s.toml other.toml", '"other.toml" is one word too many; expected `barchan run SCENE`'),
    # options
    ("run s.toml --output o", "did you mean --out DIR?"),
    ("run s.toml -o o", "did you mean --out DIR?"),
    ("run s.toml --thread 2", "did you mean --threads?"),
    ("run s.toml -j 4", "did you mean --threads N?"),
    ("run s.toml --threads two", "two not in range 1 to 4096"),
    ("run s.toml --dry-run", "did you mean --dry?"),
    ("run s.toml -q", "did you mean --quiet?"),
    ("run s.toml --resume", "did you mean --restart latest?"),
    ("run s.toml --restart", "--restart has no value; expected --restart FILE|latest"),
    ("run s.toml --restart last", 'expected a checkpoint, or "latest"'),
    ("run s.toml --time.end=1", "did you mean --set time.end=1?"),
    ("run s.toml --spacing 0.2", "did you mean --set spacing=VALUE?"),
    ("generate s.toml", "--output FILE is missing; expected `barchan generate SCENE -o FILE`"),
    ("generate s.toml -o s.vtk", "expected a file that ends in .vtp or .vtu"),
    ("compare s.toml", "FILE is missing; expected `barchan compare FILE FILE`"),
    ("list scene", 'did you mean "scenes"?'),
    ("completion tcsh", '"tcsh" is not known; expected "bash", "zsh" or "fish"'),
    ("new", "NAME is missing; expected `barchan new NAME`"),
    ("new mine dune", '"dune" is one word too many; expected `barchan new NAME`'),
    ("new s", "is there already, and stays as it is; expected another name"),
    ("new mine --from dnue", 'did you mean "dune"?'),
    # --set
    ("run s.toml --set", "--set has no value; expected --set KEY=VALUE, as in --set time.end=0.01"),
    ("run s.toml time.end=1", "did you mean --set 'time.end=1'?"),
    ("run s.toml --set time.end", "expected KEY=VALUE, as in time.end=0.01"),
    ("run s.toml --set time.end 1", "expected KEY=VALUE|one word too many"),
    ("run s.toml --set end=1", 'did you mean "time.end"?'),
    ("run s.toml --set time.ned=1", 'did you mean "end"?'),
    ("run s.toml --set time.end=0,01", "did you mean 0.01, without quotes or a unit?"),
    ("run s.toml --set 'time.end=10 ms'", "did you mean 0.01, without quotes or a unit?"),
    ("run s.toml --set fill.2.phase=water", "expected a number from 0 to 1"),
    ("run s.toml --set phases.watr.density=1", 'did you mean "water"?'),
]

SCENES = [
    ("spacing = 0.1", "spaceing = 0.1", 'did you mean "spacing"?'),
    ("spacing = 0.1", 'spacing = "0.1"', "did you mean 0.1, without quotes or a unit?"),
    ("spacing = 0.1", 'spacing = "10 cm"', "did you mean 0.1, without quotes or a unit?"),
    ('kind = "fluid"', "kind = fluid", 'expected "fluid"'),
    ('kind = "fluid"', 'kind = "liquid"', 'expected "fluid", "elastic"'),
    ("gravity = [0, -9.81]", "gravity = -9.81", "expected an array of 2 numbers (m/s2)"),
    ("gravity = [0, -9.81]", "gravity = [0, 0, -9.81]", "expected an array of 2 numbers (m/s2)"),
    ("density = 1000", "density = 1000 kg/m3", "expected a number in units of SI, its unit in a comment"),
    ("viscosity = 1e-3", "viscosity = -1", "expected a number >= 0 (m2/s)"),
    ("[[fill]]\nphase = \"ground\"", "[fill]\nphase = \"ground\"", "expected [[fill]] in place of [fill]"),
    ("[time]\nend = 0.01\n", "", "time: missing; expected a section"),
    ("water-ground = 2.1\n", "", "ground: nothing interacts with this wall"),
    ("water-ground = 2.1", "water-gruond = 2.1", 'did you mean "ground"?'),
    ("[domain]", "gravity = [0, -9.81]\n[domain]", 'did you mean "domain.gravity"?'),
    ("[domain]", "[constants]\nd = 1\n[domain]", "nothing uses it"),
]


def said_of(folder, words):
    done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, timeout=120)
    return done.returncode, done.stderr


class Mistakes(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "folder").mkdir()
        (self.folder / "s.toml").write_text(SCENE)

    def answered(self, words, expected):
        status, said = said_of(self.folder, words)
        self.assertEqual(status, 2, said)
        self.assertTrue(any(each in said for each in [expected, *expected.split("|")]), f"expected: {expected}\nsaid: {said}")
        self.assertTrue(said.startswith("barchan: "), said)
        self.assertFalse((self.folder / "out").exists())

    def test_fifty_and_more(self):
        self.assertGreaterEqual(len(COMMANDS) + len(SCENES), 50)
        self.assertEqual(len(set(COMMANDS) | set(SCENES)), len(COMMANDS) + len(SCENES))

    def test_commands(self):
        for typed, expected in COMMANDS:
            with self.subTest(typed=f"barchan {typed}"):
                self.answered(shlex.split(typed), expected)

    def test_scenes(self):
        for before, after, expected in SCENES:
            with self.subTest(written=after):
                self.assertIn(before, SCENE)
                (self.folder / "w.toml").write_text(SCENE.replace(before, after, 1))
                self.answered(["run", "w.toml"], expected)

    def test_the_scene_itself_is_right(self):
        self.assertEqual(said_of(self.folder, ["plan", "s.toml"])[0], 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
