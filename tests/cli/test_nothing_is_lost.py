#!/usr/bin/python3
"""What a run leaves when it is killed or the disk is full: checkpoints and series that --restart latest goes on from.

    test_nothing_is_lost.py PROGRAM SOURCE_DIR
"""

import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv[1]
SOURCE = pathlib.Path(sys.argv[2])
SCENE = SOURCE / "scenes/verification/poiseuille.toml"  # has probes, profiles and wall shear
SHORT = ["--set", "time.end=0.02", "--set", "output.every=0.004"]
LATER = ["--set", "time.end=1000", "--set", "output.every=0.004", "--set", "output.checkpoint-every=0"]


class NothingIsLost(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.top = pathlib.Path(self.scratch.name)
        self.out = self.top / "out"
        self.newest, self.older = self.out / "poiseuille.checkpoint", self.out / "poiseuille.checkpoint.older"

    def command(self, *options, scene=SCENE):
        return [PROGRAM, "run", str(scene), "--out", str(self.out), "--threads", "1", "--quiet", *options]

    def run_now(self, *options, before=(), **more):
        return subprocess.run([*before, *self.command(*options, **more)], capture_output=True, text=True)

    def listed(self):
        series = self.out / "poiseuille.pvd"
        return re.findall(r'file="([^"]*)"', series.read_text()) if series.exists() else []

    def killed_after_frames(self, *options):
        """Starts a run and kills it when it has written two frames more."""
        with subprocess.Popen(self.command(*options), stderr=subprocess.DEVNULL) as run:
            begin = None
            for _ in range(2000):
                self.assertIsNone(run.poll())
                if "running" in (self.out / "run.json").read_text():
                    begin = begin if begin is not None else len(self.listed())
                    if len(self.listed()) >= begin + 2:
                        break
                time.sleep(0.01)
            else:
                self.fail("waited for twenty seconds")
            run.send_signal(signal.SIGKILL)

    def goes_on(self):
        again = self.run_now("--restart", "latest", "--set", "time.end=0.03", "--set", "output.every=0.004")
        self.assertEqual(again.returncode, 0, again.stderr)
        for name in self.listed():
            self.assertTrue((self.out / name).exists(), name)
        return again

    def test_a_whole_checkpoint_takes_the_place_of_a_damaged_one(self):
        """Otherwise the next checkpoint would put the damaged one in the place of the whole one before it is there itself."""
        self.assertEqual(self.run_now(*SHORT, "--set", "output.checkpoint-every=1e-9").returncode, 0)
        whole = self.older.read_bytes()
        self.newest.write_bytes(self.newest.read_bytes()[:-5])
        self.killed_after_frames("--restart", "latest", *LATER)
        self.assertEqual(self.newest.read_bytes(), whole)
        self.assertNotIn("damaged", self.goes_on().stderr)

    def test_a_run_that_goes_on_from_an_earlier_state_may_be_killed(self):
        """Its series is cut back to that state, so the newest checkpoint must not count more frames."""
        self.assertEqual(self.run_now(*SHORT, "--set", "output.checkpoint-every=0").returncode, 0)
        early = self.top / "early.checkpoint"
        shutil.copy(self.newest, early)
        self.assertEqual(self.run_now("--restart", "latest", "--set", "time.end=0.2", "--set", "output.every=0.004").returncode, 0)
        self.assertGreater(len(self.listed()), 20)
        self.killed_after_frames("--restart", str(early), *LATER)
        self.assertLess(len(self.listed()), 20)
        self.assertFalse(self.older.exists())  # it was one of later steps
        self.goes_on()

    def test_a_frame_whose_piece_could_not_be_written_is_not_listed(self):
        limit = ["prlimit", "--fsize=20000"]
        ended = self.run_now(*SHORT, "--set", "output.pieces-from=0", before=limit, scene=SOURCE / "scenes/verification/taylor_green.toml")
        self.assertEqual(ended.returncode, 4, ended.stderr)
        self.assertIn("taylor_green_000000_0000.vtp", ended.stderr)
        self.assertTrue((self.out / "run.json").exists())
        self.assertEqual([file.name for suffix in ("pvd", "pvtp") for file in self.out.glob(f"*.{suffix}")], [])

    def test_a_question_before_the_first_step_does_not_end_the_run(self):
        scene = SOURCE / "scenes/threshold.toml"  # its bed settles first
        with subprocess.Popen([PROGRAM, "run", str(scene), "--out", str(self.out), "--threads", "1"], stdout=subprocess.PIPE, text=True) as run:
            try:
                line = next(line for line in run.stdout if "settling" in line)
                self.assertIsNone(run.poll(), line)
                run.send_signal(signal.SIGUSR1)
                time.sleep(0.3)
                self.assertIsNone(run.poll())
                self.assertFalse((self.out / "run.json").exists())  # it had not begun
            finally:
                run.kill()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
