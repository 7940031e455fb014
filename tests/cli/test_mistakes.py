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
viscosity = 1e-6
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
    ("gravity = [0, -9.81]", "gravity = [0, 0, -9.81]", "expected an array of 2 numbers (m/s2); did you mean dimensions = 3 at the top?"),
    ("[time]", '[[fill]]\nphase = "water"\nshape = { box = { min = [0, 0.2], max = [1, 0.5] } }\n[time]', 'or leave-out = "earlier-fills"'),
    ("density = 1000", "density = 1000 kg/m3", "expected a number in units of SI, its unit in a comment"),
    ("viscosity = 1e-6", "viscosity = -1", "expected a number >= 0 (m2/s)"),
    ("[[fill]]\nphase = \"ground\"", "[fill]\nphase = \"ground\"", "expected [[fill]] in place of [fill]"),
    ("[time]\nend = 0.01\n", "", "time: missing; expected a section"),
    ("water-ground = 2.1\n", "", "ground: nothing interacts with this wall"),
    ("water-ground = 2.1", "water-gruond = 2.1", 'did you mean "ground"?'),
    ("[domain]", "gravity = [0, -9.81]\n[domain]", 'did you mean "domain.gravity"?'),
    ("[domain]", "[constants]\nd = 1\n[domain]", "nothing uses it"),
    # the words of other programs and of textbooks
    ("viscosity = 1e-6", "nu = 1e-3", 'did you mean "viscosity" (kinematic, in m2/s)?'),
    ("viscosity = 1e-6", "mu = 1e-3", "in m2/s: the dynamic one over the density)?"),
    ("density = 1000", "rho = 1000", 'did you mean "density"?'),
    ("viscosity = 1e-6", "surface-tension = 0.07", "unknown key: Barchan has no surface tension"),
    ("viscosity = 1e-6", "temperature = 293", "unknown key: Barchan computes no heat"),
    ("viscosity = 1e-6", 'turbulence = "k-epsilon"', 'did you mean "k-omega"?'),
    ("viscosity = 1e-6", "colour = 3", "expected one of kind, spacing, density, viscosity"),
    ('kind = "fluid"', 'kind = "gas"', 'did you mean "fluid"?'),
    ('kind = "wall"', 'kind = "boundary"', 'did you mean "wall"?'),
    ('["bottom"]', '["floor"]', 'did you mean "bottom"?'),
    ('["bottom"]', '["ymin"]', 'did you mean "bottom"?'),
    ("box = { min", "rectangle = { min", 'did you mean "box"?'),
    ("box = { min = [0, 0], max = [1, 0.5] }", "circle = { centre = [0, 0], radius = 1 }", 'did you mean "disc"?'),
    ("end = 0.01", "end = 0.01\ndt = 1e-4", 'did you mean "step" (a fixed one; without it the program chooses)?'),
    ("[time]", '[output]\nfields = ["vorticity"]\n[time]', "the filter Gradient makes it of the velocity"),
    ("[time]", "[output]\nfolder = 1\n[time]", "the folder is an option: barchan run SCENE --out DIR"),
    ("[time]", ".[time]", "expected the line without the full stop at its beginning"),
    ("[time]", "// the time\n[time]", "a comment begins with #"),
    ('[[fill]]\nphase = "water"', '[fill]\nphase = "water"', "expected [[fill]] in place of [fill]"),
    ("[time]", '[[motion]]\nphase = "ground"\nrotation = 1\n[time]', 'did you mean "angular-velocity" (in rad/s)?'),
    ("max = [1, 0.5] } }", 'max = [1, 0.5] } }\nvelocity = ["x**2", 0]', "a power is x^2"),
    ("max = [1, 0.5] } }", 'max = [1, 0.5] } }\nvelocity = ["np.sin(x)", 0]', "a function has no prefix, as in sin(x)"),
    ("viscosity = 1e-6", "viscosity = 1e-6\ncoefsound = 20", 'did you mean "sound-speed" (in m/s)?'),
    ("viscosity = 1e-6", "viscosity = 1e-6\nalpha = 0.1", 'did you mean "artificial-viscosity"?'),
    ('kind = "wall"', 'kind = "wall"\ntype = "noSlip"', "unknown key; expected one of"),
    # slips of TOML
    ("viscosity = 1e-6", "viscosity = 1e-6\nenclosed = False", "False is no value; expected false"),
    ('kind = "fluid"', "kind = \u201cfluid\u201d", "expected straight quotes"),
    ("-9.81", "\u22129.81", "expected the sign - of the keyboard"),
    ("end = 0.01", "end = 0,01", "expected 0.01"),
    ("end = 0.01", "end = .01", "expected 0.01"),
    ("viscosity = 1e-6", "viscosity = 1.e-6", "expected 1.0e-6"),
    ("viscosity = 1e-6", "viscosity = 1d-6", "expected 1e-6"),
    ("end = 0.01", "end = 0.01;", "expected no semicolon"),
    ("[0, -9.81]", "[0 -9.81]", "expected an array with commas, as in [0, -9.81]"),
    ("spacing = 0.1", "spacing = 0.1\ntitle = My dam", 'expected "My dam"'),
    ("[time]", "[domain]\n[time]", "it stands twice"),
    ("spacing = 0.1", 'spacing = 0.1\ntitle = "C:\\Users"', "begins a code: expected / in its place"),
    ("density = 1000", "density = 1000 kg/m3  # water; at \u201c20\u201d", "expected a number in units of SI, its unit in a comment"),
    ("spacing = 0.1", 'spacing = 0.1\ntitle = "My dam', 'expected a closing " in this line'),
    ("end = 0.01", "end = " + " ".join(["1"] * 200000), "not TOML"),   # a long line is answered, too
    # sections and keys in another place
    ("[phases.water]", "[water]", "expected [phases.water], since a phase has a kind"),
    ("[interactions]", "[phases.interactions]", "phases.interactions: a section of the scene, and no phase; expected [interactions] in its place"),
    ("end = 0.01", "end = 0.01\nstart = 0.005", "a run starts at 0"),
    ("[time]", '[[inflow]]\nphase = "water"\nside = "left"\nflux = 1\n[time]', "grains enter by an [[influx]]"),
    ("[time]", '[output]\nfields = ["size"]\n[time]', 'did you mean "radius"?'),
    ("sides = [\"bottom\"]", 'surface = "tank.stl", position = [0, 0]', 'did you mean "move" (of a surface, in metres after scale and turn)?'),
    # places
    ("max = [1, 0.5]", "max = [4, 4]", 'the shape of phase "water" goes from 0 to 4 m along x and lies outside the domain, 0 to 1 m'),
    ("shape = { box = { min = [0, 0], max = [1, 0.5] } }", "shape = { disc = { centre = [0.5, 0.5], radius = 500 } }", "lies outside the domain, 0 to 1 m"),
    ("min = [0, 0], max = [1, 0.5]", "min = [1, 0.5], max = [0, 0]", "min and max are swapped along x"),
]

