"""Every state of pvstate/ renders off-screen, and the picture shows what it should.

    test_render.py PROGRAM SOURCE_DIR

Runs short scenes with PROGRAM, then renders their last frame with each state through pvstate/render. A picture must not be
blank, must show the sand and the air where they are expected, and must not show a phase that was hidden. Single particles that
went astray, coarse scenes and wrong commands have tests of their own.
"""
import base64
import io
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib
import matplotlib.image
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLPolyDataWriter

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()

# Water that flows to the right at 1 m/s and up and down: spacing 0.1 m, so that arrows lie 1.2 m above the plane of the scene.
COARSE_TANK = """
spacing = 0.1
domain = { size = [6.0, 2.0], periodic = ["x"] }
phases.pond_water = { kind = "fluid", density = 1000, viscosity = 0.1, sound-speed = 10 }
phases.walls = { kind = "wall" }
interactions = { pond_water-pond_water = 2.6, pond_water-walls = 2.6 }
fill = [{ phase = "walls", shape = { sides = ["bottom", "top"] } },
        { phase = "pond_water", shape = "the-rest", velocity = ["1 + 0*x", "0.3*sin(x)"] }]
time.end = 0.01
output.format = "vtu"
"""

# Two discs between walls, one of them on its way to the other along the diagonal.
DISCS = """
spacing = 1e-3
domain.size = [0.04, 0.03]
phases.a = { kind = "elastic", density = 7870, young = 206e9, poisson = 0.3 }
phases.b = { kind = "elastic", density = 7870, young = 206e9, poisson = 0.3 }
phases.box = { kind = "wall" }
interactions = { a-a = 2.4, b-b = 2.4, a-b = 1.1, a-box = 1.2, b-box = 1.2 }
fill = [{ phase = "box", shape = { sides = ["bottom", "top", "left", "right"] } },
        { phase = "a", shape = { disc = { centre = [0.010, 0.010], radius = 0.005 } }, velocity = [10, 10] },
        { phase = "b", shape = { disc = { centre = [0.020, 0.020], radius = 0.005 } } }]
time = { end = 1e-6, largest-speed = 15 }
"""


def run(scene, out, end):
    """The command that makes a short series of a scene of the paper."""
    return [PROGRAM, "run", SOURCE / "scenes/paper" / f"{scene}.toml", "--out", out, "--quiet", "--set", f"time.end={end}"]


def changed_series(series, out, change):
    """A copy of a series whose frames went through change(data, velocity, points)."""
    out.mkdir()
    for file in sorted(series.parent.glob("*.vtp")):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(file))
        reader.Update()
        data = reader.GetOutput()
        change(data, vtk_to_numpy(data.GetPointData().GetArray("velocity")), vtk_to_numpy(data.GetPoints().GetData()))
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(out / file.name))
        writer.SetDataModeToBinary()   # ParaView 5.11 loses itself in some files with raw data behind the XML
        writer.SetInputData(data)
        writer.Write()
    for name in (series.name, "run.json"):
        shutil.copy(series.parent / name, out / name)
    return out / series.name


def of_phase(data, name):
    """Which particles belong to a phase, by its name."""
    names = data.GetFieldData().GetAbstractArray("phase_names")
    number = [names.GetValue(k) for k in range(names.GetNumberOfValues())].index(name)
    return np.flatnonzero(vtk_to_numpy(data.GetPointData().GetArray("phase")) == number)


WIND, IMPACT = "dune", "impact_cubes"            # the scenes: air over sand; two bodies, one fast and one at rest


