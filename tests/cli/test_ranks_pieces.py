#!/usr/bin/python3
"""Frames in pieces: each rank writes its own, and together they are the frames of one process.

    test_ranks_pieces.py PROGRAM SOURCE_DIR
"""

import subprocess
import sys
import unittest

from test_ranks import PERIODIC, PROGRAM, SOURCE, Folder, channel, content, has_mpi

sys.path.insert(0, str(SOURCE / "python"))
import barchan  # noqa: E402


@unittest.skipUnless(has_mpi(), "no MPI here")
class Pieces(Folder):
    def compare_frames(self, one, other):
        """Two series have the same frames; compare reads pieces and whole files."""
        a, b = (str(self.at / folder / "scene.pvd") for folder in (one, other))
        ended = subprocess.run([PROGRAM, "compare", a, b], capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)

    def test_frames_in_pieces(self):
        """Each rank writes its own; what they are together is the frame of one process, in its order."""
        text = channel("plain")
        self.run_on(0, text, "whole")
        pieces = text + "pieces-from = 0\n"
        self.run_on(1, pieces, "in-one")
        self.run_on(3, pieces, "in-three")
        stems = [file.stem for file in sorted((self.at / "whole").glob("scene_*.vtp"))]
        for ranks, out in ((1, "in-one"), (3, "in-three")):
            self.assertEqual([file.stem for file in sorted((self.at / out).glob("*.pvtp"))], stems)
            for stem in stems:
                self.assertEqual(sorted(f.name for f in (self.at / out / stem).iterdir()), [f"{stem}_{k:04d}.vtp" for k in range(ranks)])
            self.compare_frames("whole", out)
        for name in ("history.csv", "scene.checkpoint"):
            self.assertEqual(content(self.at / "in-one" / name), content(self.at / "in-three" / name))
        self.assertEqual((self.at / "in-one" / "scene.pvd").read_bytes(), (self.at / "in-three" / "scene.pvd").read_bytes())

        one, three = (barchan.Frame(self.at / out / f"{stems[-1]}.pvtp", order="file") for out in ("in-one", "in-three"))
        whole = barchan.Frame(self.at / "whole" / f"{stems[-1]}.vtp", order="file")
        for frame in (one, three):  # the same particles in the same order, and what concerns the frame as a whole
            self.assertEqual((frame.time, frame.step, frame.names, frame.kinds, frame.units, frame.fields),
                             (whole.time, whole.step, whole.names, whole.kinds, whole.units, whole.fields))
            for field in ("id", "phase", "position", "velocity", "density"):
                self.assertEqual(frame[field].tobytes(), whole[field].tobytes(), field)

        # A piece that is gone is named, by compare and by the package.
        piece = self.at / "in-three" / stems[-1] / f"{stems[-1]}_0001.vtp"
        piece.unlink()
        ended = subprocess.run([PROGRAM, "compare", str(self.at / "in-three/scene.pvd"), str(self.at / "whole/scene.pvd")], capture_output=True, text=True)
        self.assertNotEqual(ended.returncode, 0)
        self.assertIn(piece.name, ended.stderr)
        with self.assertRaises(barchan.Unreadable) as caught:
            barchan.Frame(self.at / "in-three" / f"{stems[-1]}.pvtp")
        self.assertIn(piece.name, str(caught.exception))
        ended = self.start(2, pieces, "in-three", "--restart", "latest", "--set", "time.end=1e3")
        self.assertEqual(ended.returncode, 2)
        self.assertIn(piece.name, ended.stderr)

    def test_a_run_in_pieces_goes_on_on_another_number_of_ranks(self):
        text = PERIODIC.format(scheme="plain", precision="") + "pieces-from = 0\n"
        self.run_on(0, text, "whole")
        self.run_on(3, text.replace("end = 0.06", "end = 0.03"), "part")
        self.run_on(2, text, "part", "--restart", "latest")
        self.compare_frames("whole", "part")
        counts = [len(list(folder.iterdir())) for folder in sorted((self.at / "part").glob("scene_0*")) if folder.is_dir()]
        self.assertEqual((counts[0], counts[-1]), (3, 2))
        self.run_on(0, text.replace("pieces-from = 0\n", ""), "part")  # a new run removes the lists and the pieces of the old one
        self.run_on(0, text.replace("pieces-from = 0\n", ""), "plain")
        self.same("part", "plain")

    def test_a_breakdown_in_pieces(self):
        text = PERIODIC.format(scheme="plain", precision="").replace("end = 0.06", "step = 0.02\nend = 0.4")
        self.assertEqual(self.start(0, text, "whole").returncode, 3)
        ended = self.start(3, text + "pieces-from = 0\n", "pieces")
        self.assertEqual(ended.returncode, 3, ended.stderr)
        self.assertIn("scene_bad.pvtp", ended.stderr)
        compared = subprocess.run([PROGRAM, "compare", str(self.at / "whole/scene_bad.vtp"), str(self.at / "pieces/scene_bad.pvtp")], capture_output=True, text=True)
        self.assertEqual(compared.returncode, 0, compared.stdout + compared.stderr)
        self.compare_frames("whole", "pieces")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