# What is read and done as it stands, with a warning of what it may mean: what was
# written in the place of what, and the warning; the scene as it is has none of them.
WARNED = [
    ("viscosity = 1e-6", "viscosity = 1e-3", "1000 times that of water; it is the kinematic viscosity"),
    ("density = 1000", "density = 1", "1 kg/m3 is light for a liquid"),
    ("size = [1, 1]", "size = [1000, 1]", "the domain is 1000 m long; lengths are in m"),
    ('["bottom"]', '["bottom"], layers = 1', "and the kernel of \"water\" reaches 0.16 m into the wall"),
    ("gravity = [0, -9.81]\n[phases.water]", "[phases.water]\nsound-speed = 20", 'domain.gravity: none, and "water" over the bottom has no weight'),
    ("gravity = [0, -9.81]", "gravity = [0, -981]", "is 100 times that of the earth"),
    ("viscosity = 1e-6", "viscosity = 1e-6\nsound-speed = 1480", "times what the scene can reach"),
    ('sides = ["bottom"] }', 'sides = ["bottom", "left"] }', 'domain: no wall at "right"'),
    ('sides = ["bottom"]', 'box = { min = [0.8, -0.2], max = [1, 0] }', 'domain: no wall at "left", "right", "bottom"'),
    ('sides = ["bottom"]', 'box = { min = [30, 0], max = [31, 1] }', "phases.ground: all of it stands outside the domain, by 29"),
    ("end = 0.01", "end = 0.01\nstep = 0.1", "time.step: 0.1 s is"),
    ("max = [1, 0.5] } }", "max = [1, 0.5] } }\npressure = 101325", "has a free surface, which is at 0 Pa: it bursts"),
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

    def test_warnings(self):
        for before, after, expected in WARNED:
            with self.subTest(written=after):
                for text, warned in ((SCENE.replace(before, after, 1), True), (SCENE, False)):
                    (self.folder / "w.toml").write_text(text)
                    done = subprocess.run([PROGRAM, "plan", "w.toml"], cwd=self.folder, capture_output=True, text=True, timeout=120)
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertEqual(expected in done.stdout + done.stderr, warned, done.stdout)

    def test_a_run_that_breaks_down_repeats_what_was_warned_of(self):
        (self.folder / "open.toml").write_text(SCENE.replace('sides = ["bottom"] }', 'sides = ["bottom", "left"] }').replace("end = 0.01", "end = 1"))
        code, said = said_of(self.folder, ["run", "open.toml", "--quiet", "--threads", "1"])
        self.assertEqual(code, 3, said)
        self.assertIn('the start warned of what may be the cause: domain: no wall at "right"', said.splitlines()[-1])

    def test_the_scene_itself_is_right(self):
        self.assertEqual(said_of(self.folder, ["plan", "s.toml"])[0], 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
