#!/usr/bin/python3
"""A run that is killed at any moment and continued writes the same files as one that was left alone; what cannot be continued is refused.

    test_restart.py PROGRAM SOURCE_DIR
"""

import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv[1]
SOURCE = pathlib.Path(sys.argv[2])
SCENE = SOURCE / "scenes/verification/poiseuille.toml"  # has probes, profiles and wall shear
SHORT = ["--set", "time.end=0.06", "--set", "output.every=0.004", "--set", "output.history-every=0.002"]


def command(out, *options, scene=SCENE):
    return [PROGRAM, "run", str(scene), "--quiet", "--out", str(out), *options]


def files(folder):
    """Of a run, but those that hold times of the clock."""
    return {f.name: f.read_bytes() for f in folder.iterdir() if f.name != "run.json" and ".checkpoint" not in f.name}


class Restart(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.top = pathlib.Path(self.scratch.name)

    def run_to_end(self, out, *options):
        return subprocess.run(command(out, *options), capture_output=True, text=True)

    def stopped(self, out, how, seconds):
        """A run with a checkpoint after every step, ended by a signal; its exit status."""
        run = subprocess.Popen(command(out, *SHORT, "--threads", "1", "--set", "output.checkpoint-every=1e-9"), stderr=subprocess.DEVNULL)
        time.sleep(seconds)
        run.send_signal(how)
        return run.wait()

    def test_killed_runs_go_on_with_the_same_bits(self):
        whole = self.top / "whole"
        self.assertEqual(self.run_to_end(whole, *SHORT, "--threads", "2").returncode, 0)
        killed = 0
        for how in (signal.SIGKILL, signal.SIGTERM):
            for seconds in (.15, .3, .5):
                part = self.top / f"{how.name}{seconds}"
                killed += self.stopped(part, how, seconds) != 0
                if not (part / "poiseuille.checkpoint").exists():
                    continue  # stopped before the first step
                again = self.run_to_end(part, *SHORT, "--threads", "2", "--restart", "latest")
                if "has ended, at t = " in again.stderr:
                    continue
                self.assertEqual(again.returncode, 0, again.stderr)
                self.assertIn("going on at", again.stderr)
                self.assertEqual(sorted(files(part)), sorted(files(whole)))
                for name, content in files(whole).items():
                    self.assertEqual(files(part)[name], content, f"{name} after {how.name} at {seconds} s")
        self.assertGreater(killed, 0, "no run was stopped in time: the test shows nothing")

    def test_a_run_that_has_ended_goes_on_to_a_later_end(self):
        out = self.top / "out"
        self.assertEqual(self.run_to_end(out, *SHORT).returncode, 0)
        before = files(out)
        done = self.run_to_end(out, *SHORT, "--restart", "latest")
        self.assertEqual(done.returncode, 0)
        self.assertIn("a later time.end continues it", done.stderr)
        self.assertEqual(files(out), before)
        named = self.run_to_end(out, *SHORT, "--restart", str(out / "poiseuille.checkpoint"))
        self.assertEqual(named.returncode, 2)
        self.assertIn("larger time.end", named.stderr)
        later = self.run_to_end(out, *SHORT, "--set", "time.end=0.08", "--restart", "latest")
        self.assertEqual(later.returncode, 0, later.stderr)
        frames = [n for n in before if n.endswith(".vtp") and n.startswith("poiseuille_0")]
        self.assertGreater(len(frames), 5)
        for name in frames:
            self.assertEqual(files(out)[name], before[name])
        self.assertGreater(len(files(out)), len(before))

    def test_a_settled_bed_is_taken_from_the_checkpoint(self):
        bed = ["--set", "fill.1.shape.box.max=[0.015, 0.016]", "--set", "output.every=0.001", "--threads", "1"]

        def go(out, end, *options):
            made = subprocess.run([PROGRAM, "run", str(SOURCE / "scenes/column_collapse.toml"), "--out", str(out), "--set", f"time.end={end}", *bed, *options],
                                  capture_output=True, text=True)
            self.assertEqual(made.returncode, 0, made.stderr)
            return made.stdout

        whole, part = self.top / "whole", self.top / "part"
        self.assertIn("settling", go(whole, .004))
        go(part, .002)
        self.assertNotIn("settling", go(part, .004, "--restart", "latest"))
        self.assertEqual(sorted(files(part)), sorted(files(whole)))
        for name, content in files(whole).items():
            if name.endswith(".vtp"):
                self.assertEqual(files(part)[name], content, name)

    def test_the_folder_of_another_scene_is_refused(self):
        """Its history.csv and run.json would be replaced: nothing in it changes."""
        out = self.top / "out"
        self.assertEqual(self.run_to_end(out, *SHORT).returncode, 0)
        before = {f.name: f.read_bytes() for f in out.iterdir()}
        for more in ([], ["--restart", "latest"]):
            other = subprocess.run(command(out, "--set", "time.end=0.01", *more, scene=SOURCE / "scenes/verification/hop.toml"), capture_output=True, text=True)
            self.assertEqual(other.returncode, 2)
            self.assertIn("the folder holds the run of another scene, poiseuille.pvd", other.stderr)
            self.assertEqual({f.name: f.read_bytes() for f in out.iterdir()}, before)

    def test_other_scenes_and_damaged_files_are_refused(self):
        out = self.top / "out"
        self.assertEqual(self.run_to_end(out, *SHORT).returncode, 0)
        before = files(out)
        other = self.run_to_end(out, *SHORT, "--set", "time.end=0.08", "--set", "phases.water.viscosity=0.5", "--restart", "latest")
        self.assertEqual(other.returncode, 2, other.stderr)
        self.assertIn("viscosity", other.stderr)
        checkpoint = out / "poiseuille.checkpoint"
        content = bytearray(checkpoint.read_bytes())
        content[len(content) // 2] ^= 4
        checkpoint.write_bytes(content)
        damaged = self.run_to_end(out, *SHORT, "--set", "time.end=0.08", "--restart", "latest")
        self.assertEqual(damaged.returncode, 2)
        self.assertIn("checksum", damaged.stderr)
        missing = self.run_to_end(out, *SHORT, "--restart", str(self.top / "nothing"))
        self.assertEqual(missing.returncode, 2)
        self.assertEqual(files(out), before, "a refusal changes nothing")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
