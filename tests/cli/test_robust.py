#!/usr/bin/python3
"""A run answers signals, owns its folder, says where it stands, goes back after a failed step, and refuses what it cannot hold.

    test_robust.py PROGRAM SOURCE_DIR
"""

import json
import os
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
SANITIZED = bool(os.environ.get("BARCHAN_SANITIZE"))
SCENE = SOURCE / "scenes/verification/poiseuille.toml"  # has probes, profiles and wall shear
SHORT = ["--set", "time.end=0.02", "--set", "output.every=0.004"]
LONG = ["--set", "time.end=100", "--set", "output.every=0.01"]

# A cloud of grains in a domain a thousand times as wide.
SPARSE = """
dimensions = 2
spacing = 0.001
[domain]
size = [29, 29]
[phases.sand]
kind = "grains"
density = 2650
[interactions]
sand-sand = {}
[[fill]]
phase = "sand"
shape = { box = { min = [14, 14], max = [14.005, 14.005] } }
velocity = [1, 0]
[time]
end = 1e-4
"""

SPHERES = """
dimensions = 3
spacing = 0.001
[domain]
size = [0.05, 0.1, 0.05]
periodic = ["x", "z"]
[phases.sand]
kind = "grains"
density = 2650
diameter = { mean = 0.001, spread = 0.2 }
friction = 0.5
young = 1e7
poisson = 0.3
[interactions]
sand-sand = { law = "hertz" }
[[fill]]
phase = "sand"
shape = { box = { min = [0, 0, 0], max = [0.05, 0.1, 0.05] } }
[time]
end = 1e-4
largest-speed = 1.0
"""


