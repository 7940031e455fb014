#!/usr/bin/python3
"""Ranks that get signals: one of three is killed, all end, the checkpoint is whole, and another number of ranks goes on to the same bytes.

    test_ranks_killed.py PROGRAM SOURCE_DIR [MOMENTS]      MOMENTS: how many random moments of death, 2 if nothing is said
"""

import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
SOURCE = pathlib.Path(sys.argv[2]).resolve()
MOMENTS = int(sys.argv[3]) if len(sys.argv) > 3 else 2
RANKS = 3
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n"]
sys.path.insert(0, str(SOURCE / "bench"))
from barchan_bench import checkpoints  # noqa: E402
ALONE = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMI", "PMIX", "SLURM_"))}

SCENE = """
dimensions = 2
spacing = 0.02
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 10
[interactions]
water-water = 2.1
[[fill]]
phase = "water"
shape = "the-rest"
perturb = 0.1
velocity = ["sin(2*pi*x)*cos(2*pi*y)", "-cos(2*pi*x)*sin(2*pi*y)"]
[time]
end = 2
largest-speed = 1
[output]
every = 0.5
history-every = 0.05
checkpoint-every = 0.1
"""


def has_mpi():
    """Whether mpirun is there and the program knows MPI."""
    return bool(shutil.which("mpirun")) and "libmpi" in subprocess.run(["ldd", PROGRAM], capture_output=True, text=True).stdout


@unittest.skipUnless(has_mpi(), "no MPI here")
class Killed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.at = pathlib.Path(folder.name)
        self.addCleanup(folder.cleanup)
        (self.at / "scene.toml").write_text(SCENE)

    def launch(self, ranks, out, *options):
        before = [*MPIRUN, str(ranks)] if ranks else []
        run = subprocess.Popen([*before, PROGRAM, "run", "scene.toml", "--quiet", "--threads", "1", "--out", out, *options],
                               cwd=self.at, env=ALONE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(run.kill)
        return run

    def end(self, run, seconds=300):
        _, errors = run.communicate(timeout=seconds)
        return errors

    def ranks_of(self, run, out):
        """The processes of the ranks, by number."""
        found = {}
        for entry in pathlib.Path("/proc").iterdir():
            try:
                words = (entry / "cmdline").read_bytes().split(b"\0")
                if words[0] == PROGRAM.encode() and str(self.at).encode() == os.readlink(entry / "cwd").encode() and out.encode() in words:
                    env = dict(x.split(b"=", 1) for x in (entry / "environ").read_bytes().split(b"\0") if b"=" in x)
                    found[int(env[b"OMPI_COMM_WORLD_RANK"])] = int(entry.name)
            except (OSError, IndexError, KeyError):
                continue
        return found

    def wait_for(self, what, run, seconds=60):
        until = time.monotonic() + seconds
        while not what():
            self.assertIsNone(run.poll(), "the run ended too early")
            self.assertLess(time.monotonic(), until)
            time.sleep(0.01)

    def checkpoint(self, out):
        return self.at / out / "scene.checkpoint"

    def test_a_rank_dies(self):
        one = self.launch(0, "one")
        started = time.monotonic()
        self.assertEqual((self.end(one), one.returncode), ("", 0))
        alone = time.monotonic() - started
        chance = random.Random(20261126)
        slowest = 0.0
        for k in range(MOMENTS):
            out = f"killed-{k}"
            # Of two runs one writes a checkpoint after every step: then most moments are ones at which pieces are written.
            run = self.launch(RANKS, out, *([] if k % 2 else ["--set", "output.checkpoint-every=1e-9"]))
            self.wait_for(self.checkpoint(out).exists, run)
            time.sleep(chance.uniform(0, 0.4 * alone))
            if run.poll() is not None:
                self.fail("the run ended before its rank was killed")
            who = chance.randrange(RANKS)
            victims = self.ranks_of(run, out)
            self.assertEqual(sorted(victims), list(range(RANKS)))
            os.kill(victims[who], signal.SIGKILL)
            began = time.monotonic()
            errors = self.end(run, 30)
            slowest = max(slowest, time.monotonic() - began)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn(f"rank {who}", errors)
            self.wait_until_gone(out)
            after = self.launch((0, 2, 4)[k % 3], out, "--restart", "latest")
            self.assertEqual((self.end(after), after.returncode)[1], 0)
            for name in ("scene_000004.vtp", "scene.checkpoint", "history.csv"):
                read = checkpoints.whole if name.endswith(".checkpoint") else pathlib.Path.read_bytes
                self.assertEqual(read(self.at / "one" / name), read(self.at / out / name), f"{name} of {out}")
            self.no_piece_is_left_over(self.at / out)
        print(f"  {MOMENTS} deaths of a rank: all ended within {slowest:.2f} s, bound 10")
        self.assertLess(slowest, 10)

    def no_piece_is_left_over(self, folder):
        """The pieces that are there are those that an index names."""
        named = {piece for name in ("scene.checkpoint", "scene.checkpoint.older") if (folder / name).exists() for piece in checkpoints.pieces(folder / name)}
        self.assertEqual(set((folder / "scene_checkpoint").glob("*")), named)

    def wait_until_gone(self, out):
        until = time.monotonic() + 10
        while self.ranks_of(None, out):
            self.assertLess(time.monotonic(), until, "a rank is still there")
            time.sleep(0.02)

    def test_a_signal_to_any_rank_reaches_all(self):
        run = self.launch(RANKS, "asked", "--set", "output.checkpoint-every=0", "--set", "time.end=50")
        self.wait_for((self.at / "asked/scene_000000.vtp").exists, run)
        self.assertFalse(self.checkpoint("asked").exists())
        last = self.ranks_of(run, "asked")[RANKS - 1]
        os.kill(last, signal.SIGUSR1)
        self.wait_for(self.checkpoint("asked").exists, run)
        os.kill(last, signal.SIGTERM)
        errors = self.end(run, 30)
        self.assertEqual(run.returncode, 128 + signal.SIGTERM, errors)
        self.assertEqual(errors.count("barchan: stopped by SIGTERM"), 1, errors)

    def test_the_job_of_slurm_goes_on_until_the_scene_has_ended(self):
        tools = self.at / "tools"
        tools.mkdir()
        launch = 'while [ "${1#-}" != "$1" ]; do shift; done\nunset ${!SLURM_*}\nexec ' + " ".join([*MPIRUN, "2"]) + ' "$@"\n'
        for name, text in (("srun", launch), ("scontrol", 'echo "$@" >> asked\n')):
            (tools / name).write_text("#!/bin/bash\n" + text)
            (tools / name).chmod(0o755)
        env = ALONE | {"PATH": f"{tools}:{os.environ['PATH']}", "BARCHAN": PROGRAM, "SLURM_CPUS_PER_TASK": "1", "SLURM_JOB_ID": "77"}

        def job():
            run = subprocess.Popen(["bash", str(SOURCE / "scripts/slurm.sh"), "scene.toml", "--out", "job", "--set", "time.end=1"],
                                   cwd=self.at, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.addCleanup(run.kill)
            return run

        run = job()
        self.wait_for((self.at / "job/scene_000000.vtp").exists, run)
        os.kill(self.ranks_of(run, "job")[1], signal.SIGTERM)
        errors = self.end(run, 30)
        self.assertEqual(run.returncode, 143, errors)
        self.assertEqual((self.at / "asked").read_text(), "requeue 77\n")
        run = job()
        errors = self.end(run)
        self.assertEqual(run.returncode, 0, errors)
        self.assertEqual((self.at / "asked").read_text(), "requeue 77\n")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
