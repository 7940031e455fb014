#!/usr/bin/python3
"""Ranks that go back to an earlier state after a step that failed go on with the bits of one process, and say the same words.

    test_ranks_retreat.py PROGRAM SOURCE_DIR
"""

import json
import sys
import unittest

from test_ranks import PERIODIC, SOURCE, Folder, has_mpi

# Steps that are too long fail; after some of them cells are divided anew. File, end (s), overrides.
WILD = {
    "a free surface": ("verification/dam_break", 0.01, "time.safety=1.6"),
    "cells divided anew in between": ("verification/dam_break", 0.05, "spacing=5.715e-3", "time.safety=1.35"),
}
# Grains whose weight presses them into a plate. Some ranks have no particle of it.
PRESSED = """
dimensions = 2
spacing = 1e-3
[domain]
size = [0.04, 0.03]
gravity = [0, -5000]
[phases.sand]
kind = "grains"
density = 2650
restitution = 0.1
contact-speed = 1
[phases.plate]
kind = "wall"
[interactions]
sand-sand = 1.1
sand-plate = 1.1
[[fill]]
phase = "plate"
shape = { box = { min = [0.005, 0.005], max = [0.035, 0.008] } }
[[fill]]
phase = "sand"
shape = { box = { min = [0.01, 0.0086], max = [0.03, 0.028] } }
[time]
step = 5e-6
end = 0.02
largest-speed = 1
[output]
every = 0.001
"""


@unittest.skipUnless(has_mpi(), "no MPI here")
class Retreat(Folder):
    def retreats(self, out):
        return json.loads((self.at / out / "run.json").read_text())["retreats"]

    def test_ranks_that_go_back_have_the_bits_of_one_process(self):
        for name, (file, end, *overrides) in WILD.items():
            with self.subTest(name):
                out = name.replace(" ", "_")
                sets = [word for s in (f"time.end={end!r}", f"output.every={end / 2!r}", *overrides) for word in ("--set", s)]
                for ranks in (0, 2, 3):
                    ended = self.start_file(ranks, SOURCE / "scenes" / (file + ".toml"), f"{out}-{ranks}", *sets)
                    self.assertEqual(ended.returncode, 0, ended.stderr)
                    self.assertGreater(self.retreats(f"{out}-{ranks}")["count"], 0)
                    self.assertEqual(self.retreats(f"{out}-{ranks}"), self.retreats(f"{out}-0"))
                    self.same(f"{out}-0", f"{out}-{ranks}")

    def test_beside_periodic_sides(self):
        text = PERIODIC.format(scheme="plain", precision="").replace("[time]", "[time]\nsafety = 3")
        self.run_on(0, text, "one")
        for ranks in (2, 3):
            self.run_on(ranks, text, f"of-{ranks}")
            self.assertGreater(self.retreats(f"of-{ranks}")["count"], 0)
            self.assertEqual(self.retreats(f"of-{ranks}"), self.retreats("one"))
            self.same("one", f"of-{ranks}")

    def test_a_grain_deep_in_a_wall_is_told_in_the_same_words(self):
        one = self.start(0, PRESSED, "one")
        self.assertEqual(one.returncode, 3, one.stderr)
        told = next(line for line in one.stderr.splitlines() if "is deep in the wall" in line)
        for ranks in (2, 3, 5):
            many = self.start(ranks, PRESSED, f"of-{ranks}")
            self.assertEqual(many.returncode, 3, many.stderr)
            self.assertIn(told, many.stderr)

    def test_contacts_are_looked_at_in_the_state_gone_back_to(self):
        """With a checkpoint on the disk the run looks before it writes the next one: not at the places of the failed step."""
        text = PRESSED.replace("step = 5e-6", "safety = 0.02").replace("every = 0.001", "every = 0.001\ncheckpoint-every = 0.01")
        for ranks in (0, 3):
            ended = self.start(ranks, text, f"of-{ranks}")
            self.assertEqual(ended.returncode, 3, ended.stderr)
            self.assertEqual(self.retreats(f"of-{ranks}"), self.retreats("of-0"))
            self.assertGreater(self.retreats(f"of-{ranks}")["count"], 1)
            self.assertTrue((self.at / f"of-{ranks}/scene_bad.vtp").exists())
        self.assertEqual((self.at / "of-0/scene_bad.vtp").read_bytes(), (self.at / "of-3/scene_bad.vtp").read_bytes())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
