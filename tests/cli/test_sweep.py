#!/usr/bin/python3
"""barchan sweep: all combinations, one that breaks down among them; killed, it goes on; the table and the page say what the runs' own files say.

    /usr/bin/python3 tests/cli/test_sweep.py PROGRAM ROOT
"""

import fcntl
import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/barchan").resolve()
ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2]).resolve()
sys.path.insert(0, str(ROOT / "python"))
os.environ["BARCHAN_PROGRAM"] = str(PROGRAM)
import barchan  # noqa: E402
from barchan import sweep  # noqa: E402
from barchan.sweep import command, results  # noqa: E402
from barchan.sweep.cases import folder_of, varied  # noqa: E402

HOP = ROOT / "scenes/verification/hop.toml"
SLIDE = """
spacing = 0.02
[domain]
size = [4.0, 0.2]
gravity = [0, -9.81]
[phases.grain]
kind = "grains"
density = 2000
diameter = 0.02
stiffness = 1e5
restitution = 0.5
[phases.floor]
kind = "wall"
[interactions]
grain-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "grain"
shape = { points = [[0.1, 0.01]] }
velocity = [1, 0]
[time]
end = 0.05
largest-speed = 2
[output]
every = 0.05
history-every = 0.01
"""


class Cases(unittest.TestCase):
    def test_values(self):
        for text, values in (("a=0:1:3", ["0", "0.5", "1"]), ("a=1:4:4", ["1", "2", "3", "4"]), ("a=0.1:0.3:3", ["0.1", "0.2", "0.3"]), ("a=1e-3:1e-1:3:log", ["0.001", "0.01", "0.1"]),
                             ("a=mixed,double", ["mixed", "double"]), ('a.0.b=[1,0],[2,0]', ["[1,0]", "[2,0]"]), ('a="x,y",z', ['"x,y"', "z"]), ("a=5", ["5"]), ("a=-2:2:5", ["-2", "-1", "0", "1", "2"]),
                             ('a={ b = 1, c = 2 },none', ["{ b = 1, c = 2 }", "none"]), ("a=1:1:1", ["1"])):
            self.assertEqual(varied(text)[1], values, text)

    def test_what_is_wrong_is_said(self):
        for text, words in (("a", "expected KEY=FROM:TO:NUMBER"), ("=1,2", "expected KEY"), ("a=", "expected KEY"), ("a=1,,2", "a value is empty"), ("a=1,2,1", "stands twice"), ("a=0:1:x", "two numbers and a whole one"),
                            ("a=0:1:1", "2 values or more"), ("a=0:1:-3", "2 values or more"), ("a=0:1:3:lin", 'only "log"'), ("a=0:1:3:log", "not zero"), ("a=nan:1:2", "two numbers")):
            with self.assertRaisesRegex(barchan.SceneError, words):
                varied(text)
        with self.assertRaisesRegex(barchan.SceneError, "the key stands twice"):
            sweep.combinations(["a=1,2", "a=3,4"])
        with self.assertRaisesRegex(barchan.SceneError, "expected COLUMN.*did you mean"):
            results.measure("a:meen")

    def test_combinations(self):
        cases = sweep.combinations(["a.b=1,2", "c=x,y,z"], ["d=4"])
        self.assertEqual([tuple(case.values.values()) for case in cases], [("1", "x"), ("1", "y"), ("1", "z"), ("2", "x"), ("2", "y"), ("2", "z")])
        self.assertEqual(cases[0].settings, ("d=4", "a.b=1", "c=x"))
        self.assertEqual(len({case.folder for case in cases}), 6)
        self.assertEqual(cases[3].folder, sweep.combinations(["a.b=2,7", "c=x"])[0].folder)  # other values beside it change no name
        self.assertEqual(len({case.folder for case in sweep.combinations(["a=x/y,x?y,x_y"])}), 3)
        self.assertLess(len(folder_of({f"key{k}": "1" * 30 for k in range(20)})), 130)
        self.assertNotIn("/", folder_of({"a": "../../b"}))


