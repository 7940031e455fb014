#!/usr/bin/python3
"""Files that a run reads: what is no regular file is refused, and files of Windows and their units are read; formulas, fluxes and constants
whose values cannot be.

    test_inputs.py PROGRAM SOURCE_DIR
"""

import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
SOURCE = pathlib.Path(sys.argv[2])

WATER = """spacing = 0.1
[domain]
size = [1, 1]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-3
sound-speed = 20
[interactions]
water-water = 2.1
[[fill]]
phase = "water"
shape = SHAPE
[time]
end = 0.001
largest-speed = 1
"""

SAND = """spacing = 1e-3
[domain]
size = [0.03, 0.03]
gravity = [0, -9.81]
open = ["left", "right"]
[phases.sand]
kind = "grains"
density = 2650
diameter = 1e-3
stiffness = 500
[phases.floor]
kind = "wall"
diameter = 1e-3
[interactions]
sand-sand = { law = "linear" }
sand-floor = { law = "linear" }
[[fill]]
phase = "floor"
shape = { sides = ["bottom"] }
[[fill]]
phase = "sand"
shape = SHAPE
[time]
end = 1e-3
"""

INFLUX = """
[[influx]]
phase = "sand"
side = "left"
flux = FLUX
decay-height = 0.01
speed = 2
"""

AIR = """spacing = 0.1
[domain]
size = [1, 1]
[phases.air]
kind = "fluid"
density = 1
sound-speed = 30
[interactions]
air-air = 2.1
[[fill]]
phase = "air"
shape = "the-rest"
[[inflow]]
phase = "air"
side = "left"
velocity = { profile = "FILE" }
[[outflow]]
phase = "air"
side = "right"
[time]
end = 0.001
"""

SQUARE = ((0, 0), (800, 0), (800, 500), (0, 500))
MARK = b"\xef\xbb\xbf"


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="barchan_inputs_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def barchan(self, *words, status=0):
        done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True, timeout=60, cwd=self.folder)
        self.assertEqual(done.returncode, status, done.stdout[-1000:] + done.stderr[-2000:])
        return done.stdout + done.stderr

    def places(self, shape, scene=WATER):
        """The bytes of the particles that a scene begins with."""
        self.write("s.toml", scene.replace("SHAPE", shape))
        self.barchan("generate", "s.toml", "-o", "g.vtp")
        return (self.folder / "g.vtp").read_bytes()

    def refused(self, scene, *words):
        self.write("s.toml", scene)
        said = self.barchan("plan", "s.toml", status=2)
        for word in words:
            self.assertIn(word, said)
        return said


class NoRegularFile(Case):
    """Each of these once ran for ever, without a word."""

    def others(self):
        os.mkfifo(self.folder / "pipe")
        for name, what in (("/dev/zero", "is a device, not a regular file"), (str(self.folder / "pipe"), "is a pipe, not a regular file"),
                           (str(self.folder), "is a directory")):
            for suffix in ("", ".vtp", ".csv", ".stl", ".toml"):
                link = self.folder / f"link{abs(hash(name)) % 1000}{suffix}"
                link.symlink_to(name)
                yield link, what

    def test_all_that_a_scene_names(self):
        for file, what in self.others():
            with self.subTest(file=file.name, what=what):
                if file.suffix in (".csv", ".stl", ".vtp"):
                    self.refused(WATER.replace("SHAPE", f'{{ surface = "{file}" }}'), "fill.0.shape.surface", what)
                if file.suffix in (".vtp", ""):
                    self.refused(SAND.replace("SHAPE", f'{{ file = "{file}" }}'), "fill.1.shape.file", what)
                    flux = INFLUX.replace("decay-height = 0.01\nspeed = 2", f'file = "{file}"').replace("FLUX", "0.02")
                    self.refused(SAND.replace("SHAPE", '{ points = [[0.02, 0.02]] }') + flux, "influx.0.file", what)
                if file.suffix == ".csv":
                    self.refused(AIR.replace("FILE", str(file)), "inflow", what)

    def test_what_a_command_names(self):
        self.write("good.toml", WATER.replace("SHAPE", '"the-rest"'))
        for file, what in self.others():
            with self.subTest(file=file.name, what=what):
                if file.suffix == ".toml":
                    self.assertIn(what, self.barchan("plan", file, status=2))
                if file.suffix == "":
                    self.assertIn(what, self.barchan("run", "good.toml", "--restart", file, status=2))
                if file.suffix == ".vtp":
                    self.assertIn(what, self.barchan("compare", file, file, status=4))

    def test_a_file_that_is_too_large(self):
        with open(self.folder / "large.toml", "wb") as file:
            file.truncate(1 << 40)
        self.assertIn("is larger than 16 MB", self.barchan("plan", "large.toml", status=2))
        (self.folder / "large.stl").symlink_to("large.toml")
        self.refused(WATER.replace("SHAPE", '{ surface = "large.stl" }'), "is larger than 1 GB")
        (self.folder / "large.vtp").symlink_to("large.toml")
        self.refused(SAND.replace("SHAPE", '{ file = "large.vtp" }'), "fill.1.shape.file")


