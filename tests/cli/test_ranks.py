#!/usr/bin/python3
"""A run on several ranks writes the bytes of one process: frames, history and checkpoint.

    test_ranks.py PROGRAM SOURCE_DIR
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
SOURCE = pathlib.Path(sys.argv[2]).resolve()
MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n"]
LAUNCHERS = ("OMPI_", "PMI", "PMIX", "SLURM_")
sys.path.insert(0, str(SOURCE / "bench"))
from barchan_bench import checkpoints  # noqa: E402


def alone():
    """The environment without that of a launcher."""
    return {k: v for k, v in os.environ.items() if not k.startswith(LAUNCHERS)}


def content(file):
    """Of a checkpoint in pieces: of the one file that it would be."""
    return checkpoints.whole(file) if file.name.endswith(".checkpoint") else file.read_bytes()


def has_mpi():
    """Whether mpirun is there and the program knows MPI."""
    if not shutil.which("mpirun"):
        return False
    return "libmpi" in subprocess.run(["ldd", PROGRAM], capture_output=True, text=True).stdout


# A vortex in a fluid whose sides are all periodic; {} is the scheme.
PERIODIC = """
dimensions = 2
spacing = 0.02
{precision}
[domain]
size = [1, 1]
periodic = ["x", "y"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 10
scheme = "{scheme}"
[interactions]
water-water = 2.6
[[fill]]
phase = "water"
shape = "the-rest"
perturb = 0.1
velocity = ["sin(2*pi*x)*cos(2*pi*y)", "-cos(2*pi*x)*sin(2*pi*y)"]
[time]
end = 0.06
largest-speed = 1
[output]
every = 0.03
history-every = 0.01
"""

# Between a floor and a lid that slides, pulled along; three phases.
CHANNEL = """
dimensions = {dimensions}
spacing = {spacing}
[domain]
size = {size}
periodic = {periodic}
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-6
sound-speed = 1.25e-4
scheme = "{scheme}"
[phases.floor]
kind = "wall"
[phases.lid]
kind = "wall"
velocity = {velocity}
[interactions]
water-water = 2.6
water-floor = 2.6
water-lid = 2.6
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"] }}
[[fill]]
phase = "lid"
shape = {{ sides = ["top"] }}
[[fill]]
phase = "water"
shape = "the-rest"
[[forcing]]
phase = "water"
acceleration = {acceleration}
[time]
end = {end}
largest-speed = 1.25e-5
[output]
every = 0.05
history-every = 0.01
"""


# Water that slides out of a domain over a floor.
LEAVING = """
dimensions = 2
spacing = 0.02
[domain]
size = [0.6, 0.5]
open = ["right"]
gravity = [0, -9.81]
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 40
scheme = "{scheme}"
enclosed = false
[phases.floor]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
water-floor = 2.6
[[fill]]
phase = "floor"
shape = {{ sides = ["bottom"], layers = 3 }}
[[fill]]
phase = "water"
shape = {{ box = {{ min = [0.3, 0], max = [0.6, 0.2] }} }}
velocity = [3, 0]
[time]
end = 0.06
largest-speed = 4
[output]
every = 0.03
history-every = 0.01
"""
# A ball that a fluid carries, across the sides of its domain.
BALL = """
dimensions = 3
spacing = 0.1
[domain]
size = [1.6, 1.2, 1.2]
periodic = ["x", "y", "z"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 10
[phases.ball]
kind = "rigid"
density = 2000
[interactions]
water-water = {}
water-ball = {}
[[fill]]
phase = "ball"
shape = { sphere = { centre = [0.3, 0.6, 0.3], radius = 0.25 } }
velocity = [0.5, 0.2, 0]
[[fill]]
phase = "water"
shape = "the-rest"
velocity = [0.5, 0, 0]
[time]
end = 0.05
largest-speed = 1
[output]
every = 0.025
history-every = 0.01
"""

# A drop in a lighter fluid, both disturbed, over a floor that comes after the drop in the file.
DROP = """
dimensions = 2
spacing = 0.04
[domain]
size = [2, 1]
periodic = ["x"]
gravity = [0, -1]
[phases.water]
kind = "fluid"
density = 1000
sound-speed = 20
[phases.oil]
kind = "fluid"
density = 800
sound-speed = 20
[phases.wall]
kind = "wall"
[interactions]
kernel = "wendland-c2"
water-water = 2.6
oil-oil = 2.6
water-oil = 2.6
water-wall = 2.6
oil-wall = 2.6
[[fill]]
phase = "water"
shape = { disc = { centre = [0.9, 0.5], radius = 0.33 } }
perturb = 0.2
seed = 3
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top"] }
[[fill]]
phase = "oil"
shape = "the-rest"
perturb = 0.1
velocity = ["0.1*sin(pi*y)", 0]
[time]
end = 0.02
[output]
every = 0.01
history-every = 0.005
"""

# Scenes of scenes/, shortened, by what they show: file, end (s), overrides. Frames at the middle, on three ranks, and at the end, on two.
SCENES = {
    "eddies over rough, fitted ground": ("verification/rough_hill", 0.016, "spacing=0.05"),
    "eddies under a lid that pulls": ("verification/logarithmic_layer", 0.004),
    "eddies of Smagorinsky": ("verification/logarithmic_layer", 0.004, "phases.air.turbulence=smagorinsky"),
    "eddies of two equations": ("verification/logarithmic_layer", 0.004, "phases.air.turbulence=k-omega"),
    "instruments": ("verification/poiseuille", 0.04, "probe.0.every=0.004", "profile.0.start=0", "profile.1.start=0.01", "grid.0.start=0",
                    "wall-shear.0.start=0", "wall-shear.1.start=0"),
    "instruments of eddies": ("verification/rough_hill", 0.016, "spacing=0.05", "wall-shear.0.start=0"),
    "a force by a control volume, a forcing of place": ("verification/cylinder", 0.1),
    "a free surface, consistent": ("verification/dam_break", 0.03, "spacing=5.715e-3"),
    "a free surface, plain": ("verification/dam_break", 0.03, "spacing=5.715e-3", "phases.water.scheme=plain"),
    "a free surface in three dimensions": ("verification/dam_break_3d", 0.004, "spacing=1.143e-2"),
    "a patch without walls": ("verification/square_patch", 0.1, "spacing=0.1"),
    "water under air": ("verification/two_phase_column", 0.006),
    "two spacings": ("verification/two_spacings", 0.06),
    "a wall that is pushed, its force": ("verification/piston", 0.02),
    "a gate that is drawn out of water": ("dam_gate", 0.05, "spacing=0.015", "fill.1.shape.box.max=[0.66, 0.45]"),
    "a wave maker": ("verification/wave_maker", 0.2, "constants.rows=10"),
    "a flow through open ends": ("verification/open_channel", 0.4),
    "a flow past a cylinder through open ends": ("verification/cylinder_open", 0.1),
    "borders of spacings, eddies and open ends": ("verification/joined_wind", 0.002),
    "sand in eddies of two equations": ("wind_over_sand", 0.002, "phases.air.turbulence=k-omega", "interactions.air-sand.lift=0.85", "interactions.air-sand.gusts=0.38",
                                        'fill.3={ phase = "sand", shape = { points = [[0.02, 0.0034], [0.05, 0.006], [0.09, 0.012]] } }'),
    "gusts and lift in a column": ("saltation", 0.001, "interactions.air-sand.lift=0.85", "interactions.air-sand.gusts=0.38"),
    "grains by kernels in air": ("verification/pile", 0.001),
    "spheres that blow in and out": ("verification/sand_influx", 0.005),
    "spheres on a belt": ("hopper_belt", 0.0003),
    "slices of spheres of many sizes": ("hopper_belt", 0.0003, "profile.0.start=0", "profile.0.every=0.0001", "profile.0.box.min=[0, 0]",
                                        "profile.0.box.max=[0.2, 0.16]"),
    "spheres that sleep under water, and an influx": ("water_over_sand", 0.0003),
    "an elastic block on a wall": ("bouncing_block", 0.0003),
    "a fork whose prongs touch": ("verification/self_contact", 1e-4),
    "rigid bodies that touch": ("gears", 0.0005),
    "a rigid disc in a plain fluid": ("verification/sinking_disc", 0.001),
    "a cylinder that floats, consistent": ("verification/heaving_cylinder", 0.01, "constants.across=10"),
    "a disc that sinks, consistent": ("verification/settling_disc", 0.01, "spacing=0.125"),
    "a cylinder in a shear flow": ("verification/sheared_cylinder", 0.1),
    "a cylinder beside a periodic side": ("verification/sheared_cylinder", 0.1, "fill.0.shape.disc.centre=[-3.4, 0.3]"),
    "a plate that a flow bends, its cylinder": ("verification/turek_hron_fsi2", 0.01, "constants.ramp=0.01"),
    "books of the energy of a free surface": ("verification/dam_break", 0.03, "spacing=5.715e-3", "phases.water.energy-budget=true"),
    "books of the energy, plain": ("verification/dam_break", 0.03, "spacing=5.715e-3", "phases.water.energy-budget=true",
                                   "phases.water.scheme=plain"),
    "books of the energy in three dimensions": ("verification/dam_break_3d", 0.004, "spacing=1.143e-2", "phases.water.energy-budget=true"),
    "books of the energy without walls": ("verification/taylor_green", 0.02, "phases.fluid.energy-budget=true"),
    "a settled bed under a wind": ("threshold", 0.0001, "domain.size=[0.016, 0.032]"),
}


def channel(scheme, solid=False):
    if solid:
        return CHANNEL.format(dimensions=3, spacing=1e-4, size="[6e-4, 1e-3, 7e-4]", periodic='["x", "z"]', scheme=scheme,
                              velocity="[1.25e-5, 0, 0]", acceleration="[1e-5, 0, 0]", end=0.1)
    return CHANNEL.format(dimensions=2, spacing=4e-5, size="[6.4e-4, 1e-3]", periodic='["x"]', scheme=scheme,
                          velocity="[1.25e-5, 0]", acceleration="[1e-5, 0]", end=0.15)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.at = pathlib.Path(folder.name)
        self.addCleanup(folder.cleanup)

    def start(self, ranks, text, out, *options, threads=1):
        (self.at / "scene.toml").write_text(text)
        return self.start_file(ranks, "scene.toml", out, *options, threads=threads)

    def start_file(self, ranks, scene, out, *options, threads=1):
        before = [*MPIRUN, str(ranks)] if ranks else []
        return subprocess.run([*before, PROGRAM, "run", str(scene), "--quiet", "--threads", str(threads), "--out", out, *options],
                              cwd=self.at, env=alone(), capture_output=True, text=True, timeout=600)

    def run_on(self, ranks, text, out, *options, threads=1):
        ended = self.start(ranks, text, out, *options, threads=threads)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended

    def same(self, one, other):
        """All that has the bits of the run."""
        def names_of(folder):  # the checkpoint before the last one is that of a run that was continued; ranks write pieces
            return {f.name for f in (self.at / folder).iterdir() if not f.name.endswith((".older", "_checkpoint"))} - {"run.json"}

        names = names_of(one)
        self.assertEqual(names, names_of(other))
        self.assertTrue(any(name.endswith(".checkpoint") for name in names))
        for name in sorted(names):
            self.assertEqual(content(self.at / one / name), content(self.at / other / name), f"{name} of {other}")


@unittest.skipUnless(has_mpi(), "no MPI here")
class Ranks(Folder):
    def compare(self, text, *ranks):
        self.run_on(0, text, "one")
        for n in ranks:
            self.run_on(n, text, f"of-{n}")
            self.same("one", f"of-{n}")

    def test_scenes(self):
        for name, (file, end, *overrides) in SCENES.items():
            with self.subTest(name):
                out = name.replace(" ", "_").replace(",", "")
                sets = [f"output.every={end / 2!r}", f"output.history-every={end / 4!r}", *overrides]
                self.compare_file(SOURCE / "scenes" / (file + ".toml"), end, out, [word for s in sets for word in ("--set", s)])

    def compare_file(self, scene, end, out, sets):
        def run(ranks, to, *options):
            ended = self.start_file(ranks, scene, to, *sets, *options)
            self.assertEqual(ended.returncode, 0, f"{to}: {ended.stderr}")

        whole, half = ("--set", f"time.end={end!r}"), ("--set", f"time.end={end / 2!r}")
        run(0, out, *whole)
        run(3, f"{out}-3-2", *half)
        run(2, f"{out}-3-2", *whole, "--restart", "latest")
        self.same(out, f"{out}-3-2")

    def test_plain_fluid_in_a_periodic_domain(self):
        self.compare(PERIODIC.format(scheme="plain", precision=""), 2, 3)

    def test_consistent_fluid_in_a_periodic_domain(self):
        self.compare(PERIODIC.format(scheme="consistent", precision=""), 2, 3)

    def test_in_double_precision(self):
        self.compare(PERIODIC.format(scheme="consistent", precision='precision = "double"'), 3)

    def test_fluid_with_voids(self):
        text = PERIODIC.format(scheme="consistent", precision="").replace("perturb = 0.1", "perturb = 0.45")
        self.compare(text, 2, 3)

    def test_plain_fluid_between_walls(self):
        self.compare(channel("plain"), 2, 3)

    def test_consistent_fluid_between_walls(self):
        self.compare(channel("consistent"), 2, 3)

    def test_fills_of_two_fluids(self):
        self.compare(DROP, 2, 3)

    def test_a_mistake_of_the_fills_is_told_once_and_in_the_same_words(self):
        for wrong in ('[[fill]]\nphase = "oil"\nshape = { box = { min = [0.92, 0.6], max = [1.8, 0.9] } }\n',
                      '[[fill]]\nphase = "oil"\nshape = { formula = "-1" }\n'):
            text = DROP + wrong
            one, many = self.start(0, text, "out"), self.start(3, text, "out")
            self.assertEqual((one.returncode, many.returncode), (2, 2), many.stderr)
            told = next(line for line in one.stderr.splitlines() if "fill." in line)
            self.assertEqual(many.stderr.count(told), 1, many.stderr)
            self.assertFalse((self.at / "out").exists())

    def test_three_dimensions(self):
        self.compare(channel("consistent", solid=True), 2, 3)

    def test_what_leaves_through_an_open_side(self):
        for scheme in ("plain", "consistent"):
            with self.subTest(scheme):
                text = LEAVING.format(scheme=scheme)
                self.run_on(0, text, f"{scheme}-1")
                header, *rows = (self.at / f"{scheme}-1/history.csv").read_text().splitlines()
                left = next(k for k, name in enumerate(header.split(",")) if name.startswith("water_left"))
                self.assertGreater(float(rows[-1].split(",")[left]), 1.0)
                for n in (2, 3):
                    self.run_on(n, text, f"{scheme}-{n}")
                    self.same(f"{scheme}-1", f"{scheme}-{n}")

    def test_the_energy_of_what_leaves_through_an_open_side(self):
        for scheme in ("plain", "consistent"):
            with self.subTest(scheme):
                text = LEAVING.format(scheme=scheme).replace("enclosed = false", "enclosed = false\nenergy-budget = true")
                self.run_on(0, text, f"{scheme}-1")
                header, *rows = (self.at / f"{scheme}-1/history.csv").read_text().splitlines()
                taken = header.split(",").index("water_taken_by_open_sides [J/m]")
                self.assertGreater(float(rows[-1].split(",")[taken]), 1.0)
                for n in (2, 3):
                    self.run_on(n, text, f"{scheme}-{n}")
                    self.same(f"{scheme}-1", f"{scheme}-{n}")

    def test_a_ball_beside_periodic_sides(self):
        self.compare(BALL, 2, 3)

    def test_bodies_of_a_consistent_fluid_with_threads_beside_ranks(self):
        sets = ["--set", "time.end=0.1", "--set", "output.every=0.05", "--set", "output.history-every=0.025"]
        for ranks, threads in ((0, 2), (2, 1), (2, 2), (3, 2)):
            ended = self.start_file(ranks, SOURCE / "scenes/verification/sheared_cylinder.toml", f"{ranks}-{threads}", *sets, threads=threads)
            self.assertEqual(ended.returncode, 0, ended.stderr)
            self.same("0-2", f"{ranks}-{threads}")

    def test_fluid_with_energy(self):
        self.compare(channel("plain").replace("viscosity = 1e-6", "viscosity = 1e-6\nenergy = true"), 3)

    def test_a_column_of_air_over_spheres(self):
        sets = ["--set", "time.end=0.0005", "--set", "output.every=0.00025", "--set", "output.history-every=0.00025"]
        for ranks, out in ((0, "one"), (3, "of-3")):
            ended = self.start_file(ranks, SOURCE / "scenes/saltation.toml", out, *sets)
            self.assertEqual(ended.returncode, 0, ended.stderr)
        self.same("one", "of-3")

    def test_threads_beside_ranks(self):
        text = PERIODIC.format(scheme="plain", precision="")
        self.run_on(0, text, "one")
        self.run_on(2, text, "of-2", threads=2)
        self.same("one", "of-2")

    def test_more_ranks_than_rows_of_cells_of_a_wall(self):
        self.compare(channel("plain"), 7)

    def test_a_breakdown_is_told_once_and_the_same(self):
        text = PERIODIC.format(scheme="plain", precision="").replace("end = 0.06", "step = 0.02\nend = 0.4")
        one, many = self.start(0, text, "one"), self.start(3, text, "of-3")
        self.assertEqual((one.returncode, many.returncode), (3, 3), many.stderr)
        self.assertIn(one.stderr.splitlines()[-1], many.stderr)
        self.assertEqual(many.stderr.count("first bad state"), 1)
        for name in ("scene_000001.vtp", "scene_bad.vtp"):  # the last good state, though particles have changed their rank since, and the bad one
            self.assertEqual((self.at / "one" / name).read_bytes(), (self.at / "of-3" / name).read_bytes(), name)

    def test_a_folder_that_cannot_be_written_ends_all_ranks(self):
        (self.at / "file").write_text("")
        ended = self.start(2, PERIODIC.format(scheme="plain", precision=""), "file/out")
        self.assertEqual(ended.returncode, 4, ended.stderr)
        self.assertIn("file/out", ended.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
