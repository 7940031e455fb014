#!/usr/bin/python3
"""Ranks that make the particles of fluids in parts, beside what every rank makes whole: the bytes of one process.

    test_ranks_start.py PROGRAM SOURCE_DIR
"""

import subprocess
import sys
import time
import unittest

from test_ranks import MPIRUN, PERIODIC, PROGRAM, SOURCE, Folder, alone, has_mpi

WATER = PERIODIC.format(scheme="plain", precision="")

# A disc that turns, not about the origin, and a plate that is held; both float in a fluid that is made in parts.
DISC = """
dimensions = 2
spacing = 0.04
[domain]
size = [2, 1.6]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1
viscosity = 1e-3
sound-speed = 20
[phases.disc]
kind = "rigid"
density = 2
[phases.plate]
kind = "rigid"
density = 2
[interactions]
water-water = 3.0
water-disc = 3.0
water-plate = 3.0
disc-plate = false
[[fill]]
phase = "disc"
shape = { disc = { centre = [0.6, 0.9], radius = 0.3 } }
velocity = ["0.2 - (y - 0.9)", "x - 0.6"]
[[fill]]
phase = "plate"
shape = { box = { min = [1.2, 0.4], max = [1.8, 0.56] } }
[[fill]]
phase = "water"
shape = "the-rest"
[[motion]]
phase = "plate"
about = [1.3, 0.5]
[time]
end = 0.02
largest-speed = 1
[output]
every = 0.01
history-every = 0.005
"""


@unittest.skipUnless(has_mpi(), "no MPI here")
class Start(Folder):
    def test_rigid_bodies_away_from_the_origin(self):
        self.run_on(0, DISC, "one")
        for ranks in (2, 3):
            self.run_on(ranks, DISC, f"of-{ranks}")
            self.same("one", f"of-{ranks}")

    def test_a_bed_that_settles_before_and_after_the_fluid_is_made(self):
        text = (SOURCE / "scenes/threshold.toml").read_text()
        head, *fills = text.split("[[fill]]")
        last, tail = fills[-1].split("[[forcing]]")
        sand = next(fill for fill in fills if 'phase = "sand"' in fill)
        others = [fill for fill in fills[:-1] if fill != sand]
        sets = [word for s in ("time.end=0.0001", "output.every=0.00005", "output.history-every=0.00005", "domain.size=[0.016, 0.032]")
                for word in ("--set", s)]
        for order in ([*others, sand, last], [*others, last, sand]):
            changed = head + "".join("[[fill]]" + fill for fill in order) + "[[forcing]]" + tail
            self.run_on(0, changed, "one", *sets)
            self.run_on(3, changed, "of-3", *sets)
            self.same("one", "of-3")

    def start_differing(self, *words):
        """Two ranks of one run, each with words of its own before the program."""
        (self.at / "scene.toml").write_text(WATER)
        command = [PROGRAM, "run", str(self.at / "scene.toml"), "--quiet", "--threads", "1", "--out", "out"]
        return [*MPIRUN, "1", *words[0], *command, ":", "-n", "1", *words[1], *command]

    def test_ranks_of_different_instruction_sets_are_refused(self):
        if "AVX-512" not in subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout:
            self.skipTest("the machine has AVX2 only")
        command = self.start_differing([], ["env", "BARCHAN_INSTRUCTIONS=avx2"])
        ended = subprocess.run(command, cwd=self.at, env=alone(), capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 2, ended.stderr)
        self.assertEqual(ended.stderr.count("the ranks have different instruction sets, AVX-512 and AVX2"), 1, ended.stderr)
        self.assertFalse((self.at / "out").exists())

    def test_a_checkpoint_that_some_ranks_do_not_see(self):
        self.run_on(2, WATER, "out", "--set", "time.end=0.03")
        (self.at / "elsewhere").mkdir()
        command = self.start_differing([], ["env", "--chdir=elsewhere"])
        for rank in (command.index(":"), len(command) + 2):
            command[rank:rank] = ["--restart", "latest"]
        ended = subprocess.run(command, cwd=self.at, env=alone(), capture_output=True, text=True, timeout=60)
        self.assertEqual(ended.returncode, 2, ended.stderr)
        self.assertEqual(ended.stderr.count("rank 0 sees the checkpoint out/scene.checkpoint, rank 1 does not"), 1, ended.stderr)
        self.assertTrue((self.at / "out/scene.checkpoint").exists())

    def test_a_folder_where_another_run_computes(self):
        (self.at / "scene.toml").write_text(WATER)
        with subprocess.Popen([PROGRAM, "run", "scene.toml", "--quiet", "--set", "time.end=1000", "--out", "out"], cwd=self.at) as first:
            try:
                while not (self.at / "out/scene.pvd").exists():
                    self.assertIsNone(first.poll())
                    time.sleep(0.01)
                ended = self.start(2, WATER, "out")
            finally:
                first.terminate()
        self.assertEqual(ended.returncode, 2, ended.stderr)
        self.assertIn(f"process {first.pid} on host", ended.stderr)
        self.assertNotIn("each is a run", ended.stderr)  # they are ranks of one run


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
