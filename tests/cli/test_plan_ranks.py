#!/usr/bin/python3
"""What `plan --ranks N` says of a run on N ranks is what that run does: particles and ghosts; what ranks refuse it refuses.

    test_plan_ranks.py PROGRAM SOURCE_DIR
"""

import json
import subprocess
import sys
import unittest

import test_ranks
from test_ranks import PERIODIC, PROGRAM, SOURCE, channel

# scene, end (s) of the run, overrides
CASES = {
    "a periodic fluid": (PERIODIC.format(scheme="consistent", precision=""), 0.06),
    "a channel in three dimensions": (channel("consistent", solid=True), 0.05),
    "a free surface": (SOURCE / "scenes/verification/dam_break.toml", 0.03, "spacing=5.715e-3"),
    "water over spheres": (SOURCE / "scenes/water_over_sand.toml", 0.0006),
}


class PlanOfRanks(test_ranks.Folder):
    def plan(self, scene, *options):
        if isinstance(scene, str):
            (self.at / "scene.toml").write_text(scene)
            scene = "scene.toml"
        return subprocess.run([PROGRAM, "plan", str(scene), *options], cwd=self.at, capture_output=True, text=True, timeout=300)

    def planned(self, scene, ranks, *options):
        ended = self.plan(scene, "--ranks", str(ranks), "--json", *options)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return json.loads(ended.stdout)["ranks"]

    def report(self, scene, ranks, out, sets):
        start = self.start if isinstance(scene, str) else self.start_file
        ended = start(ranks, scene, out, *sets, "--division", "particles")  # that of a plan: it knows no time of ranks
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return json.loads((self.at / out / "run.json").read_text())

    @unittest.skipUnless(test_ranks.has_mpi(), "no MPI here")
    def test_against_runs(self):
        for name, (scene, end, *overrides) in CASES.items():
            sets = [word for key in (f"time.end={end!r}", f"output.every={end!r}", f"output.history-every={end!r}", *overrides) for word in ("--set", key)]
            for ranks in (2, 3, 4):
                with self.subTest(name, ranks=ranks):
                    plan, run = self.planned(scene, ranks, *sets), self.report(scene, ranks, f"{name}-{ranks}", sets)["ranks"]
                    ghosts = sum(rank["ghosts"] for rank in plan["of"]) / run["ghosts"]
                    most = max(rank["particles"] for rank in plan["of"]) / run["most_particles"]
                    print(f"{name}, {ranks} ranks: planned/run ghosts {ghosts:.3f}, particles of the largest {most:.3f}", flush=True)
                    self.assertLess(abs(ghosts - 1), 0.1)
                    self.assertLess(abs(most - 1), 0.1)

    def test_what_it_says(self):
        scene = PERIODIC.format(scheme="plain", precision="")
        few, many = self.plan(scene, "--ranks", "3").stdout, self.plan(scene, "--ranks", "9").stdout
        for text in ("particles", "ghosts", "share", "memory"):
            self.assertIn(text, few)
        rows = [line.split()[0] for line in few.splitlines() if line[:1].isdigit() and len(line.split()) > 4]
        self.assertEqual(rows[-3:], ["0", "1", "2"])
        self.assertIn("\nlargest ", many)
        plan = self.planned(scene, 9)
        self.assertEqual(sum(rank["particles"] for rank in plan["of"]), 2500)
        self.assertEqual(plan["largest"]["particles"], max(rank["particles"] for rank in plan["of"]))

    def test_bodies_are_whole_on_every_rank(self):
        plan = self.planned(SOURCE / "scenes/bouncing_block.toml", 3)
        self.assertGreater(plan["whole_particles"], 0)
        self.assertTrue(all(rank["particles"] >= plan["whole_particles"] for rank in plan["of"]))

    def test_a_wrong_number(self):
        for wrong in ("0", "-3", "two", "5000"):
            ended = self.plan(PERIODIC.format(scheme="plain", precision=""), "--ranks", wrong)
            self.assertEqual(ended.returncode, 2, wrong)
            self.assertIn("--ranks", ended.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