SAND = np.array([0.86, 0.66, 0.34])        # as in pvstate/barchan_marks.py
WALL, INK, MARK = (0.38, 0.38, 0.40), (0.13, 0.13, 0.15), (0.835, 0.369, 0.0)
WHITE = (1.0, 1.0, 1.0)
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
            files = list(target.glob(f"{Path(state).stem}_*.png"))
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

    def test_the_state_of_the_page(self):
        page = (SOURCE / "docs/seeing.md").read_text()
        state = self.out / "pressure.py"
        state.write_text(page.split("```python\n")[1].split("```")[0])
        picture = self.render(self.dune, [str(state)])[str(state)]
        height, width = picture.shape[:2]
        colours = matplotlib.colormaps["coolwarm"](np.linspace(0, 1, 64))[:, :3]
        self.assertGreater(share(picture[int(0.15 * height):int(0.5 * height), int(0.12 * width):int(0.96 * width)], colours), 0.5)

    def test_a_hidden_phase_is_not_shown(self):
        shown = self.render(self.dune, ["airflow"], "--hide", "sand")["airflow"]
        self.assertLess(share(shown, SAND, 0.03), 0.003, "the sand was hidden, yet there it is")
        shown = self.render(self.dune, ["airflow"], "--hide", "air")["airflow"]
        self.assertLess(share(shown, VIRIDIS), 0.02, "the air was hidden, yet there it is")
        self.assertGreater(share(shown, SAND), 0.03)

    def scene(self, name, text):
        """The series of a scene that is given as text."""
        file = self.out / f"{name}.toml"
        file.write_text(text)
        self.command([PROGRAM, "run", file, "--out", self.out / name, "--quiet", "--threads", "1"])
        return self.out / name / f"{name}.pvd"

    def test_impact(self):
        self.command(run(IMPACT, self.out / IMPACT, 1e-7))
        picture = self.render(self.out / IMPACT / f"{IMPACT}.pvd", ["impact"])["impact"]
        body = picture[:, :int(0.84 * picture.shape[1])]   # without the colour bar
        self.assertGreater((body[..., 0] - body[..., 2] > 0.15).mean(), 0.03, "the fast body, in red, is missing")
        grey = (np.ptp(body, axis=2) < 0.03) & (body.max(axis=2) > 0.3) & (body.max(axis=2) < 0.98)
        self.assertGreater(grey.mean(), 0.03, "the body at rest, in white with its shade, is missing")

    def test_impact_along_a_diagonal_between_walls(self):
        picture = self.render(self.scene("discs", DISCS), ["impact"])["impact"]
        self.assertGreater(share(picture, WALL), 0.10, "the walls are missing")
        self.assertGreater(share(picture, [0.75, 0.21, 0.20], 0.12), 0.02, "the moving disc is missing")
        self.assertGreater(share(picture, [0.97, 0.97, 0.97], 0.01), 0.02, "the disc at rest is missing")

    def test_a_wall_in_which_grains_stand_is_not_drawn(self):
        """It is one of another phase: the ground of the air under sand. The floor of this series, moved onto the sand, becomes such a wall."""
        def onto_sand(data, _, points):
            floor, sand = of_phase(data, "floor"), of_phase(data, "sand")
            points[floor] = points[np.resize(sand, len(floor))]

        ground = (0.55, 0.42, 0.25)
        as_it_is, moved = (self.render(series, ["airflow"], "--hide", "sand,lid")["airflow"]
                           for series in (self.dune, changed_series(self.dune, self.out / "onto_sand", onto_sand)))
        self.assertGreater(share(as_it_is, ground), 0.01, "the floor is missing")
        self.assertLess(share(moved, ground), 0.001, "a wall of another phase lies over the sand")

    def test_arrows_of_a_coarse_scene(self):
        series = self.scene("tank", COARSE_TANK)
        picture = self.render(series, ["airflow"])["airflow"]
        height, width = picture.shape[:2]
        water = picture[int(0.25 * height):int(0.60 * height), int(0.12 * width):int(0.95 * width)]
        self.assertGreater(share(water, VIRIDIS), 0.80, "the water is missing")
        self.assertGreater(share(water, WHITE, 0.02), 0.01, "the arrows are missing")
        right = picture[int(0.88 * height):, int(0.70 * width):int(0.95 * width)]
        self.assertGreater(share(right, INK, 0.1), 0.005, "the scale of the arrows is missing")

        # One frame of the series, a .vtu here, gives the same picture but for its title.
        frame = self.render(sorted(series.parent.glob("*.vtu"))[-1], ["airflow"])["airflow"]
        self.assertLess(np.abs(frame - picture)[int(0.1 * height):].mean(), 1e-4)

    def test_a_run_that_broke_down_is_seen_in_its_domain(self):
        good = self.render(self.scene("calm", COARSE_TANK), ["airflow"])["airflow"]
        file, out = self.out / "wild.toml", self.out / "wild"
        file.write_text(COARSE_TANK.replace("time.end = 0.01", "time = { end = 20, step = 0.03 }"))   # five times the limit
        result = subprocess.run([PROGRAM, "run", file, "--out", out, "--quiet", "--threads", "1"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 3, result.stderr)
        for series in (out / "wild.pvd", *out.glob("wild_bad.vt?")):
            picture = self.render(series, ["airflow"])["airflow"]
            self.assertEqual(picture.shape, good.shape)
            walls = np.abs(good - WALL).max(axis=2) < 0.06
            self.assertGreater((np.abs(picture - WALL).max(axis=2) < 0.06)[walls].mean(), 0.8, f"{series}: another view")

    def test_figures_for_a_paper(self):
        """Text is text, the data are a picture of 300 dots an inch, and nothing of what ParaView writes around it is left."""
        target = self.out / "paper"
        self.command([SOURCE / "pvstate/render", self.dune, "--state", "airflow", "--frames", "last", "--format", "svg,pdf", "--width", "80", "--out", target])
        drawing = next(target.glob("airflow_*.svg")).read_text()
        self.assertEqual(len(list(target.iterdir())), 2)
        self.assertEqual(next(target.glob("airflow_*.pdf")).read_bytes()[:5], b"%PDF-")
        for words in ("x (mm)", "y (mm)", "speed of air", " m/s", "t = "):
            self.assertIn(words, drawing)
        whole = re.search(r'<svg [^>]*width="([0-9.]+)pt"', drawing)
        self.assertAlmostEqual(float(whole[1]), 80 / 25.4 * 72, delta=0.1)
        picture = max(re.findall(r'xlink:href="data:image/png;base64,\s*([^"]+)"', drawing), key=len)
        data = matplotlib.image.imread(io.BytesIO(base64.b64decode(picture)))[:, :, :3]
        self.assertAlmostEqual(data.shape[1], (80 - 14) / 25.4 * 300, delta=2)
        self.assertGreater(share(data, VIRIDIS), 0.40, "the air is missing")
        self.assertGreater(share(data, SAND), 0.05, "the sand is missing")
        self.assertLess(share(data, INK), 1e-3, "letters or axes of ParaView are in the picture")

    def test_a_single_frame(self):
        frame = sorted(self.dune.parent.glob("*.vtp"))[-1]
        of_series, of_frame = (self.render(file, ["airflow"])["airflow"] for file in (self.dune, frame))
        self.assertLess(np.abs(of_series - of_frame)[int(0.1 * len(of_series)):].mean(), 0.01)

    def test_one_particle_astray_changes_neither_view_nor_colours(self):
        def fling(data, velocity, points):
            for phase in ("air", "sand"):
                far, fast = of_phase(data, phase)[[100, 200]]
                points[far, :2], velocity[far, :2] = (1000.0, 300.0), (1e6, 1e6)
                velocity[fast, 0] = 1e6
            lost = of_phase(data, "air")[300]
            points[lost], velocity[lost] = np.nan, np.nan

        def without_bounds(data, *_):
            data.GetFieldData().RemoveArray("domain")

        states = ["airflow", "sand_takeoff", "smoothing_length"]
        unbounded = changed_series(self.dune, self.out / "unbounded", without_bounds)
        for series, name, states in ((self.dune, "flung", states), (unbounded, "unbounded_flung", states[:1])):
            expected = self.render(series, states)
            found = self.render(changed_series(series, self.out / name, fling), states)
            for state in states:
                self.assertEqual(found[state].shape, expected[state].shape, f"{name}, {state}: another view")
                different = (np.abs(found[state] - expected[state]).max(axis=2) > 0.1).mean()
                self.assertLess(different, 0.01, f"{name}, {state}: another view or other colours")

    def test_arrows_stay_off_the_numbers_of_the_axes(self):
        """Grains at the left edge that fly to the left, against the same grains at rest."""
        def still(_, velocity, __):
            velocity[:] = 0.0

        def fly(data, velocity, points):
            velocity[:] = 0.0
            sand = of_phase(data, "sand")
            velocity[sand[points[sand, 0] < 0.012], 0] = -5.0

        window = ["--window", "0.005,0.035,0.001,0.015"]
        before, after = (self.render(changed_series(self.dune, self.out / name, change), ["sand_takeoff"], *window)
                         ["sand_takeoff"] for name, change in (("still", still), ("flying", fly)))
        height, width = before.shape[:2]
        rows = slice(int(0.1 * height), int(0.7 * height))
        inside = slice(int(0.10 * width), int(0.5 * width))
        self.assertGreater(share(after[rows, inside], INK, 0.1), share(before[rows, inside], INK, 0.1) + 0.005, "no arrows")
        beside = slice(0, int(0.075 * width))
        self.assertLess(np.abs(before[rows, beside] - after[rows, beside]).mean(), 1e-3, "an arrow crosses the axis")

    def test_kernels_lie_within_the_plot(self):
        """In the second window the air is a strip at the top that is lower than its kernel; that kernel is not drawn."""
        for window in ([], ["--window", "0.0465,0.0535,0.0047,0.0077"]):
            picture = self.render(self.dune, ["smoothing_length"], *window)["smoothing_length"]
            rows, columns = np.nonzero(np.abs(picture - MARK).max(axis=2) < 0.12)
            self.assertGreater(len(rows), 100, "the kernels are missing")
            left, right, bottom, top = 82, 25, 106, 50   # margins of a wide picture of 800 pixels
            height, width = picture.shape[:2]
            self.assertTrue(rows.min() >= top - 1 and rows.max() <= height - bottom + 1 and columns.min() >= left - 1
                            and columns.max() <= width - right + 1, f"{window}: a kernel leaves the plot")

    def test_wrong_commands_say_what_is_wrong(self):
        text = self.out / "notes.txt"
        text.write_text("no series")
        frame = sorted(self.dune.parent.glob("*.vtp"))[-1]
        for words, expected in ((["nowhere.pvd"], "nowhere.pvd"), ([text], ".pvd"), ([self.dune, "--state", "sunset"], "airflow"),
                                ([self.dune, "--frames", "100000"], "frames 0 to"), ([self.dune, "--size", "big"], "1600x900"),
                                ([frame, "--film"], "single frame"), ([self.dune, "--format", "gif"], "pdf and svg"),
                                ([self.dune, "--format", "pdf", "--film"], "--format png"), ([self.dune, "--format", "pdf", "--width", "5"], "40 to 400"),
                                ([self.dune, "--window", "0,1"], "X0,X1,Y0,Y1"), ([self.dune, "--window", "a,b,c,d"], "X0,X1,Y0,Y1"),
                                ([self.dune, "--window", "1,0,0,1"], "X0 < X1"), ([self.dune, "--window", "0,nan,0,1"], "X0,X1"),
                                ([self.dune, "--window", "5,6,5,6"], "shows nothing"), ([self.dune, "--hide", "snow"], "no phase 'snow'")):
            result = subprocess.run([SOURCE / "pvstate/render", *words], capture_output=True, text=True)
            self.assertEqual(result.returncode, 2, words)
            self.assertIn(expected, result.stderr)
            self.assertNotIn("Traceback", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
