#!/usr/bin/python3
"""Runs on full disks, alone and on three ranks, and with twelve further faults: message, exit status, earlier frames, and going on after mending.

    faults.py PROGRAM [--sizes 70] [--ranks-only]

Of the ranks: all end within 10 s, and two ranks go on to the bytes of a run of one process on a disk that is large enough.

Needs root (it mounts small file systems in memory and runs as another user). Prints a line a fault and the figures as JSON; status 1
when one went wrong.
"""
import argparse
import json
import os
import pathlib
import shutil
import signal
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import checkpoints, frame, run as runs  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENE = SOURCE / "scenes/verification/poiseuille.toml"
SHORT = ["time.end=0.03", "output.every=0.002", "output.checkpoint-every=0.05"]
LONG = ["time.end=5", "output.every=0.01", "output.checkpoint-every=0.05"]
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n"]
NOBODY = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]


def series_is_whole(folder):
    pvd = folder / "poiseuille.pvd"
    try:
        return not pvd.exists() or all(len(frame.Frame(file).x) > 0 for _, file in frame.series(pvd))
    except frame.Unreadable:
        return False


class Faults:
    def __init__(self, program, sizes):
        self.sizes, self.failures, self.passed = sizes, 0, []
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="barchan_faults_"))
        self.top.chmod(0o755)
        self.program = self.top / "barchan"  # where another user may run it
        shutil.copy(program, self.program)
        self.out = self.top / "out"

    def command(self, *options, scene=None, short=True, threads=1):
        return runs.words(self.program, scene or SCENE, self.out, SHORT if short else LONG, threads=threads, quiet=False, options=options)

    def run(self, *options, before=(), **more):
        return runs.command([*before, *self.command("--quiet", *options, **more)], timeout=300)

    def start(self, *options, before=(), **more):
        """A long run that has written its first checkpoint; the shell that it is started by is left out."""
        run = runs.start([*before, *self.command("--quiet", *options, short=False, **more)], stderr=runs.PIPE)
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

    def goes_on(self, before=()):
        """Whether the run can be continued, or begun again where nothing was kept."""
        kept = (self.out / "poiseuille.checkpoint").exists() or (self.out / "poiseuille.checkpoint.older").exists()
        done = self.run(*(["--restart", "latest"] if kept else []), "--set", "time.end=0.5", before=before)
        return done.status in (0, 2) and ("larger time.end" in done.stderr or done.status == 0) and series_is_whole(self.out)

    def fresh(self, owner=0):
        shutil.rmtree(self.out, ignore_errors=True)
        self.out.mkdir()
        os.chown(self.out, owner, owner)

    def full_disks(self):
        full = 0
        for number in range(self.sizes):
            kilobytes = 8 + number * 12
            self.out.mkdir(exist_ok=True)
            runs.command(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "barchan", self.out], check=True)
            try:
                done = self.run()
                full += done.status == 4
                good = [(done.status in (0, 4), f"status {done.status}"),
                        (done.status == 0 or "No space left on device" in done.stderr, "message: " + done.stderr[-300:]),
                        (series_is_whole(self.out), "a listed frame is not whole"),
                        (done.status == 0 or not (self.out / "run.json").exists() or self.says().startswith("output failed"), f"run.json says {self.says()!r}")]
                runs.command(["mount", "-o", "remount,size=20m", self.out], check=True)
                good.append((self.goes_on(), "does not go on after mending"))
            finally:
                runs.command(["umount", self.out], check=True)
            self.check(f"disk of {kilobytes} kB: status {done.status}", *good)
        return full

    def bytes_of(self, folder):
        """All that has the bits of a run; the checkpoint before the last one is another in a run that was continued."""
        return {f.name: checkpoints.whole(f) if f.suffix == ".checkpoint" else f.read_bytes() for f in folder.iterdir()
                if f.is_file() and f.name not in ("run.json", "barchan.lock") and not f.name.endswith(".older")}

    def full_disks_of_ranks(self):
        """The first rank finds its disk full, the others wait for it in a reduction or a gathering."""
        self.fresh()
        self.run("--set", "time.end=0.5").checked("a run of one process")
        reference = self.bytes_of(self.out)
        shutil.rmtree(self.out)
        full, slowest = 0, 0.
        for number in range(self.sizes):
            kilobytes = 8 + number * 12
            self.out.mkdir(exist_ok=True)
            runs.command(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "barchan", self.out], check=True)
            try:
                done = self.run(before=[*MPIRUN, 3])
                full += done.status != 0
                slowest = max(slowest, done.wall)
                good = [(done.status in (0, 4), f"status {done.status}"), (done.wall < 10, f"took {done.wall:.1f} s"),
                        (done.status == 0 or "No space left on device" in done.stderr, "message: " + done.stderr[-300:]),
                        (series_is_whole(self.out), "a listed frame is not whole"),
                        (done.status == 0 or not (self.out / "run.json").exists() or self.says().startswith("output failed"), f"run.json says {self.says()!r}")]
                runs.command(["mount", "-o", "remount,size=20m", self.out], check=True)
                good.append((self.goes_on(before=[*MPIRUN, 2]), "does not go on after mending"))
                found = self.bytes_of(self.out)
                other = sorted(name for name in found.keys() | reference.keys() if found.get(name) != reference.get(name))
                good.append((not other, "other bytes: " + ", ".join(other)))
            finally:
                runs.command(["umount", self.out], check=True)
            self.check(f"three ranks, disk of {kilobytes} kB: status {done.status}, {done.wall:.1f} s", *good)
        return full, slowest

    def stopped(self, run, status, message):
        try:
            _, errors = run.communicate(timeout=60)
        except runs.TimedOut:
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
        self.check("folder unreadable", (done.status == 4, f"status {done.status}"), ("Permission denied" in done.stderr, done.stderr))
        self.out.chmod(0o755)

        self.fresh(65534)
        run = self.start(before=NOBODY)
        self.out.chmod(0o000)  # TERMINATE cannot be looked at, nothing can be written
        conditions = self.stopped(run, 4, "Permission denied")
        self.out.chmod(0o755)
        self.check("folder closed during the run", *conditions, (series_is_whole(self.out), "series"), (self.goes_on(), "does not go on"))

        self.fresh()
        runs.command(["mount", "-t", "tmpfs", "barchan", self.out], check=True)
        run = self.start()
        run.send_signal(signal.SIGKILL)
        run.wait()
        runs.command(["mount", "-o", "remount,ro", self.out], check=True)
        done = self.run("--restart", "latest")
        runs.command(["mount", "-o", "remount,rw", self.out], check=True)
        self.check("folder read-only", (done.status == 4, f"status {done.status}"), ("Read-only file system" in done.stderr, done.stderr),
                   (series_is_whole(self.out), "series"), (self.goes_on(), "does not go on"))
        runs.command(["umount", self.out], check=True)

        self.fresh()
        run = self.start()
        run.send_signal(signal.SIGKILL)
        run.wait()
        for file in self.out.iterdir():  # as after a clock that was set back by a year
            os.utime(file, (time.time() + 3e7, time.time() + 3e7))
        self.check("clock set back", (self.goes_on(), "does not go on with files of the future"))

        self.fresh(65534)
        done = runs.command(["prlimit", "--nproc=1:1", *NOBODY, *self.command("--quiet", threads=8)])
        self.check("no threads", (done.status == 4, f"status {done.status}"), ("cannot make" in done.stderr, done.stderr))

        self.fresh()
        done = self.run("--set", "spacing=1e-6", before=["prlimit", "--as=500000000"])
        self.check("no memory", (done.status == 2, f"status {done.status}"), ("ulimit -v leaves" in done.stderr, done.stderr[-300:]))

        done = self.run(before=["prlimit", "--nofile=4:4"])
        self.check("no file handles", (done.status in (2, 4), f"status {done.status}"), ("Too many open files" in done.stderr, done.stderr[-300:]),
                   (self.goes_on(), "does not go on"))

        self.fresh()
        run = self.start()
        second = self.run()
        run.send_signal(signal.SIGHUP)
        self.check("second run", (second.status == 2, f"status {second.status}"), (f"process {run.pid} on host" in second.stderr, second.stderr))
        self.check("SIGHUP", *self.stopped(run, 129, "SIGHUP"), (self.says() == "SIGHUP", self.says()), (self.goes_on(), "does not go on"))

        self.fresh()
        pipe = runs.command(["bash", "-c", "\"$@\" | head -1; exit ${PIPESTATUS[0]}", "-", *self.command()])
        self.check("closed pipe", (pipe.status == 0, f"status {pipe.status}"), (self.says() == "end", self.says()))

        self.fresh()
        done = self.run(before=["prlimit", "--fsize=20000"])
        self.check("file size limited", (done.status == 4, f"status {done.status}"), ("File too large" in done.stderr, done.stderr[-300:]),
                   (series_is_whole(self.out), "series"), (self.goes_on(), "does not go on"))

        self.fresh()
        run = runs.start(["prlimit", "--cpu=1:30", *self.command("--quiet", short=False)], stderr=runs.PIPE)
        self.check("processor time limited", *self.stopped(run, 152, "SIGXCPU"), (self.goes_on(), "does not go on"))

        self.fresh()
        (self.out / "poiseuille.checkpoint" / "in the way").mkdir(parents=True)
        done = self.run()
        self.check("no place for the checkpoint", (done.status == 4, f"status {done.status}"), ("poiseuille.checkpoint" in done.stderr, done.stderr[-300:]),
                   (series_is_whole(self.out), "series"))

    def ranks(self):
        full, slowest = self.full_disks_of_ranks()
        shutil.rmtree(self.top)
        print(json.dumps({"disks": len(self.passed), "disks_full": full, "disks_good": sum(self.passed), "slowest": slowest}))
        return 1 if self.failures else 0

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
    parser.add_argument("--ranks-only", action="store_true", help="the full disks of three ranks, and nothing else")
    options = parser.parse_args()
    faults = Faults(options.program, options.sizes)
    sys.exit(faults.ranks() if options.ranks_only else faults.main())
