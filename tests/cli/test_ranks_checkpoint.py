#!/usr/bin/python3
"""Checkpoints in pieces, one by each rank: together they are the file of one process, any number of ranks goes on from them, and damage is told.

    test_ranks_checkpoint.py PROGRAM SOURCE_DIR
"""

import shutil
import subprocess
import sys
import unittest

from test_ranks import MPIRUN, PERIODIC, PROGRAM, Folder, alone, checkpoints, content, has_mpi

TEXT = PERIODIC.format(scheme="consistent", precision="")
HALF = ("--set", "time.end=0.03")


@unittest.skipUnless(has_mpi(), "no MPI here")
class Checkpoints(Folder):
    def pieces(self, out, name="scene.checkpoint"):
        return checkpoints.pieces(self.at / out / name)

    def refused(self, out, *words, ranks=2, status=2):
        ended = self.start(ranks, TEXT, out, "--restart", "latest")
        self.assertEqual(ended.returncode, status, ended.stderr)
        for word in words:
            self.assertEqual(ended.stderr.count(word), 1, f"{word!r} in: {ended.stderr}")
        return ended.stderr

    def test_any_number_of_ranks_goes_on(self):
        self.run_on(0, TEXT, "one")
        for before, after in ((0, 3), (3, 0), (3, 2), (2, 4)):
            out = f"{before}-{after}"
            self.run_on(before, TEXT, out, *HALF)
            self.assertEqual(len(self.pieces(out)), before)
            self.run_on(after, TEXT, out, "--restart", "latest")
            self.assertEqual(len(self.pieces(out)), after)
            for name in ("scene_000002.vtp", "scene.checkpoint"):
                self.assertEqual(content(self.at / "one" / name), content(self.at / out / name), f"{name} of {out}")
            # The one before is of the other ranks, and has its pieces still: it is a checkpoint as good as any.
            self.assertEqual(len(self.pieces(out, "scene.checkpoint.older")), before)
            (self.at / out / "scene.checkpoint").unlink()
            ended = self.start(after, TEXT, out, "--restart", "latest")
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.assertEqual(content(self.at / "one" / "scene.checkpoint"), content(self.at / out / "scene.checkpoint"), out)
        self.run_on(0, TEXT, "2-4")  # a new run leaves nothing of the one before
        self.assertFalse((self.at / "2-4/scene_checkpoint").exists())

    def test_damage_is_told_and_the_older_one_taken(self):
        self.run_on(3, TEXT, "other", *HALF)
        self.run_on(3, TEXT, "good", *HALF)
        names = [piece.relative_to(self.at / "good") for piece in self.pieces("good")]
        damaged = self.at / "damaged"

        def fresh(change):
            shutil.rmtree(damaged, ignore_errors=True)
            shutil.copytree(self.at / "good", damaged)
            change(damaged / names[1])

        def change_a_byte(file):
            with open(file, "r+b") as f:
                f.seek(-1000, 2)
                byte = f.read(1)
                f.seek(-1, 1)
                f.write(bytes([byte[0] ^ 4]))

        cases = (("is not there", lambda piece: piece.unlink()),
                 ("is damaged: its checksum is wrong", change_a_byte),
                 ("is damaged: it holds", lambda piece: piece.write_bytes(piece.read_bytes()[:-8])),
                 ("is damaged: it is cut off in its head", lambda piece: piece.write_bytes(b"")),
                 ("is no piece of a checkpoint", lambda piece: piece.write_bytes(b"x" * 4000)),
                 ("is of another checkpoint", lambda piece: shutil.copy(self.at / "other" / names[1], piece)),
                 ("is of another checkpoint", lambda piece: shutil.copy(self.at / "good" / names[2], piece)))
        for words, change in cases:
            fresh(change)
            for ranks in (2, 0):
                told = self.refused("damaged", f"its piece 'damaged/{names[1]}' {words}", ranks=ranks)
                self.assertNotIn("going on", told)
        fresh(lambda piece: change_a_byte(damaged / "scene.checkpoint"))
        self.refused("damaged", "damaged/scene.checkpoint: is damaged: its checksum is wrong")

        self.run_on(2, TEXT, "good", "--restart", "latest")
        self.run_on(0, TEXT, "one")
        self.pieces("good")[0].unlink()
        told = self.refused("good", "is not there", "going on from the one before it", ranks=3, status=0)
        self.assertIn("--restart good/scene.checkpoint", told)
        self.assertEqual(content(self.at / "one" / "scene.checkpoint"), content(self.at / "good" / "scene.checkpoint"))

    def test_a_full_disk_of_one_rank(self):
        self.run_on(2, TEXT, "full", *HALF)
        before = content(self.at / "full/scene.checkpoint")
        (self.at / "scene.toml").write_text(TEXT)
        program = [PROGRAM, "run", "scene.toml", "--quiet", "--threads", "1", "--out", "full", "--restart", "latest"]
        limited = ["bash", "-c", 'ulimit -f 50; exec "$@"', "-", *program]  # the last rank writes nothing but its piece
        ended = subprocess.run([*MPIRUN, "1", *program, ":", "-n", "1", *limited], cwd=self.at, env=alone(), capture_output=True, text=True, timeout=300)
        self.assertEqual(ended.returncode, 4, ended.stderr)
        self.assertEqual(ended.stderr.count("cannot write 'full/scene_checkpoint/"), 1, ended.stderr)
        self.assertIn("File too large", ended.stderr)
        self.assertEqual(content(self.at / "full/scene.checkpoint"), before)
        self.assertEqual(set((self.at / "full/scene_checkpoint").iterdir()), set(self.pieces("full")))
        self.run_on(3, TEXT, "full", "--restart", "latest")
        self.run_on(0, TEXT, "one")
        self.assertEqual(content(self.at / "one/scene.checkpoint"), content(self.at / "full/scene.checkpoint"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
