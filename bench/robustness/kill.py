#!/usr/bin/python3
"""Runs that are killed (SIGKILL) at random moments, opened, and continued to their end.

    kill.py PROGRAM [--moments 200] [--seed 1] [--threads 1]

A scene with probes, profiles, a grid and wall shear writes a frame every few steps and a checkpoint after every step.
It is killed at a random moment; then its series must open in VTK and list exactly the whole frames, and run.json must say
"running" (or "end", when it had ended). The run goes on, is killed again or not, and all its files but run.json must
have the bytes of a run that was left alone. Prints a line for each failure and the figures as JSON; status 1 on failures.
"""
import argparse
import json
import pathlib
import random
import shutil
import signal
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import frame, run as runs  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENE = SOURCE / "scenes/verification/poiseuille.toml"
SHORT = ["time.end=0.06", "output.every=0.004", "output.history-every=0.002", "output.checkpoint-every=1e-9"]


def files(folder):
    left_out = ("run.json", "barchan.lock")
    return {f.name: f.read_bytes() for f in folder.iterdir() if f.name not in left_out and ".checkpoint" not in f.name
            and not f.name.endswith(".part")}


def opens(pvd):
    """Times of the frames that the .pvd lists, each read by VTK."""
    times = []
    for time_of_list, file in frame.series(pvd):
        data = frame.Frame(file)
        assert len(data.x) > 0, "a listed frame is empty"
        times.append(data.time)
        assert times[-1] == time_of_list, "a frame has another time than the list"
    return times


def frames_on_disk(folder):
    return len([f for f in folder.glob("poiseuille_0*.vtp")])


class Killer:
    def __init__(self, options):
        self.options = options
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="barchan_kill_"))
        self.failures = []
        self.figures = dict(moments=0, killed=0, before_first_checkpoint=0, continued=0, bitwise_equal=0)

    def command(self, out, *more):
        return runs.words(self.options.program, SCENE, out, SHORT, threads=self.options.threads, options=more)

    def check(self, good, what):
        if not good:
            self.failures.append(what)
            print("FAILED:", what, flush=True)

    def one(self, number, seconds, whole):
        out = self.top / f"run{number}"
        run = runs.start(self.command(out), stderr=runs.DEVNULL)
        time.sleep(seconds)
        run.send_signal(signal.SIGKILL)
        killed = run.wait() == -signal.SIGKILL
        pvd = out / "poiseuille.pvd"
        if not pvd.exists():
            shutil.rmtree(out, ignore_errors=True)
            self.figures["killed"] += killed
            self.figures["before_first_checkpoint"] += 1
            return
        says = json.loads((out / "run.json").read_text())["end_reason"]
        killed = killed and says != "end"  # it had written all and was about to exit: its files are compared as those of one that ended
        self.figures["killed"] += killed
        try:
            listed = len(opens(pvd))
            # A frame gets its name before the list names it: one may stand there that the list does not have yet.
            self.check(listed <= frames_on_disk(out) <= listed + 1, f"{number}: {listed} frames listed, {frames_on_disk(out)} on disk")
        except (AssertionError, frame.Unreadable) as error:
            self.check(False, f"{number}: the series does not open: {error}")
        self.check(says == ("running" if killed else "end"), f"{number}: run.json says {says}")
        if not (out / "poiseuille.checkpoint").exists():
            self.figures["before_first_checkpoint"] += 1
            shutil.rmtree(out)
            return
        again = runs.command(self.command(out, "--restart", "latest"))
        ended = again.status == 2 and "larger time.end" in again.stderr  # its last checkpoint was that of the end
        self.check(again.status == 0 or ended, f"{number}: restart ended with {again.status}: {again.stderr[:300]}")
        self.figures["continued"] += again.status == 0
        if again.status == 0 or not killed:
            mine = files(out)
            different = sorted(name for name in set(mine) | set(whole) if mine.get(name) != whole.get(name))
            self.check(not different, f"{number}: other bytes in {different}")
            self.figures["bitwise_equal"] += not different
        shutil.rmtree(out)

    def main(self):
        reference = self.top / "whole"
        seconds = runs.command(self.command(reference), check=True).wall
        whole = files(reference)
        moment = random.Random(self.options.seed)
        for number in range(self.options.moments):
            self.one(number, moment.uniform(0.05, seconds), whole)
            self.figures["moments"] += 1
        shutil.rmtree(self.top)
        print(json.dumps({**self.figures, "failures": len(self.failures)}))
        return 1 if self.failures else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--moments", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    sys.exit(Killer(parser.parse_args()).main())
