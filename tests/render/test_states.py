"""The states for fields, instruments and three dimensions, the live one, and pictures beside golden ones.

    test_states.py PROGRAM SOURCE_DIR [--write]

One start of ParaView renders all pictures. They are compared with tests/render/golden/*.png by the means of blocks of pixels, so that other versions of Mesa
and other fonts may differ in edges and letters, but not in what is shown where and in which colour. --write makes the golden pictures anew: look at them.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
import numpy as np

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
GOLDEN = SOURCE / "tests/render/golden"
BLOCKS = (24, 40)          # of a picture: rows, columns
MEAN, WORST = 0.012, 0.2   # largest mean difference of blocks, and of one block, of colours from 0 to 1

# Name of the run: scene in scenes/verification, what is set.
RUNS = {
    "poiseuille": ("poiseuille", ["time.end=0.1", "output.every=0.05", *(f"{name}.start=0" for name in ("profile.0", "profile.1", "grid.0", "wall-shear.0", "wall-shear.1"))]),
    "layer": ("logarithmic_layer", ["time.end=0.02", "output.every=0.01"]),
    "bars": ("two_bars", ["time.end=8e-6", "output.every=4e-6"]),
    "sphere": ("rolling_sphere", ["time.end=0.1", "output.every=0.05", "spacing=0.01"]),
    "hop": ("hop", ["time.end=0.06", "output.every=2e-3"]),
    "hill": ("rushil", ["time.end=1e-3", "output.every=1e-3", "output.walls=true"]),
    "column": ("two_phase_column", ["time.end=2e-3", "output.every=1e-3"]),
    "influx": ("sand_influx", ["time.end=0.02", "output.every=0.01", 'output.fields=["radius"]',
                               'saltation=[{ name = "sand", phase = "sand", every = 1e-3 }]']),
}
# A state, the run, and whether a golden picture stands beside it.
PICTURES = [("airflow", "hill", True), ("pressure", "column", True), ("density", "column", False), ("stress", "bars", True), ("von_mises", "bars", False), ("motion", "sphere", False),
            ("eddy_viscosity", "layer", True), ("profiles", "poiseuille", False), ("grid", "poiseuille", False), ("wall_shear", "poiseuille", False),
            ("flux", "influx", False), ("grains", "influx", False), ("sizes", "influx", False), ("phases", "column", True), ("trajectories", "hop", True), ("box3d", "sphere", True)]
STATES = {path.stem for path in (SOURCE / "pvstate").glob("*.py") if not path.stem.startswith(("barchan_", "render_"))}


def blocks(picture):
    """Mean colours of BLOCKS parts of a picture, which need not divide it."""
    parts = [np.array_split(band, BLOCKS[1], axis=1) for band in np.array_split(picture, BLOCKS[0], axis=0)]
    return np.array([[part.mean(axis=(0, 1)) for part in band] for band in parts])


def read(file):
    return matplotlib.image.imread(file)[:, :, :3]


def write_small(file, target):
    """A copy with 64 colours: small in the repository."""
    subprocess.run(["ffmpeg", "-y", "-loglevel", "error", "-i", str(file), "-vf", "split[a][b];[a]palettegen=max_colors=64[p];[b][p]paletteuse=dither=none",
                    "-frames:v", "1", str(target)], check=True)


class States(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.out = Path(cls.folder.name)
        jobs = []
        for name, (scene, sets) in RUNS.items():
            words = [PROGRAM, "run", SOURCE / f"scenes/verification/{scene}.toml", "--out", cls.out / name, "--quiet", "--threads", "1"]
            result = subprocess.run([*map(str, words), *(w for s in sets for w in ("--set", s))], capture_output=True, text=True)
            assert result.returncode == 0, result.stderr
        for state, name, _ in PICTURES:
            series = cls.out / name / f"{RUNS[name][0]}.pvd"
            jobs.append({"series": str(series), "state": state, "frame": "last", "size": "480x", "file": str(cls.out / f"{state}.png")})
        (cls.out / "jobs.json").write_text(json.dumps(jobs))
        result = subprocess.run([SOURCE / "pvstate/render", "--batch", cls.out / "jobs.json"], capture_output=True, text=True)
        assert result.returncode == 0, result.stderr

    def test_every_state_is_tested(self):
        elsewhere = {"sand_takeoff", "smoothing_length", "impact"}   # test_render.py
        self.assertEqual(STATES, {state for state, *_ in PICTURES} | elsewhere | {"live"})

    def test_each_state_shows_something(self):
        for state, *_ in PICTURES:
            picture = read(self.out / f"{state}.png")
            self.assertEqual(picture.shape[1], 480, state)
            self.assertGreater(picture.std(), 0.03, f"{state}: the picture is blank")
            coloured = (np.ptp(picture, axis=2) > 0.15).mean()
            self.assertGreater(coloured, 0.0015, f"{state}: nothing has a colour")

    def test_pictures_are_as_the_golden_ones(self):
        for state, _, golden in PICTURES:
            if not golden:
                continue
            found, file = self.out / f"{state}.png", GOLDEN / f"{state}.png"
            if "--write" in sys.argv:
                GOLDEN.mkdir(exist_ok=True)
                write_small(found, file)
            mean, worst = self.difference(read(found), read(file))
            self.assertLess(mean, MEAN, f"{state}: another picture than {file}")
            self.assertLess(worst, WORST, f"{state}: another picture than {file}")

    @staticmethod
    def difference(a, b):
        """Mean and largest difference of the blocks of two pictures."""
        apart = np.abs(blocks(a) - blocks(b)).max(axis=2)
        return apart.mean(), apart.max()

    def test_the_comparison_finds_what_a_person_would_see(self):
        """Letters moved by two pixels pass; other colours, a part that is missing and a picture upside down do not."""
        good = read(self.out / "pressure.png")
        self.assertLess(self.difference(np.roll(good, 2, axis=1), good)[0], MEAN)
        self.assertGreater(self.difference(good[:, :, ::-1], good)[0], MEAN)
        self.assertGreater(self.difference(good[::-1], good)[0], MEAN)
        missing = good.copy()
        missing[len(good) // 4:len(good) // 2] = 1.0
        self.assertGreater(self.difference(missing, good)[1], WORST)

    def test_states_say_what_they_need(self):
        series = self.out / "hop/hop.pvd"
        jobs = [{"series": str(series), "state": state, "frame": "last", "size": "320x", "file": str(self.out / f"none_{state}.png")}
                for state in ("pressure", "von_mises", "eddy_viscosity", "flux", "profiles", "wall_shear", "grid", "box3d")]
        (self.out / "none.json").write_text(json.dumps(jobs))
        result = subprocess.run([SOURCE / "pvstate/render", "--batch", self.out / "none.json"], capture_output=True, text=True)
        self.assertEqual(result.returncode, 2, result.stderr)
        for words in ("has no fluid", "'von_mises_stress'", "'eddy_viscosity'", "[[saltation]]", "[[profile]]", "[[wall-shear]]", "[[grid]]", "2D scene"):
            self.assertIn(words, result.stderr)
        self.assertNotIn("Traceback", result.stderr)

    def test_a_series_that_grows_is_seen(self):
        """The live state and the macro, on a list of frames that gets longer: what a run does that is still going."""
        script = self.out / "grow.py"
        script.write_text(GROW.format(pvstate=str(SOURCE / "pvstate"), series=str(self.out / "hop/hop.pvd")))
        series = self.out / "hop/hop.pvd"
        shutil.copy(series, self.out / "whole.pvd")
        environment = dict(os.environ, LIBGL_ALWAYS_SOFTWARE="1", PYTHONDONTWRITEBYTECODE="1")
        try:
            with display(environment):
                result = subprocess.run(["pvpython", "--force-offscreen-rendering", str(script)], env=environment, capture_output=True, text=True)
        finally:
            shutil.copy(self.out / "whole.pvd", series)
        self.assertEqual(result.returncode, 0, result.stderr[-2000:])
        self.assertIn("live: 3 frames, asks for more: False; 8 frames, asks for more: True; then False, at 0.014", result.stdout)
        self.assertIn("macro: 3 times, then 8", result.stdout)


class display:
    """A virtual display in the environment, as pvstate/render has it."""

    def __init__(self, environment):
        self.environment = environment

    def __enter__(self):
        read_end, write_end = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(write_end), "-screen", "0", "1280x1024x24", "-nolisten", "tcp", "-noreset"],
                                       pass_fds=[write_end], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(write_end)
        with os.fdopen(read_end) as pipe:
            self.environment["DISPLAY"] = ":" + pipe.readline().strip()

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()


GROW = '''
import os, re, runpy, sys
sys.path.insert(0, {pvstate!r})
import paraview.simple as pv
series = {series!r}
text = open(series).read()
entries = re.findall(r".*<DataSet.*\\n", text)


def list_frames(count):
    with open(series + ".part", "w") as file:
        file.write(text.replace("".join(entries), "".join(entries[:count])))
    os.replace(series + ".part", series)


os.environ.update(BARCHAN_SERIES=series, BARCHAN_SIZE="400x")
list_frames(3)
runpy.run_path(os.path.join({pvstate!r}, "live.py"), run_name="__main__")
live = next(s for s in pv.GetSources().values() if s.GetXMLName() == "LiveProgrammableSource")
pv.Render()
asks = live.SMProxy.GetClientSideObject()   # what ParaView asks in the background, and does if the answer is yes
first = asks.GetNeedsUpdate()
list_frames(8)
second = asks.GetNeedsUpdate()
asks.Modified()
live.SMProxy.MarkModified(live.SMProxy)
pv.Render()
time = pv.servermanager.Fetch(live).GetFieldData().GetArray("TimeValue").GetValue(0)
print(f"live: 3 frames, asks for more: {{first}}; 8 frames, asks for more: {{second}}; then {{asks.GetNeedsUpdate()}}, at {{time:.3f}}")
pv.Disconnect()
pv.Connect()
list_frames(3)
runpy.run_path(os.path.join({pvstate!r}, "motion.py"), run_name="__main__")
import barchan_reload
before = len(pv.GetTimeKeeper().TimestepValues)
list_frames(8)
print(f"macro: {{before}} times, then {{len(barchan_reload.reload_series())}}")
sys.stdout.flush()
os._exit(0)
'''


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
