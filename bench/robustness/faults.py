#!/usr/bin/python3
"""Runs on full disks, and with twelve further faults: message, exit status, earlier frames, and going on after mending.

    faults.py PROGRAM [--sizes 70]

Needs root (it mounts small file systems in memory and runs as another user). Prints a line a fault and the figures as JSON; status 1
when one went wrong.
"""
import argparse
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENE = SOURCE / "scenes/verification/poiseuille.toml"
SHORT = ["--set", "time.end=0.03", "--set", "output.every=0.002", "--set", "output.checkpoint-every=0.05"]
LONG = ["--set", "time.end=5", "--set", "output.every=0.01", "--set", "output.checkpoint-every=0.05"]
NOBODY = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]


def series_is_whole(folder):
    pvd = folder / "poiseuille.pvd"
    if not pvd.exists():
        return True
    for line in pvd.read_text().splitlines():
        if "DataSet" in line:
            reader = vtkXMLPolyDataReader()
            reader.SetFileName(str(folder / line.split('file="')[1].split('"')[0]))
            reader.Update()
            if reader.GetOutput().GetNumberOfPoints() == 0:
                return False
    return True


class Faults:
    def __init__(self, program, sizes):
        self.sizes, self.failures, self.passed = sizes, 0, []
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="barchan_faults_"))
        self.top.chmod(0o755)
        self.program = self.top / "barchan"  # where another user may run it
        shutil.copy(program, self.program)
        self.out = self.top / "out"

    def command(self, *options, scene=None, short=True, threads=1):
        return [str(self.program), "run", str(scene or SCENE), "--out", str(self.out), "--threads", str(threads), *(SHORT if short else LONG), *options]

    def run(self, *options, before=(), **more):
        return subprocess.run([*before, *self.command("--quiet", *options, **more)], capture_output=True, text=True, timeout=300)

    def start(self, *options, before=(), **more):
        """A long run that has written its first checkpoint; the shell that it is started by is left out."""
        run = subprocess.Popen([*before, *self.command("--quiet", *options, short=False, **more)], stderr=subprocess.PIPE, text=True)
        for _ in range(600):
            if (self.out / "poiseuille.checkpoint.older").exists() or run.poll() is not None:
                break
            time.sleep(0.02)
        return run

    def says(self):
        try:
            return json.loads((self.out / "run.json").read_text())["end_reason"]
        except (OSError, ValueError, KeyError):
            return ""

    def check(self, name, *conditions):
        wrong = [what for good, what in conditions if not good]
        print(f"{'FAILED' if wrong else 'good  '} {name}" + "".join(f"\n       {what}" for what in wrong), flush=True)
        self.failures += bool(wrong)
        self.passed.append(not wrong)

    def goes_on(self):
        """Whether the run can be continued, or begun again where nothing was kept."""
        kept = (self.out / "poiseuille.checkpoint").exists() or (self.out / "poiseuille.checkpoint.older").exists()
        done = self.run(*(["--restart", "latest"] if kept else []), "--set", "time.end=0.5")
        return done.returncode in (0, 2) and ("larger time.end" in done.stderr or done.returncode == 0) and series_is_whole(self.out)

    def fresh(self, owner=0):
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        os.chown(self.out, owner, owner)

    def full_disks(self):
        full = 0
        for number in range(self.sizes):
            kilobytes = 8 + number * 12
            self.out.mkdir(exist_ok=True)
            subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "barchan", str(self.out)], check=True)
            try:
                done = self.run()
                full += done.returncode == 4
                good = [(done.returncode in (0, 4), f"status {done.returncode}"),
                        (done.returncode == 0 or "No space left on device" in done.stderr, "message: " + done.stderr[-300:]),
                        (series_is_whole(self.out), "a listed frame is not whole"),
                        (done.returncode == 0 or not (self.out / "run.json").exists() or self.says().startswith("output failed"), f"run.json says {self.says()!r}")]
                subprocess.run(["mount", "-o", "remount,size=20m", str(self.out)], check=True)
                good.append((self.goes_on(), "does not go on after mending"))
            finally:
                subprocess.run(["umount", str(self.out)], check=True)
            self.check(f"disk of {kilobytes} kB: status {done.returncode}", *good)
        return full

    def stopped(self, run, status, message):
        try:
            _, errors = run.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            run.kill()
            _, errors = run.communicate()
        return [(run.returncode == status, f"status {run.returncode}; expected {status}"), (message in errors, "message: " + errors[-300:])]

    def others(self):
        self.fresh()
        run = self.start()
        self.out.rename(self.top / "gone")
        self.check("folder removed", *self.stopped(run, 4, str(self.out)))
        self.fresh()
        self.check("begun again after that", (self.goes_on(), "does not go on"))

        self.fresh(65534)
        self.out.chmod(0o000)
        done = self.run(before=NOBODY)
        self.check("folder unreadable", (done.returncode == 4, f"status {done.returncode}"), ("Permission denied" in done.stderr, done.stderr))
        self.out.chmod(0o755)

        self.fresh(65534)
        run = self.start(before=NOBODY)
        self.out.chmod(0o000)  # TERMINATE cannot be looked at, nothing can be written
        conditions = self.stopped(run, 4, "Permission denied")
        self.out.chmod(0o755)
        self.check("folder closed during the run", *conditions, (series_is_whole(self.out), "series"), (self.goes_on(), "does not go on"))

        self.fresh()
        subprocess.run(["mount", "-t", "tmpfs", "barchan", str(self.out)], check=True)
        run = self.start()
        run.send_signal(signal.SIGKILL)
        run.wait()
        subprocess.run(["mount", "-o", "remount,ro", str(self.out)], check=True)
        done = self.run("--restart", "latest")
        subprocess.run(["mount", "-o", "remount,rw", str(self.out)], check=True)
        self.check("folder read-only", (done.returncode == 4, f"status {done.returncode}"), ("Read-only file system" in done.stderr, done.stderr),
                   (series_is_whole(self.out), "series"), (self.goes_on(), "does not go on"))
        subprocess.run(["umount", str(self.out)], check=True)

        self.fresh()
        run = self.start()
        run.send_signal(signal.SIGKILL)
        run.wait()
        for file in self.out.iterdir():  # as after a clock that was set back by a year
            os.utime(file, (time.time() + 3e7, time.time() + 3e7))
        self.check("clock set back", (self.goes_on(), "does not go on with files of the future"))

        self.fresh(65534)
        done = subprocess.run(["prlimit", "--nproc=1:1", *NOBODY, *self.command("--quiet", threads=8)], capture_output=True, text=True)
        self.check("no threads", (done.returncode == 4, f"status {done.returncode}"), ("cannot make" in done.stderr, done.stderr))

        self.fresh()
        done = self.run("--set", "spacing=1e-6", before=["prlimit", "--as=500000000"])
        self.check("no memory", (done.returncode == 2, f"status {done.returncode}"), ("ulimit -v leaves" in done.stderr, done.stderr[-300:]))

        done = self.run(before=["prlimit", "--nofile=4:4"])
        self.check("no file handles", (done.returncode in (2, 4), f"status {done.returncode}"), ("Too many open files" in done.stderr, done.stderr[-300:]),
                   (self.goes_on(), "does not go on"))

        self.fresh()
        run = self.start()
        second = self.run()
        run.send_signal(signal.SIGHUP)
        self.check("second run", (second.returncode == 2, f"status {second.returncode}"), (f"process {run.pid} on host" in second.stderr, second.stderr))
        self.check("SIGHUP", *self.stopped(run, 129, "SIGHUP"), (self.says() == "SIGHUP", self.says()), (self.goes_on(), "does not go on"))

        self.fresh()
        pipe = subprocess.run(["bash", "-c", "\"$@\" | head -1; exit ${PIPESTATUS[0]}", "-", *self.command()], capture_output=True, text=True)
        self.check("closed pipe", (pipe.returncode == 0, f"status {pipe.returncode}"), (self.says() == "end", self.says()))

        self.fresh()
        done = self.run(before=["prlimit", "--fsize=20000"])
        self.check("file size limited", (done.returncode == 4, f"status {done.returncode}"), ("File too large" in done.stderr, done.stderr[-300:]),
                   (series_is_whole(self.out), "series"), (self.goes_on(), "does not go on"))

        self.fresh()
        run = subprocess.Popen(["prlimit", "--cpu=1:30", *self.command("--quiet", short=False)], stderr=subprocess.PIPE, text=True)
        self.check("processor time limited", *self.stopped(run, 152, "SIGXCPU"), (self.goes_on(), "does not go on"))

        self.fresh()
        (self.out / "poiseuille.checkpoint" / "in the way").mkdir(parents=True)
        done = self.run()
        self.check("no place for the checkpoint", (done.returncode == 4, f"status {done.returncode}"), ("poiseuille.checkpoint" in done.stderr, done.stderr[-300:]),
                   (series_is_whole(self.out), "series"))

    def main(self):
        full = self.full_disks()
        disks, self.passed = self.passed, []
        self.others()
        shutil.rmtree(self.top)
        print(json.dumps({"disks": len(disks), "disks_full": full, "disks_good": sum(disks), "faults": len(self.passed), "faults_good": sum(self.passed)}))
        return 1 if self.failures else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--sizes", type=int, default=70)
    options = parser.parse_args()
    sys.exit(Faults(options.program, options.sizes).main())