class Tables(Case):
    def outline(self, head, separator=",", end="\n", quote="", mark=b"", scale=1.0):
        rows = [head] if head else []
        rows += [separator.join(f"{quote}{x * scale:.10g}{quote}" for x in corner) for corner in SQUARE]
        return mark + (end.join(rows) + end).encode()

    def test_outlines_of_other_programs(self):
        self.write("plain.csv", self.outline("x,y", scale=1e-3))
        expected = self.places('{ surface = "plain.csv" }')
        for name, content in (
                ("mark", self.outline("x,y", mark=MARK, scale=1e-3)),
                ("mark, no head", self.outline("", mark=MARK, scale=1e-3)),
                ("windows", self.outline('"x","y"', end="\r\n", quote='"', mark=MARK, scale=1e-3)),
                ("semicolons", self.outline("x;y", separator=";", end="\r\n", quote='"', scale=1e-3)),
                ("tabs", self.outline("x\ty", separator="\t", scale=1e-3)),
                ("in mm", self.outline("x [mm],y [mm]")),
                ("in mm, quoted", self.outline('"x [mm]";"y [mm]"', separator=";", quote='"', end="\r\n", mark=MARK)),
                ("in mm, in round brackets", self.outline("x (mm), y (mm)")),
                ("in mm, by a name", self.outline("x_mm,y_mm")),
                ("in cm", self.outline("Rechtswert [cm],Hochwert [cm]", scale=0.1)),
                ("in um", self.outline("x [\u00b5m],y [um]", scale=1e3)),
                ("in km", self.outline("x [km] y [km]", separator=" ", scale=1e-6)),
                ("numpy.savetxt", self.outline("# x [mm], y [mm]"))):
            with self.subTest(name):
                self.write("other.csv", content)
                self.assertEqual(self.places('{ surface = "other.csv" }'), expected)

    def test_outlines_that_are_refused(self):
        for head, separator, said in (("x [furlong],y [furlong]", ",", 'line 1 has the column x in "furlong"; expected a unit of length'),
                                      ("x [m/s],y [m]", ",", 'in "m/s"'),
                                      ("O.5,l", ",", "line 1 is not a corner x, y"),
                                      ("l,O", ",", "line 1 is not a corner x, y"),
                                      ("1O,y", ",", "line 1 is not a corner x, y"),
                                      ("x1,y1", ",", "line 1 is not a corner x, y"),
                                      ('"x,y', ",", "line 1 has a field whose quote is not closed"),
                                      ("0,5;1", ";", 'line 1 has "0,5" is no finite number; expected a decimal point')):
            with self.subTest(head):
                self.write("other.csv", self.outline(head, separator))
                self.refused(WATER.replace("SHAPE", '{ surface = "other.csv" }'), "fill.0.shape.surface", said)
        self.write("other.csv", "x,y\n0,0\n1,0\n1,1\n".encode("utf-16"))
        self.refused(WATER.replace("SHAPE", '{ surface = "other.csv" }'), "is text in UTF-16; expected UTF-8")
        self.write("other.csv", self.outline("x [mm],y [mm]"))
        self.refused(WATER.replace("SHAPE", '{ surface = "other.csv", scale = 1e-3 }'), "fill.0.shape.scale", "are in mm")

    def test_meshes_with_a_mark(self):
        corpus = SOURCE / "tests/fuzz/corpus/mesh"
        for name in ("text.stl", "a.obj", "text.ply", "binary_little_endian.ply", "text.vtk", "text.vtp"):
            content = (corpus / name).read_bytes()
            windows = content.replace(b"\n", b"\r\n") if b"binary" not in content[:200] else content
            shape = '{ surface = "FILE", scale = 0.9 }'
            scene = WATER.replace("size = [1, 1]", "size = [1, 1, 1]").replace("spacing = 0.1", "dimensions = 3\nspacing = 0.1")
            self.write(name, content)
            expected = self.places(shape.replace("FILE", name), scene)
            with self.subTest(name):
                self.write("marked" + pathlib.Path(name).suffix, MARK + windows)
                self.assertEqual(self.places(shape.replace("FILE", "marked" + pathlib.Path(name).suffix), scene), expected)

    def test_scenes_with_a_mark(self):
        scene = WATER.replace("SHAPE", '"the-rest"')
        expected = self.places('"the-rest"')
        self.write("m.toml", MARK + scene.replace("\n", "\r\n").encode())
        self.barchan("generate", "m.toml", "-o", "m.vtp")
        self.assertEqual((self.folder / "m.vtp").read_bytes(), expected)
        self.write("u.toml", scene.encode("utf-16"))
        self.assertIn("u.toml:1:1: is text in UTF-16; expected UTF-8", self.barchan("plan", "u.toml", status=2))

    def profile(self, head, rows, separator=",", end="\n", mark=b""):
        return mark + (end.join([head] + [separator.join(row) for row in rows]) + end).encode()

    def test_profiles(self):
        self.write("plain.csv", self.profile("y,velocity_x", (("0.1", "10"), ("0.3", "20"))))
        quote = '"{}"'.format
        for name, content in (
                ("units", self.profile("y [mm],velocity_x [km/h]", (("100", "36"), ("300", "72")))),
                ("windows", self.profile('"y [cm]";"velocity_x [mm/s]"', ((quote("10"), quote("10000")), (quote("30"), quote("20000"))), ";", "\r\n", MARK)),
                ("powers", self.profile("velocity_x [m s-1],y [dm]", (("10", "1"), ("20", "3"))))):
            with self.subTest(name):
                for file in ("plain.csv", "other.csv"):
                    self.write("other.csv", content)
                    self.write(file + ".toml", AIR.replace("FILE", file).replace("sound-speed = 30", "sound-speed = 300"))
                    self.barchan("run", file + ".toml", "--quiet", "--threads", "1", "--out", file + ".out")
                self.barchan("compare", "plain.csv.out/plain.csv.pvd", "other.csv.out/other.csv.pvd", "--tolerance", "0")
        for head, said in (("y [mile],velocity_x", 'has the column y in "mile"; expected a unit of length (m, mm'),
                           ("y,velocity_x [kn]", 'has the column velocity_x in "kn"; expected a unit of speed (m/s'),
                           ("y,y [m],velocity_x", "has two columns y")):
            with self.subTest(head):
                self.write("other.csv", self.profile(head, (("0.1",) * (head.count(",") + 1), ("0.3",) * (head.count(",") + 1))))
                self.refused(AIR.replace("FILE", "other.csv"), said)


