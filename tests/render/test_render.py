"""Every state of pvstate/ renders off-screen, and the picture shows what it should.

    test_render.py PROGRAM SOURCE_DIR

Runs short scenes with PROGRAM, then renders their last frame with each state through pvstate/render. A picture must not be
blank, must show the sand and the air where they are expected, and must not show a phase that was hidden.
"""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib
import matplotlib.image
import numpy as np

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()


def run(scene, out, end):
    """The command that makes a short series of a scene."""
    return [PROGRAM, "run", SOURCE / "scenes" / f"{scene}.toml", "--out", out, "--quiet", "--set", f"time.end={end}"]


WIND, IMPACT = "dune", "impact_cubes"            # the scenes: air over sand; two bodies, one fast and one at rest


SAND = np.array([0.86, 0.66, 0.34])        # as in pvstate/barchan_view.py
VIRIDIS = matplotlib.colormaps["viridis"](np.linspace(0, 1, 64))[:, :3]


def share(picture, colours, within=0.06):
    """Share of the pixels whose colour is one of these, to `within` in the largest of r, g, b."""
    pixels = picture.reshape(-1, 3)
    near = np.zeros(len(pixels), dtype=bool)
    for colour in np.atleast_2d(colours):
        near |= np.abs(pixels - colour).max(axis=1) < within
    return near.mean()


class Rendering(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.out = Path(cls.folder.name)
        cls.command(run(WIND, cls.out / WIND, 2e-4))
        cls.dune = cls.out / WIND / f"{WIND}.pvd"

    @staticmethod
    def command(words):
        result = subprocess.run([str(word) for word in words], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        if result.returncode:
            raise AssertionError(f"{' '.join(map(str, words))} ended with {result.returncode}\n{result.stdout}{result.stderr}")
        return result.stdout

    def render(self, series, states, *options):
        """Pictures of the last frame by state, as arrays of r, g, b from 0 to 1."""
        target = Path(tempfile.mkdtemp(dir=self.out))
        self.command([SOURCE / "pvstate/render", series, "--state", ",".join(states), "--frames", "last", "--size", "800x",
                      "--out", target, *options])
        pictures = {}
        for state in states:
            files = list(target.glob(f"{state}_*.png"))
            self.assertEqual(len(files), 1, f"{state}: one picture of one frame")
            pictures[state] = matplotlib.image.imread(files[0])[:, :, :3]
            self.assertEqual(pictures[state].shape[1], 800, state)
            self.assertGreater(pictures[state].std(), 0.05, f"{state}: the picture is blank")
        return pictures

    def test_states_of_wind_over_sand(self):
        pictures = self.render(self.dune, ["airflow", "sand_takeoff", "smoothing_length"])

        airflow = pictures["airflow"]
        height, width = airflow.shape[:2]
        data = airflow[int(0.12 * height):int(0.70 * height), int(0.12 * width):int(0.96 * width)]   # inside the axes
        self.assertGreater(share(data, SAND), 0.05, "airflow: the sand is missing")
        self.assertGreater(share(data, VIRIDIS), 0.40, "airflow: the air is missing")
        # The sand lies below.
        half = len(data) // 2
        self.assertGreater(share(data[half:], SAND), 5 * share(data[:half], SAND), "airflow: the sand is not below")

        self.assertGreater(share(pictures["sand_takeoff"], SAND), 0.03, "sand_takeoff: the sand is missing")
        self.assertGreater(share(pictures["sand_takeoff"], [0.80, 0.87, 0.93], 0.05), 0.005, "sand_takeoff: the air is missing")

        ends = VIRIDIS[[0, -1]]
        for end, phase in zip(ends, ("sand", "air")):
            self.assertGreater(share(pictures["smoothing_length"], end), 0.03, f"smoothing_length: the {phase} is missing")

    def test_a_hidden_phase_is_not_shown(self):
        shown = self.render(self.dune, ["airflow"], "--hide", "sand")["airflow"]
        self.assertLess(share(shown, SAND, 0.03), 0.003, "the sand was hidden, yet there it is")
        shown = self.render(self.dune, ["airflow"], "--hide", "air")["airflow"]
        self.assertLess(share(shown, VIRIDIS), 0.02, "the air was hidden, yet there it is")
        self.assertGreater(share(shown, SAND), 0.03)

    def test_impact(self):
        self.command(run(IMPACT, self.out / IMPACT, 1e-7))
        picture = self.render(self.out / IMPACT / f"{IMPACT}.pvd", ["impact"])["impact"]
        fast, slow = picture[..., 0] - picture[..., 2] > 0.15, picture[..., 2] - picture[..., 0] > 0.15
        for name, body in (("fast", fast), ("slow", slow)):
            self.assertGreater(body.mean(), 0.03, f"the {name} body is missing")

    def test_wrong_commands_say_what_is_wrong(self):
        for words, expected in ((["nowhere.pvd"], "nowhere.pvd"), ([self.dune, "--state", "sunset"], "airflow"),
                                ([self.dune, "--frames", "100000"], "frames 0 to"), ([self.dune, "--size", "big"], "1600x900")):
            result = subprocess.run([SOURCE / "pvstate/render", *words], capture_output=True, text=True)
            self.assertEqual(result.returncode, 2, words)
            self.assertIn(expected, result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