class Sweeps(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.scene = self.folder / "slide.toml"
        self.scene.write_text(SLIDE)

    def sweep(self, *words, scene=None):
        return subprocess.run([PROGRAM, "sweep", scene or self.scene, "--out", self.folder / "out", "-j", "2", *words], capture_output=True, text=True, cwd=self.folder)

    def test_one_of_five_breaks_down_and_the_others_go_on(self):
        ended = self.sweep("--vary", "time.end=0.02:0.2:5", "--set", "output.history-every=0.01", "--measure", "sand_mean_vx:max", "--measure", "sand_kinetic_energy", "--measure", "dt:mean", scene=HOP)
        self.assertEqual(ended.returncode, 1, ended.stderr)
        table = sweep.read(self.folder / "out")
        self.assertEqual([line["time.end"] for line in table], [.02, .065, .11, .155, .2])
        self.assertEqual([line["status"] for line in table], [0, 0, 0, 3, 3])
        self.assertIn("escaped through the lower side", table[4]["end_reason"])
        for line in table:
            series = barchan.open(self.folder / "out" / line["run"])
            speed = series.history["sand_mean_vx"]
            self.assertEqual((line["sand_mean_vx:max"], line["sand_kinetic_energy:last"], line["steps"]), (speed.max(), series.history["sand_kinetic_energy"][-1], series.run["steps"]))
            self.assertAlmostEqual(line["dt:mean"], series.history["dt"].mean(), delta=1e-18)
        page = (self.folder / "out/sweep.html").read_text()
        for words in ("3 of 5 runs ended well, 2 did not.", "escaped through the lower side", "sand_mean_vx, max", "did not end well", "--vary"):
            self.assertIn(words, page)
        self.assertEqual(page.count("<svg"), 3)
        self.assertNotRegex(page.replace("http://www.w3.org", ""), r"(src|href)=\"(?!data:|#)|https?://|<script")
        self.assertEqual(ended.stdout.count("status 0"), 3)

    def test_what_is_done_is_not_run_again(self):
        words = ["--vary", "phases.grain.friction=0,0.5", "--vary", "fill.1.velocity=[1,0],[2,0]"]
        self.assertEqual(self.sweep(*words).returncode, 0)
        stamps = {file: file.stat().st_mtime_ns for file in (self.folder / "out").glob("*/history.csv")}
        self.assertEqual(len(stamps), 4)
        first = (self.folder / "out/sweep.csv").read_bytes()
        again = self.sweep(*words)
        self.assertEqual((again.returncode, again.stdout.count("done before")), (0, 4))
        self.assertEqual({file: file.stat().st_mtime_ns for file in stamps}, stamps)
        self.assertEqual((self.folder / "out/sweep.csv").read_bytes(), first)
        more = self.sweep("--vary", "phases.grain.friction=0,0.2,0.5", "--vary", "fill.1.velocity=[1,0],[2,0]")  # a larger sweep runs what is new
        self.assertEqual((more.returncode, more.stdout.count("done before"), len(sweep.read(self.folder / "out"))), (0, 4, 6))
        self.scene.write_text(SLIDE.replace("restitution = 0.5", "restitution = 0.4"))  # another scene is another sweep
        self.assertEqual(self.sweep(*words).stdout.count("done before"), 0)

    def killed(self, number, wait):
        """A sweep that is sent a signal in its middle; the exit status, and how many runs are done."""
        words = [PROGRAM, "sweep", self.scene, "--out", self.folder / "out", "-j", "2", "--vary", "phases.grain.friction=0.1:0.4:4", "--set", "time.end=0.6", "--set", "time.step=2e-6",
                 "--set", "output.history-every=0.05"]
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        begin = time.monotonic()
        while not wait() and time.monotonic() - begin < 60:
            time.sleep(.02)
        process.send_signal(number)
        return process.wait(), len(list((self.folder / "out").glob("*/case.json"))), words

    @unittest.skipIf(os.environ.get("BARCHAN_SANITIZE"), "a sanitizer takes too long for the million steps of this test and finds nothing in them that other tests do not run")
    def test_killed_it_goes_on(self):
        out = self.folder / "out"
        two_run = lambda: sum(file.read_text().count("\n") > 3 for file in out.glob("*/history.csv")) >= 2
        a_moment_later = lambda: any(map(self.locked, out.iterdir())) and time.sleep(.3) is None
        for number, expected, wait in ((signal.SIGTERM, 143, two_run), (signal.SIGKILL, -9, a_moment_later)):
            status, done, words = self.killed(number, wait)
            self.assertEqual(status, expected)
            self.assertLess(done, 4)
            begin = time.monotonic()
            while any(map(self.locked, out.iterdir())) and time.monotonic() - begin < 60:
                time.sleep(.05)  # runs end with the sweep: they finish their step and write a checkpoint
            stopped = [file.parent for file in out.glob("*/run.json") if json.loads(file.read_text())["end_reason"] == "SIGTERM"]
            self.assertGreaterEqual(len(stopped), 1)
            for folder in stopped:
                self.assertTrue(list(folder.glob("*.checkpoint")))
        first = {folder / "slide_000000.vtp": (folder / "slide_000000.vtp").stat().st_mtime_ns for folder in stopped}
        ended = subprocess.run(words, capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertEqual([line["simulated_time"] for line in sweep.read(out)], [0.6] * 4)
        self.assertEqual({file: file.stat().st_mtime_ns for file in first}, first)  # they went on, and did not begin again
        straight = barchan.run(self.scene, out=self.folder / "straight", threads=1, set={"phases.grain.friction": .1, "time.end": 0.6, "time.step": 2e-6, "output.history-every": .05})
        self.assertEqual((out / "phases.grain.friction=0.1/history.csv").read_bytes(), (straight.folder / "history.csv").read_bytes())  # with the same bits

    @staticmethod
    def locked(folder):
        """Whether a run goes on in this folder."""
        try:
            with (folder / "barchan.lock").open() as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (FileNotFoundError, NotADirectoryError):
            return False
        except OSError:
            return True
        return False

    def test_wrong_commands(self):
        for words, status, said in (([], 2, "nothing to vary"), (["--vary", "a=1:2:x"], 2, "expected FROM:TO:NUMBER"),
                                    (["--vary", "time.ende=1,2"], 2, "time.ende"), (["--vary", "time.end=0.01,0.02", "--measure", "grain_mean_vw"], 2, "did you mean"),
                                    (["--vary", "time.end=0.01", "-j", "0"], 2, "1 or more")):
            ended = self.sweep(*words)
            self.assertEqual(ended.returncode, status, words)
            self.assertIn(said, ended.stderr + ended.stdout)
        self.assertEqual(self.sweep("--vary", "a=1", scene="none.toml").returncode, 2)
        (self.folder / "out2").write_text("")
        ended = subprocess.run([PROGRAM, "sweep", self.scene, "--out", self.folder / "out2", "--vary", "time.end=0.01"], capture_output=True, text=True)
        self.assertEqual(ended.returncode, 4)

    def test_names_of_scenes(self):
        for word in ("hop", "verification/hop", str(HOP)):
            self.assertEqual(pathlib.Path(command.scene_file(word)), HOP)
        self.assertEqual(pathlib.Path(command.scene_file("dune")), ROOT / "scenes/dune.toml")  # scenes/paper has a dune too
        for word, said in (("hopp", 'did you mean "hop"'), ("hop.toml", "no such scene file")):
            with self.assertRaisesRegex(barchan.SceneError, said):
                command.scene_file(word)

    def test_measures(self):
        out = self.folder / "out"
        self.assertEqual(self.sweep("--vary", "time.end=0.05", "--measure", "grain_mean_vx:first", "--measure", "grain_mean_vx:mean", "--from", "0.03").returncode, 0)
        line, history = sweep.read(out)[0], barchan.open(out / "time.end=0.05").history
        late = history["time"] >= .03
        self.assertEqual(line["grain_mean_vx:first"], history["grain_mean_vx"][late][0])
        self.assertAlmostEqual(line["grain_mean_vx:mean"], history["grain_mean_vx"][late].mean(), delta=1e-15)
        self.assertTrue(math.isfinite(line["wall_seconds"]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
