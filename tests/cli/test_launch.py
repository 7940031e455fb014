#!/usr/bin/python3
"""Processes that mpirun or srun start together: those that would write one folder are refused, independent runs are not.

    test_launch.py PROGRAM SOURCE_DIR
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv[1]
SOURCE = pathlib.Path(sys.argv[2])
SCENE = str(SOURCE / "scenes/verification/couette.toml")
SHORT = ["--quiet", "--threads", "1", "--set", "time.end=0.01"]
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "2"]
LAUNCHERS = ("OMPI_", "PMI", "PMIX", "SLURM_")


class Launch(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.at = pathlib.Path(self.folder.name)
        self.addCleanup(self.folder.cleanup)

    def run_as(self, command, **environment):
        alone = {k: v for k, v in os.environ.items() if not k.startswith(LAUNCHERS)}
        return subprocess.run(command, cwd=self.at, env={**alone, **environment}, capture_output=True, text=True, timeout=300)

    def one(self, *options, **environment):
        return self.run_as([PROGRAM, "run", SCENE, *SHORT, *options], **environment)

    def test_processes_of_one_folder_are_refused_before_anything_is_written(self):
        for variable in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"):
            ended = self.one(**{variable: "3"})
            self.assertEqual(ended.returncode, 2, ended.stderr)
            self.assertIn(f"started 3 processes ({variable})", ended.stderr)
            self.assertIn("expected barchan without mpirun", ended.stderr)
            self.assertEqual(list(self.at.iterdir()), [])

    def test_one_process_and_the_script_of_a_job_run_as_ever(self):
        for environment in ({"OMPI_COMM_WORLD_SIZE": "1"}, {"SLURM_NTASKS": "8", "SLURM_PROCID": "0"}, {"PMI_SIZE": "many"},
                            {"OMPI_COMM_WORLD_SIZE": "1", "SLURM_STEP_NUM_TASKS": "4"}):
            ended = self.one(**environment)
            self.assertEqual(ended.returncode, 0, f"{environment}: {ended.stderr}")

    def test_a_folder_of_its_own_makes_an_independent_run(self):
        ended = self.one("--out", "mine", SLURM_STEP_NUM_TASKS="2", SLURM_PROCID="1")
        self.assertEqual(ended.returncode, 0, ended.stderr)
        self.assertTrue((self.at / "mine/couette.pvd").exists())

    def test_a_second_process_in_a_given_folder_is_told_who_started_it(self):
        with subprocess.Popen([PROGRAM, "run", SCENE, "--quiet", "--set", "time.end=1000", "--out", "one"], cwd=self.at) as first:
            try:
                while not (self.at / "one/couette.pvd").exists():
                    self.assertIsNone(first.poll())
                ended = self.one("--out", "one", OMPI_COMM_WORLD_SIZE="2")
            finally:
                first.terminate()
        self.assertEqual(ended.returncode, 2)
        self.assertIn(f"process {first.pid} on host", ended.stderr)
        self.assertIn("started 2 processes (OMPI_COMM_WORLD_SIZE): each is a run and needs an --out of its own", ended.stderr)

    @unittest.skipUnless(shutil.which("mpirun"), "no mpirun here")
    def test_mpirun_itself(self):
        together = self.run_as([*MPIRUN, PROGRAM, "run", SCENE, *SHORT])
        if "libmpi" in subprocess.run(["ldd", PROGRAM], capture_output=True, text=True).stdout:  # ranks of one run: test_ranks.py
            self.assertEqual(together.returncode, 0, together.stderr)
        else:
            self.assertEqual(together.returncode, 2, together.stderr)
            self.assertIn("started 2 processes", together.stderr)
            self.assertEqual(list(self.at.iterdir()), [])
        script = f'exec "{PROGRAM}" run "{SCENE}" {" ".join(SHORT)} --out "of-$OMPI_COMM_WORLD_RANK"'
        apart = self.run_as([*MPIRUN, "sh", "-c", script])
        self.assertEqual(apart.returncode, 0, apart.stderr)
        frames = [(self.at / f"of-{rank}/couette_000001.vtp").read_bytes() for rank in (0, 1)]
        self.assertEqual(*frames)

    @unittest.skipUnless(shutil.which("mpirun"), "no mpirun here")
    def test_an_independent_run_tells_its_error_before_the_others_end(self):
        script = (f'if [ $OMPI_COMM_WORLD_RANK = 0 ]; then end=1000; else end=-1; fi\n'
                  f'exec "{PROGRAM}" run "{SCENE}" --quiet --threads 1 --set time.end=$end --out "of-$OMPI_COMM_WORLD_RANK"')
        environment = {k: v for k, v in os.environ.items() if not k.startswith(LAUNCHERS)}
        with subprocess.Popen([*MPIRUN, "sh", "-c", script], cwd=self.at, env=environment, stderr=subprocess.PIPE, text=True) as both:
            try:
                for line in both.stderr:
                    if "time.end" in line:
                        break
                self.assertIn("time.end", line)
                self.assertIsNone(both.poll())
            finally:
                both.terminate()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
