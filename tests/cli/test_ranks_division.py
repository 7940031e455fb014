#!/usr/bin/python3
"""Cells are divided among ranks by the time of their steps or by the number of particles: the bits are the same, and run.json says what ranks did.

    test_ranks_division.py PROGRAM SOURCE_DIR
"""

import json
import sys
import unittest

from test_ranks import CHANNEL, PROGRAM, SOURCE, Folder, has_mpi  # noqa: F401

SCENE = SOURCE / "scenes/verification/dam_break_3d.toml"  # most particles are of walls far from the water, which cost little
SETS = ["--set", "spacing=1.143e-2", "--set", "time.end=0.02", "--set", "output.every=0.02", "--set", "output.history-every=0.01"]

BETWEEN = CHANNEL.format(dimensions=2, spacing=5e-5, size=[1e-3, 1e-3], periodic='["x"]', scheme="plain", velocity=[1.25e-5, 0], acceleration=[1e-5, 0], end=0.1)


@unittest.skipUnless(has_mpi(), "no MPI here")
class Divisions(Folder):
    def of(self, ranks, out, *options):
        """run.json of the dam break."""
        ended = self.start_file(ranks, SCENE, out, *SETS, *options)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return json.loads((self.at / out / "run.json").read_text())

    def test_bits_do_not_depend_on_the_division(self):
        self.assertNotIn("ranks", self.of(0, "one", "--division", "time"))
        by_time, by_particles = self.of(3, "time")["ranks"], self.of(3, "particles", "--division", "particles")["ranks"]
        self.same("one", "time")
        self.same("one", "particles")
        for name, ranks in (("time", by_time), ("particles", by_particles)):
            self.assertEqual(ranks["division"], name)
            busy, waiting = ranks["busy_seconds"], ranks["waiting_seconds"]
            self.assertEqual((len(busy), len(waiting)), (3, 3))
            self.assertTrue(all(seconds > 0 for seconds in busy + waiting), ranks)
            self.assertAlmostEqual(ranks["imbalance"], max(busy) * 3 / sum(busy), 6)
        self.assertGreater(by_time["divisions"], 0)
        self.assertGreater(by_time["dividing_seconds"], 0)
        self.assertEqual((by_particles["divisions"], by_particles["dividing_seconds"]), (0, 0))
        self.assertNotEqual(by_time["most_particles"], by_particles["most_particles"], "another division")

    def test_seconds_of_ranks_that_share_a_core(self):
        """Four ranks on two cores: MPI gives the core away in its looks, and what others then compute is no processor time of waiting."""
        ended = self.start(4, BETWEEN, "shared")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        run = json.loads((self.at / "shared" / "run.json").read_text())
        for busy, waiting in zip(run["ranks"]["busy_seconds"], run["ranks"]["waiting_seconds"]):
            self.assertTrue(0 <= busy <= run["wall_seconds"], run["ranks"])
            self.assertTrue(0 <= waiting <= run["wall_seconds"], run["ranks"])

    def test_another_division_is_refused(self):
        ended = self.start_file(0, SCENE, "out", "--division", "blocks")
        self.assertEqual(ended.returncode, 2)
        for word in ('"blocks"', '"time"', '"particles"'):
            self.assertIn(word, ended.stderr)
        self.assertFalse((self.at / "out").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
