#!/usr/bin/python3
"""No rank holds arrays of all particles of a fluid, from the first one that is made to the last step, and at a restart: the peak memory of a rank falls
with their number.

    test_ranks_memory.py PROGRAM SOURCE_DIR

The first rank is not looked at: it has the frames of all ranks.
"""

import json
import os
import subprocess
import sys
import unittest

import test_ranks
from test_ranks import PERIODIC, PROGRAM


def fluid(across):
    """A periodic fluid of across * across particles, of few steps, with a first and a last frame."""
    text = PERIODIC.format(scheme="consistent", precision="").replace("spacing = 0.02", f"spacing = {1 / across!r}")
    return text.replace("end = 0.06", f"end = {0.03 / across!r}")


@unittest.skipUnless(test_ranks.has_mpi(), "no MPI here")
@unittest.skipIf(os.environ.get("BARCHAN_SANITIZE"), "a sanitizer takes memory of its own")
class Memory(test_ranks.Folder):
    def of_one_process(self, across, *options):
        (self.at / "scene.toml").write_text(fluid(across))
        command = [PROGRAM, "run", "scene.toml", "--quiet", "--threads", "1", "--retreats", "0", "--out", f"one-{across}", *options]
        process = subprocess.Popen(command, cwd=self.at, stderr=subprocess.DEVNULL)
        _, status, use = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return 1024 * use.ru_maxrss

    def of_ranks(self, ranks, across, *options):
        self.run_on(ranks, fluid(across), f"of-{ranks}-{across}", "--retreats", "0", *options)
        return json.loads((self.at / f"of-{ranks}-{across}/run.json").read_text())["ranks"]["most_memory_of_others"]

    def test_it_falls_with_the_number_of_ranks(self):
        few, many, ranks = 100, 450, 3
        more = many**2 - few**2
        alone = (self.of_one_process(many) - self.of_one_process(few)) / more
        shared = (self.of_ranks(ranks, many) - self.of_ranks(ranks, few)) / more
        share = shared / alone
        print(f"bytes a particle of all: {alone:.0f} of one process, {shared:.0f} of a rank of {ranks}: {share:.3f}", flush=True)
        # Ghosts are 3.8 spacings on both sides of a piece, 1/20 of it; numbers by cell are of the whole domain, 14 bytes a particle.
        self.assertLess(share, 1.25 / ranks)

        def again(across):
            return ["--restart", "latest", "--set", f"time.end={0.06 / across!r}"]

        alone = (self.of_one_process(many, *again(many)) - self.of_one_process(few, *again(few))) / more
        shared = (self.of_ranks(ranks, many, *again(many)) - self.of_ranks(ranks, few, *again(few))) / more
        share = shared / alone
        print(f"at a restart: {alone:.0f} of one process, {shared:.0f} of a rank of {ranks}: {share:.3f}", flush=True)
        self.assertLess(share, 1.1 / ranks)
        # The last of all: what this process has held itself counts as memory of those that it starts.
        self.same(f"one-{many}", f"of-{ranks}-{many}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