class Values(Case):
    def test_formulas_have_the_bounds_of_numbers(self):
        wall = WATER.replace("SHAPE", '{ box = { min = [0, 0], max = [1, 0.5] } }').replace("[time]", '[[fill]]\nphase = "wall"\nshape = { sides = ["bottom"] }\n[time]')
        wall = wall.replace("[interactions]", '[phases.wall]\nkind = "wall"\nvelocity = ["VALUE", 0]\n[interactions]\nwater-wall = 2.1')
        for value, said in (("1/0", "gives inf at t = 0 s"), ("sqrt(-1)", "nan at t = 0 s"), ("1/(t - 5e-4)", "gives inf at t = 0.0005 s")):
            with self.subTest(value):
                self.refused(wall.replace("VALUE", value), 's.toml:11:12: phases.wall.velocity: the formula "' + value + '"', said, "expected a finite number at all times")
        force = WATER.replace("SHAPE", '"the-rest"') + '[[forcing]]\nphase = "water"\nacceleration = [0, "x/0"]\n'
        self.refused(force, "forcing.0.acceleration")
        fill = WATER.replace("SHAPE", '"the-rest"\nvelocity = ["log(-1)", 0]\npressure = "1/0"')
        self.refused(fill, "fill.0.velocity: the formula", "fill.0.pressure: the formula")
        ends = WATER.replace("SHAPE", '"the-rest"\nvelocity = ["1/x", 0]')  # no particle stands at x = 0
        self.write("s.toml", ends)
        self.barchan("plan", "s.toml")

    def test_a_formula_that_fails_in_a_run_names_its_key(self):
        scene = WATER.replace("SHAPE", '"the-rest"').replace("end = 0.001", "end = 0.01")
        self.write("s.toml", scene + '[[forcing]]\nphase = "water"\nrate = 1\nvelocity = ["sqrt(0.003 - t + 10*(x > 0.3))", 0]\n')
        self.assertIn("forcing.0.velocity: the formula", self.barchan("run", "s.toml", "--quiet", "--threads", "1", status=3))

    def test_motions(self):
        scene = WATER.replace("SHAPE", '{ box = { min = [0, 0], max = [0.5, 1] } }')
        scene = scene.replace("[interactions]", '[phases.gate]\nkind = "wall"\n[interactions]\nwater-gate = 2.1')
        scene = scene.replace("[time]", '[[fill]]\nphase = "gate"\nshape = { box = { min = [0.5, 0], max = [0.8, 1] } }\n[time]')
        self.refused(scene + '[[motion]]\nphase = "gate"\nvelocity = [0, "sqrt(5e-4 - t)"]\n', "motion.0.velocity: the formula")

    def test_ten_thousand_constants(self):
        count = 10000
        for name, definitions, status in (
                ("a chain", [f'c{k} = "c{k + 1} + 1"' for k in range(count)] + [f"c{count} = 1"], 0),
                ("none is used", [f"c{k} = {k}" for k in range(count)], 2),
                ("a circle", [f'c{k} = "c{(k + 1) % count} + 1"' for k in range(count)], 2)):
            text = WATER.replace("SHAPE", '"the-rest"').replace("end = 0.001", 'end = "1e-7*c0"' if status == 0 or "circle" in name else "end = 1e-3")
            self.write("s.toml", text + "[constants]\n" + "\n".join(definitions) + "\n")
            begin = time.monotonic()
            said = self.barchan("plan", "s.toml", status=status)
            self.assertLess(time.monotonic() - begin, 30, name)  # 120 s and more before
            if name == "a circle":
                self.assertIn("which needs it; expected a formula without a circle", said)

    def test_fluxes(self):
        scene = SAND.replace("SHAPE", "{ points = [[0.02, 0.02]] }")
        most = 0.6 * 2650 * 2 * 0.03
        self.refused(scene + INFLUX.replace("FLUX", "1e6"), "influx.0.flux: 1000000 kg/m/s is more than", f"expected at most {most:.10g} kg/m/s")
        self.refused(scene + INFLUX.replace("FLUX", "%.10g" % (1.001 * most)), "influx.0.flux")
        for flux, warned in (("0.02", False), ("0.5", False), ("35", True)):
            self.write("s.toml", scene + INFLUX.replace("FLUX", flux))
            for command in (("plan", "s.toml"), ("run", "s.toml", "--quiet", "--threads", "1")):
                with self.subTest(flux=flux, command=command):
                    self.assertEqual("influx.0.flux: " in self.barchan(*command), warned)
        self.write("s.toml", scene + INFLUX.replace("FLUX", "0.02").replace("speed = 2", "speed = 2000"))
        self.assertIn("influx.0.speed: at 2000 m/s", self.barchan("plan", "s.toml"))

    def test_bodies_that_are_nearly_incompressible(self):
        body = WATER.replace('kind = "fluid"', 'kind = "elastic"\nyoung = 1e6\npoisson = VALUE').replace("viscosity = 1e-3\nsound-speed = 20\n", "")
        body = body.replace("water-water = 2.1", "water-water = {}").replace("SHAPE", "{ box = { min = [0, 0], max = [0.5, 0.5] } }")
        self.refused(body.replace("VALUE", "0.4999999999"), "phases.water.poisson: 0.4999999999 is so near to 0.5", "expected at most 0.4999")
        self.write("s.toml", body.replace("VALUE", "0.4995"))
        self.barchan("plan", "s.toml")

    def test_a_surface_that_paraview_saved(self):
        """Raw appended data, as ParaView writes them by default: VTK 9.1 and 9.2 themselves do not find them where expat is later than 2.5."""
        try:
            from vtkmodules.vtkFiltersSources import vtkSphereSource
            from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter
        except ImportError:
            self.skipTest("python3-paraview is not there")
        ball, writer = vtkSphereSource(), vtkXMLPolyDataWriter()
        ball.SetRadius(0.01)
        ball.SetThetaResolution(40)
        ball.SetPhiResolution(40)
        writer.SetInputConnection(ball.GetOutputPort())
        writer.SetFileName(str(pathlib.Path(self.folder) / "ball.vtp"))
        writer.EncodeAppendedDataOff()
        writer.Write()
        self.write("s.toml", """dimensions = 3
spacing = 2e-3
[domain]
size = [0.04, 0.04, 0.04]
[phases.body]
kind = "elastic"
density = 1000
young = 1e6
poisson = 0.4
[interactions]
body-body = { radius = 1.6 }
[[fill]]
phase = "body"
shape = { surface = "ball.vtp", move = [0.02, 0.02, 0.02] }
[time]
end = 1e-4
""")
        particles = int(self.barchan("generate", "s.toml", "-o", "b.vtp").split()[1])
        self.assertAlmostEqual(particles * 0.002 ** 3 / (4 / 3 * math.pi * 0.01 ** 3), 1, delta=0.1)

    def test_gravity_along_another_axis(self):
        scene = SAND.replace("size = [0.03, 0.03]", "size = [0.01, 0.01, 0.01]").replace("spacing", "dimensions = 3\nspacing", 1)
        scene = scene.replace("SHAPE", "{ points = [[0.005, 0.005, 0.005]] }")
        for gravity, warned in (("[0, -9.81, 0]", False), ("[0, 0, -9.81]", False), ("[9.81, 0, 0]", True)):
            with self.subTest(gravity):
                self.write("s.toml", scene.replace("[0, -9.81]", gravity))
                self.assertEqual('are along y: "bottom"' in self.barchan("plan", "s.toml"), warned)
        self.write("s.toml", scene.replace("[0, -9.81]", "[0, 0, -9.81]").replace('"bottom"', '"back"'))
        self.assertIn('stands at "back" and none at "bottom"', self.barchan("plan", "s.toml"))