class Robust(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.top = pathlib.Path(self.scratch.name)
        self.out = self.top / "out"

    def command(self, *options, scene=SCENE):
        return [PROGRAM, "run", str(scene), "--out", str(self.out), "--threads", "1", *options]

    def run_now(self, *options, **more):
        return subprocess.run(self.command("--quiet", *options, **more), capture_output=True, text=True)

    def start(self, *options):
        shutil.rmtree(self.out, ignore_errors=True)
        run = subprocess.Popen(self.command("--quiet", *LONG, *options), stderr=subprocess.PIPE, text=True)
        self.wait_for(lambda: (self.out / "poiseuille.pvd").exists())
        return run

    def wait_for(self, what):
        for _ in range(500):
            if what():
                return
            time.sleep(0.02)
        self.fail("waited for ten seconds")

    def report(self):
        return json.loads((self.out / "run.json").read_text())

    def test_signals_that_stop_have_their_own_status(self):
        for number, name in ((signal.SIGHUP, "SIGHUP"), (signal.SIGQUIT, "SIGQUIT"), (signal.SIGXCPU, "SIGXCPU")):
            run = self.start()
            run.send_signal(number)
            _, errors = run.communicate(timeout=60)
            self.assertEqual(run.returncode, 128 + number)
            self.assertIn(f"stopped by {name}", errors)
            self.assertEqual(self.report()["end_reason"], name)
            self.assertTrue((self.out / "poiseuille.checkpoint").exists())

    def test_usr1_writes_a_checkpoint_and_the_run_goes_on(self):
        run = self.start()
        run.send_signal(signal.SIGUSR1)
        self.wait_for((self.out / "poiseuille.checkpoint").exists)
        self.assertIsNone(run.poll())
        self.assertEqual(self.report()["end_reason"], "running")
        self.assertEqual(self.report()["process"], run.pid)
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, 143)

    def test_nohup_is_obeyed(self):
        run = subprocess.Popen(["nohup", *self.command("--quiet", *LONG)], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        self.wait_for(lambda: (self.out / "poiseuille.pvd").exists())
        run.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(run.poll())
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, 143)

    def test_second_run_is_refused_and_a_dead_one_holds_nobody_up(self):
        run = self.start()
        second = self.run_now(*SHORT)
        self.assertEqual(second.returncode, 2)
        self.assertIn(f"process {run.pid} on host", second.stderr)
        run.send_signal(signal.SIGKILL)
        run.communicate()
        self.assertEqual(self.report()["end_reason"], "running")
        third = self.run_now(*SHORT)
        self.assertEqual(third.returncode, 0, third.stderr)
        self.assertIn(f"the run of process {run.pid}", third.stderr)
        self.assertFalse((self.out / "barchan.lock").exists())
        self.assertEqual(self.report()["end_reason"], "end")

    def test_older_checkpoint_is_taken_when_the_newer_is_damaged(self):
        self.assertEqual(self.run_now(*SHORT, "--set", "output.checkpoint-every=1e-9").returncode, 0)
        whole = {f.name: f.read_bytes() for f in self.out.iterdir() if f.suffix in (".csv", ".vtp", ".pvd", ".vti")}
        newest = self.out / "poiseuille.checkpoint"
        newest.write_bytes(newest.read_bytes()[:-5])
        again = self.run_now(*SHORT, "--restart", "latest")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("is damaged", again.stderr)
        self.assertIn("going on from the one before it", again.stderr)
        for name, content in whole.items():
            self.assertEqual((self.out / name).read_bytes(), content, name)

    def test_changed_scene_is_refused_by_key_and_harmless_changes_are_not(self):
        self.assertEqual(self.run_now(*SHORT).returncode, 0)
        other = self.run_now("--restart", "latest", "--set", "time.safety=0.5", "--set", "time.end=0.03")
        self.assertEqual(other.returncode, 2)
        self.assertIn("time.safety", other.stderr)
        self.assertIn("not there then, 0.5 now", other.stderr)
        more = self.run_now("--restart", "latest", "--set", "time.end=0.03", "--set", "output.every=0.001", "--set", 'output.fields=["acceleration"]')
        self.assertEqual(more.returncode, 0, more.stderr)

    def test_closed_pipe_does_not_end_the_run(self):
        run = subprocess.Popen(self.command(*SHORT), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        run.stdout.close()
        self.assertEqual(run.wait(timeout=120), 0)
        self.assertEqual(self.report()["end_reason"], "end")

    def test_files_that_the_new_run_does_not_measure_go(self):
        self.assertEqual(self.run_now(*SHORT).returncode, 0)
        measured = [f for m in self.report()["measured"] for f in m["files"]]
        self.assertTrue(measured)
        (self.out / "profile_mine.csv").write_text("of the user")
        plain = self.top / "poiseuille.toml"
        text = SCENE.read_text()
        keep, skip = [], False
        for line in text.splitlines():
            if line.startswith("["):
                skip = line.split("#")[0].strip() in ("[[probe]]", "[[profile]]", "[[grid]]", "[[wall-shear]]")
            if not skip:
                keep.append(line)
        plain.write_text("\n".join(keep))
        done = self.run_now(*SHORT, scene=plain)
        self.assertEqual(done.returncode, 0, done.stderr)
        for name in measured:
            self.assertFalse((self.out / name).exists(), name)
        self.assertTrue((self.out / "profile_mine.csv").exists())

    def test_failed_step_is_tried_again_with_smaller_ones(self):
        dam = SOURCE / "scenes/verification/dam_break.toml"
        wild = ["--set", "time.safety=1.6", "--set", "time.end=0.01"]
        without = self.run_now(*wild, "--retreats", "0", scene=dam)
        self.assertEqual(without.returncode, 3, without.stderr)
        done = self.run_now(*wild, scene=dam)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("going back to t =", done.stderr)
        report = self.report()
        self.assertGreater(report["retreats"]["count"], 0)
        self.assertEqual(len(report["retreats"]["list"]), report["retreats"]["count"])
        self.assertGreater(report["time_step_limits"]["retreat"], 0)
        self.assertTrue(any("went back to an earlier step" in w for w in report["warnings"]))
        times = [float(row.split(",")[0]) for row in (self.out / "history.csv").read_text().splitlines()[1:]]
        self.assertEqual(times, sorted(set(times)))

    @unittest.skipIf(SANITIZED, "a sanitizer takes memory of its own")
    def test_memory_that_is_not_there_is_refused_with_the_numbers(self):
        limited = ["prlimit", "--as=600000000", *self.command("--quiet", "--set", "spacing=1e-6")]
        done = subprocess.run(limited, capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("ulimit -v leaves", done.stderr)
        self.assertFalse(self.out.exists())

    @unittest.skipIf(SANITIZED, "a sanitizer takes memory of its own")
    def test_an_empty_domain_costs_nothing(self):
        scene = self.top / "sparse.toml"
        scene.write_text(SPARSE)
        run = subprocess.Popen(self.command("--quiet", scene=scene), stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = status
        self.assertEqual(status, 0)
        self.assertLess(usage.ru_maxrss, 250_000, "kB")

    @unittest.skipIf(SANITIZED, "a sanitizer takes memory of its own")
    def test_planned_memory_is_not_less_than_what_a_bed_of_spheres_takes(self):
        scene = self.top / "spheres.toml"
        scene.write_text(SPHERES)
        plan = subprocess.run([PROGRAM, "plan", str(scene)], capture_output=True, text=True, check=True).stdout
        planned = float(re.search(r"memory  ([0-9.]+) MB", plan)[1]) * 1e3
        run = subprocess.Popen(self.command("--quiet", scene=scene), stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = status
        self.assertEqual(status, 0)
        self.assertLess(usage.ru_maxrss, planned, "kB")
        self.assertLess(planned, 2 * usage.ru_maxrss, "kB")

    def test_standard_output_that_is_full_is_an_error(self):
        for command in (["schema"], ["--version"], ["plan", str(SCENE), "--set", "time.end=1e-4"]):
            with open("/dev/full", "w") as full:
                done = subprocess.run([PROGRAM, *command], stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual(done.returncode, 4, command)
            self.assertIn("standard output", done.stderr)

    def test_tolerance_must_be_a_number(self):
        for bad in ("nan", "inf", "-1", "x"):
            self.assertEqual(subprocess.run([PROGRAM, "compare", "a.vtp", "b.vtp", "--tolerance", bad], capture_output=True).returncode, 2, bad)

    def test_long_texts_are_cut_in_messages(self):
        for key, value in (("title", 5), ("phases.water.kind", '"' + "x" * 3000 + '"'), ("forcing.0.acceleration", '["' + "sin(" * 2000 + '", 0]'), ("y" * 3000, 1)):
            done = self.run_now("--set", f"{key}={value}")
            self.assertEqual(done.returncode, 2)
            self.assertLess(len(done.stderr), 4000, done.stderr[:300])

    def test_versions_of_all_packages(self):
        said = subprocess.run([PROGRAM, "--version", "--verbose"], capture_output=True, text=True)
        self.assertEqual(said.returncode, 0)
        for name in ("VTK", "Eigen", "CLI11", "toml++", "muParser", "nlohmann-json", "zlib", "OpenMP"):
            self.assertRegex(said.stdout, f"(?m)^{name.replace('+', '[+]')}: [0-9]")
        self.assertNotIn("Eigen", subprocess.run([PROGRAM, "--version"], capture_output=True, text=True).stdout)
        self.assertEqual(subprocess.run([str(SOURCE / "scripts/sbom"), "--check"]).returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
