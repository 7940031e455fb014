#!/usr/bin/python3
"""Damaged checkpoints and frames: truncated, a bit flipped, the head edited, of another version, of another scene.

    damage.py PROGRAM [--files 2000] [--seed 1]

Half of the files are checkpoints, which `run --restart FILE` must refuse with status 2; half are frames, which `compare`
with the whole one must refuse with status 4, or tell apart with status 1. Status 0 is right only where VTK reads the same
arrays from the damaged file: the damage then hit no data (an array's RangeMin, for example). No file may take longer than
a second or end the program by a signal. Prints a line for each failure and the figures as JSON; status 1 on failures.
"""
import argparse
import collections
import json
import pathlib
import random
import re
import shutil
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from barchan_bench import frame, run  # noqa: E402

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENE = SOURCE / "scenes/verification/taylor_green.toml"
SMALL = ["time.end=0.02", "output.every=0.02"]
LIMIT = 1.0  # s


def arrays(file):
    """What the package of python/ reads of a frame, as bytes; None when it reads nothing."""
    try:
        read = frame.Frame(file)
    except frame.Unreadable:
        return None
    return {name: values.tobytes() for name, values in {**read.arrays, "points": read.x}.items()}


def damage(content, kind, chance):
    """The bytes of a file, damaged; and what was done."""
    at = chance.randrange(len(content))
    if kind == "truncated":
        return content[:at]
    if kind == "bit":
        changed = bytearray(content)
        changed[at] ^= 1 << chance.randrange(8)
        return bytes(changed)
    if kind == "bytes":
        changed = bytearray(content)
        for k in range(at, min(at + chance.randrange(1, 64), len(changed))):
            changed[k] = chance.randrange(256)
        return bytes(changed)
    # head: a number of the text before the data, or one of the first bytes of a checkpoint
    end = content.find(b"<AppendedData")
    if end < 0:
        changed = bytearray(content)
        changed[chance.randrange(37)] = chance.randrange(256)
        return bytes(changed)
    numbers = list(re.finditer(rb'"(\d+) *"', content[:end]))
    hit = chance.choice(numbers)
    new = chance.choice([b"0", b"1", b"-1", b"3", b"4294967296", b"9223372036854775807", b"99999999999999999999", b"", b"x", b"1e9"])
    return content[:hit.start(1)] + new + content[hit.end(1):]


class Damager:
    def __init__(self, options):
        self.options = options
        self.top = pathlib.Path(tempfile.mkdtemp(prefix="barchan_damage_"))
        self.count = collections.Counter()
        self.longest = 0.0
        self.failures = []

    def check(self, good, what):
        if not good:
            self.failures.append(what)
            print("FAILED:", what, flush=True)

    def ask(self, *arguments):
        done = run.command([self.options.program, *arguments], timeout=20)
        self.longest = max(self.longest, done.wall)
        return -99 if done.status is None else done.status, done.wall

    def checkpoint(self, number, whole, chance):
        kind = chance.choice(["truncated", "bit", "bytes", "head"])
        file = self.top / "damaged.checkpoint"
        content = damage(whole, kind, chance)
        if content == whole:
            content = whole[:-1]
        file.write_bytes(content)
        out = self.top / "out"
        status, seconds = self.ask("run", SCENE, *run.settings([*SMALL, "time.end=0.03"]), "--quiet", "--threads", "1", "--out", out, "--restart", file)
        self.count[f"checkpoint: status {status}"] += 1
        self.check(status == 2, f"checkpoint {number} ({kind}): status {status}")
        self.check(seconds < LIMIT, f"checkpoint {number} ({kind}): {seconds:.2f} s")
        self.check(not out.exists(), f"checkpoint {number} ({kind}): something was written")
        shutil.rmtree(out, ignore_errors=True)

    def frame(self, number, file, chance):
        whole = file.read_bytes()
        kind = chance.choice(["truncated", "bit", "bytes", "head"])
        damaged = self.top / ("damaged" + file.suffix)
        damaged.write_bytes(damage(whole, kind, chance))
        status, seconds = self.ask("compare", file, damaged)
        self.count[f"frame: status {status}"] += 1
        self.check(status in (0, 1, 4), f"frame {number} ({kind}): status {status}")
        self.check(seconds < LIMIT, f"frame {number} ({kind}): {seconds:.2f} s")
        if status == 0:
            same = arrays(damaged) == arrays(file)
            self.count["frame: status 0, the same data"] += same
            self.check(same, f"frame {number} ({kind}): accepted in silence")

    def other(self, whole):
        """Checkpoints of another version and of another scene."""
        version = self.top / "version.checkpoint"
        version.write_bytes(whole.replace(b"checkpoint 2", b"checkpoint 1", 1))
        for what, arguments in (("another version", [SCENE, "--restart", version]),
                                ("another scene", [SOURCE / "scenes/verification/cavity.toml", "--restart", self.top / "whole/taylor_green.checkpoint"])):
            status, _ = self.ask("run", *arguments, "--quiet", "--out", self.top / "out")
            self.count[f"checkpoint of {what}: status {status}"] += 1
            self.check(status == 2, f"{what}: status {status}")

    def main(self):
        out = self.top / "whole"
        run.scene(self.options.program, SCENE, out, SMALL)
        frames = [out / "taylor_green_000001.vtp", self.top / "frame.vtu", self.top / "impact.vtp"]
        run.generate(self.options.program, SCENE, frames[1], check=True)
        run.generate(self.options.program, "paper/impact_single", frames[2], check=True)
        checkpoint = (out / "taylor_green.checkpoint").read_bytes()
        chance = random.Random(self.options.seed)
        self.other(checkpoint)
        for number in range(self.options.files // 2):
            self.checkpoint(number, checkpoint, chance)
            self.frame(number, frames[number % len(frames)], chance)
        shutil.rmtree(self.top)
        print(json.dumps({**dict(sorted(self.count.items())), "longest_seconds": round(self.longest, 3), "failures": len(self.failures)}))
        return 1 if self.failures else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--files", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    sys.exit(Damager(parser.parse_args()).main())