class Promises(Case):
    """What a run promises of its folder."""

    def run_scene(self, *words):
        scene = WATER.replace("SHAPE", '"the-rest"').replace("end = 0.001", "end = 1000") + "[output]\nevery = 0.002\nhistory-every = 1e-3\n"
        self.write("s.toml", scene)
        return subprocess.Popen([PROGRAM, "run", "s.toml", "--quiet", "--threads", "1", "--out", "o", *words], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def wait_for(self, ready):
        until = time.monotonic() + 30
        while not ready():
            self.assertLess(time.monotonic(), until)
            time.sleep(0.02)

    def frame(self, number):
        return self.folder / f"o/s_{number:06d}.vtp"

    def end(self, process, status):
        (self.folder / "o/TERMINATE").touch()
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, status, said)
        return said

    def listed(self):
        return [line.split('file="')[1].split('"')[0] for line in (self.folder / "o/s.pvd").read_text().splitlines() if "DataSet" in line]

    def test_frames_that_are_removed(self):
        process = self.run_scene()
        self.wait_for(lambda: self.frame(3).exists())
        self.frame(1).unlink()
        said = self.end(process, 4)
        self.assertIn("s_000001.vtp", said)
        listed = self.listed()
        self.assertNotIn("s_000001.vtp", listed)
        self.assertGreaterEqual(len(listed), 3)
        self.assertEqual(sorted(listed), sorted(file.name for file in (self.folder / "o").glob("s_*.vtp")))
        # The run goes on from its checkpoint, with the frames that are there.
        process = self.run_scene("--restart", "latest")
        self.wait_for(lambda: len(self.listed()) > len(listed) + 1)
        self.end(process, 0)
        self.assertEqual(self.listed()[:len(listed)], listed)

    def test_a_history_that_is_removed(self):
        process = self.run_scene()
        self.wait_for(lambda: self.frame(2).exists())
        (self.folder / "o/history.csv").unlink()
        self.assertIn("history.csv", self.end(process, 4))

    def test_a_lock_that_is_removed(self):
        process = self.run_scene()
        self.wait_for(lambda: self.frame(2).exists())
        (self.folder / "o/barchan.lock").unlink()
        second = self.run_scene()
        said, _ = second.communicate(timeout=60)
        self.assertEqual(second.returncode, 2, said)
        self.assertIn("belongs to a run that is going on", said)
        self.end(process, 0)

    def test_a_folder_that_is_replaced(self):
        process = self.run_scene()
        self.wait_for(lambda: self.frame(2).exists())
        (self.folder / "o").rename(self.folder / "moved")
        second = self.run_scene()
        self.wait_for(lambda: self.frame(2).exists())
        said, _ = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 4, said)
        self.assertIn("was removed or replaced while the run went on", said)
        self.end(second, 0)
        self.assertEqual(self.listed(), sorted(file.name for file in (self.folder / "o").glob("s_*.vtp")))

    def test_a_series_that_goes_on_elsewhere(self):
        scene = WATER.replace("SHAPE", '"the-rest"') + "[output]\nevery = 2e-4\n"
        self.write("s.toml", scene)
        self.barchan("run", "s.toml", "--quiet", "--threads", "1", "--out", "whole", "--set", "time.end=2e-3")
        self.barchan("run", "s.toml", "--quiet", "--threads", "1", "--out", "half")
        said = self.barchan("run", "s.toml", "--quiet", "--threads", "1", "--set", "time.end=2e-3", "--restart", "half/s.checkpoint", "--out", "new")
        self.assertIn("the series begins there with frame", said)
        frames = sorted(file.name for file in (self.folder / "new").glob("s_*.vtp"))
        self.assertGreaterEqual(len(frames), 3)
        for name in frames:
            self.assertEqual((self.folder / "new" / name).read_bytes(), (self.folder / "whole" / name).read_bytes(), name)


class Restarts(Case):
    def test_other_fields_of_bodies(self):
        body = """spacing = 0.1
[domain]
size = [1, 1]
[phases.block]
kind = "elastic"
density = 1000
young = 1e5
poisson = 0.3
[interactions]
block-block = {}
[[fill]]
phase = "block"
shape = { box = { min = [0, 0], max = [0.5, 0.5] } }
velocity = ["0.1*x", 0]
[time]
end = 1e-2
[output]
every = 5e-3
fields = FIELDS
"""
        for form in ("", 'formulation = "updated-lagrangian"\n'):
            scene = body.replace("[interactions]", form + "[interactions]")
            if form:
                scene = scene.replace("block-block = {}", "block-block = 1.6")
            some, other = '["stress"]', '["von_mises_stress", "principal_stress"]' if form else '["strain", "von_mises_stress", "principal_stress"]'
            for first, then in ((some, other), (other, some), ("[]", some), (some, "[]")):
                with self.subTest(form=form, first=first, then=then):
                    shutil.rmtree(self.folder / "o", ignore_errors=True)
                    shutil.rmtree(self.folder / "p", ignore_errors=True)
                    self.write("s.toml", scene.replace("FIELDS", first))
                    self.barchan("run", "s.toml", "--quiet", "--threads", "1", "--out", "o")
                    self.write("s.toml", scene.replace("FIELDS", then).replace("end = 1e-2", "end = 2e-2"))
                    self.barchan("run", "s.toml", "--quiet", "--threads", "1", "--out", "o", "--restart", "latest")
                    self.barchan("run", "s.toml", "--quiet", "--threads", "1", "--out", "p")
                    for name in ("s_000003.vtp", "s_000004.vtp"):
                        self.assertEqual((self.folder / "o" / name).read_bytes(), (self.folder / "p" / name).read_bytes(), name)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
