#!/usr/bin/python3
"""Scenes and folders of runs that another person made: damaged files, odd values, names and links that lead out of the folder, names that are programs.

    /usr/bin/python3 tests/cli/test_strangers.py PROGRAM ROOT

Nothing crashes, hangs or ends with a traceback; nothing outside of the folder is read into a page, written or executed (docs/security.md). The environment variable BARCHAN_DAMAGES says how
many damaged files of each kind are tried (default 60; a twentieth of them for what starts a process or draws).
"""

import base64
import contextlib
import hashlib
import html.parser
import io
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from unittest import mock

PROGRAM = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/barchan").resolve()
ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2]).resolve()
sys.path.insert(0, str(ROOT / "python"))
os.environ["BARCHAN_PROGRAM"] = str(PROGRAM)
import barchan  # noqa: E402
from barchan import files  # noqa: E402
from barchan.report import command, gather, page  # noqa: E402
from barchan.report.shapes import ANY, RUN, SALTATION, fitting  # noqa: E402

DAMAGES = int(os.environ.get("BARCHAN_DAMAGES", "60"))
LONGEST = 5.  # s of processor time for one file
SECRET = "the words of a file that is no business of others"
SCENE = """title = "water"
spacing = 0.02
[domain]
size = [0.2, 0.2]
periodic = ["x"]
[phases.water]
kind = "fluid"
density = 1000
viscosity = 1e-4
sound-speed = 20
[phases.wall]
kind = "wall"
[interactions]
water-water = 2.6
water-wall = 2.6
[[fill]]
phase = "wall"
shape = { sides = ["bottom", "top"] }
[[fill]]
phase = "water"
shape = "the-rest"
velocity = [0.5, 0]
[[profile]]
name = "across"
phase = "water"
from = [0.1, 0.01]
to = [0.1, 0.19]
count = 10
[[grid]]
name = "all"
phase = "water"
min = [0, 0]
max = [0.2, 0.2]
spacing = 0.04
[time]
end = 0.01
largest-speed = 1
[output]
every = 0.005
"""
ODD = [None, True, 0, -1, .5, 1e308, 10 ** 30, float("nan"), float("inf"), "", "x", "<script>alert(1)</script>", "\ud800", "$\\frac{$", "a\0b", "../../x" * 99, [], [1], ["x", None, {}], {},
       {"a": 1}, {"name": {}, "list": 3, "count": "x"}, [[[[{}]]]], [{"name": 3}, 4, {"of": []}]]


def damaged(content, chance):
    """The bytes of a file with one damage of many kinds; some damages change nothing, and then the last byte is missing."""
    bad = changed(content, chance)
    return bad if bad != content else content[:-1]


def changed(content, chance):
    at, kind = chance.randrange(len(content)), chance.randrange(7)
    if kind == 0:
        return content[:at]
    if kind == 1:
        return content[:at] + bytes([content[at] ^ 1 << chance.randrange(8)]) + content[at + 1:]
    if kind == 2:
        return content[:at] + chance.randbytes(chance.randrange(1, 64)) + content[at + chance.randrange(64):]
    if kind == 3:  # a part twice or not at all
        end = min(at + chance.randrange(200), len(content))
        return content[:end] + content[at:] if chance.randrange(2) else content[:at] + content[end:]
    words = list(re.finditer(rb"[-+0-9.eE]+" if kind < 6 else rb"[A-Za-z_]+", content[:20000]))
    hit = chance.choice(words)
    odd = [b"0", b"-1", b"3", b"1e999", b"nan", b"4294967296", b"9223372036854775807", b"99999999999999999999", b"", b"x", b"../../../etc/passwd", b"/etc/passwd", b"\xff\xfe", b"<!DOCTYPE a [",
           b"Float32", b"UInt8", b"String", b"9" * 5000, b"[" * 3000, b"null", b'"']
    return content[:hit.start()] + chance.choice(odd) + content[hit.end():]


class Scripts(html.parser.HTMLParser):
    """Elements and attributes of a page that a browser would execute or load."""

    def __init__(self, text):
        super().__init__()
        self.found = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag in ("script", "iframe", "object", "link", "base", "form", "embed"):
            self.found.append(tag)
        self.found += [f"{tag} {name}" for name, value in attributes if name.startswith("on") or re.match(r"\s*(javascript|https?|file):", value or "")]


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shared = tempfile.TemporaryDirectory()
        cls.addClassCleanup(shared.cleanup)
        cls.top = pathlib.Path(shared.name)
        (cls.top / "water.toml").write_text(SCENE)
        for name, more in (("vtp", []), ("vtu", ["--set", "output.format=vtu"])):
            ended = subprocess.run([PROGRAM, "run", cls.top / "water.toml", "--out", cls.top / name, "--threads", "1", "--quiet", *more], capture_output=True, text=True)
            assert ended.returncode == 0, ended.stderr
        (cls.top / "secret.txt").write_text(SECRET)
        piece = cls.top / "pieces/water_000001"  # a frame in pieces, as ranks write it
        piece.mkdir(parents=True)
        for k in range(2):
            shutil.copy(cls.top / "vtp/water_000001.vtp", piece / f"water_000001_000{k}.vtp")
        sources = "".join(f'<Piece Source="water_000001/water_000001_000{k}.vtp"/>\n' for k in range(2))
        (cls.top / "pieces/water_000001.pvtp").write_text('<?xml version="1.0"?>\n<VTKFile type="PPolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n  <PPolyData GhostLevel="0">\n'
                                                          + sources + "  </PPolyData>\n</VTKFile>\n")

    def setUp(self):
        self.folder = self.top / self.id().rsplit(".", 1)[1]
        self.folder.mkdir()
        self.addCleanup(shutil.rmtree, self.folder)

    def copy(self, source="vtp", columns=4):
        """The run in a folder of its own, with some columns of its history: each has a plot, which takes time."""
        folder = pathlib.Path(shutil.copytree(self.top / source, self.folder / "run", dirs_exist_ok=True))
        lines = (folder / "history.csv").read_text().splitlines()
        (folder / "history.csv").write_text("".join(",".join(line.split(",")[:columns]) + "\n" for line in lines))
        return folder

    def page(self, folder, drawn=False, **more):
        """The page of a run without its plan, which a program makes; not `drawn`: all is read, but plots and pictures stay empty, which takes a tenth of the time."""
        with contextlib.redirect_stderr(io.StringIO()), contextlib.ExitStack() as stubs:
            for name in () if drawn else ("plots.lines", "plots.grid_plots", "pictures.draw"):
                stubs.enter_context(mock.patch(f"barchan.report.{name}", return_value=[] if name == "plots.grid_plots" else "data:image/png;base64,"))
            text = command.make(folder, **{"plan": False, **more}).read_text()
        self.assertEqual(Scripts(text).found, [])
        return text

    def try_damages(self, content, read, count=DAMAGES, seed=1):
        """`read(bytes)` of so many damaged contents ends soon, with nothing or with a BarchanError; returns how many were refused."""
        chance, refused = random.Random(seed), 0
        for number in range(count):
            bad, begin = damaged(content, chance), time.process_time()
            try:
                read(bad)
            except barchan.BarchanError as error:
                refused += 1
                self.assertGreater(len(error.message), 10)
            except Exception as error:
                raise AssertionError(f"damage {number}: {type(error).__name__}: {error}") from error
            self.assertLess(time.process_time() - begin, LONGEST, f"damage {number}")
        return refused


class Damage(Case):
    """Files that were damaged on their way."""

    def read_as(self, name, read):
        file = self.folder / name

        def one(content):
            file.write_bytes(content)
            read(file)
        return one

    def test_frames(self):
        for source, name in (("vtp/water_000001.vtp", "a.vtp"), ("vtu/water_000001.vtu", "a.vtu")):
            self.assertGreater(self.try_damages((self.top / source).read_bytes(), self.read_as(name, barchan.Frame)), DAMAGES // 3)

    def test_lists_of_pieces(self):
        shutil.copytree(self.top / "pieces/water_000001", self.folder / "water_000001")
        self.assertEqual(len(barchan.Frame(self.top / "pieces/water_000001.pvtp")), 2 * len(barchan.Frame(self.top / "vtp/water_000001.vtp")))
        self.assertGreater(self.try_damages((self.top / "pieces/water_000001.pvtp").read_bytes(), self.read_as("a.pvtp", barchan.Frame)), DAMAGES // 3)

    def test_series(self):
        self.copy()
        self.assertGreater(self.try_damages((self.top / "vtp/water.pvd").read_bytes(), self.read_as("run/water.pvd", lambda file: [len(frame) for frame in barchan.open(file)])), DAMAGES // 3)

    def test_tables(self):
        self.assertGreater(self.try_damages((self.top / "vtp/history.csv").read_bytes(), self.read_as("history.csv", barchan.table)), DAMAGES // 5)

    def test_grids(self):
        from barchan.frame import Grid
        self.assertGreater(self.try_damages((self.top / "vtp/grid_all.vti").read_bytes(), self.read_as("a.vti", Grid)), DAMAGES // 5)

    def test_reports(self):
        """A page is made of all that is left."""
        few = max(DAMAGES // 20, 1)
        for seed, name in enumerate(("run.json", "history.csv", "water.pvd", "water_000001.vtp", "profile_across.csv", "grid_all.vti")):
            folder, whole, first = self.copy(), (self.top / "vtp" / name).read_bytes(), []

            def one(content):
                (folder / name).write_bytes(content)
                self.page(folder, drawn=not first)
                first.append(content)
            self.try_damages(whole, one, few, seed)
            shutil.rmtree(folder)

    def test_reports_of_vtu_and_of_pieces(self):
        self.assertIn("<img", self.page(self.copy("vtu"), drawn=True))
        shutil.rmtree(self.folder / "run")
        self.assertIn("its end is missing", self.broken_piece())

    def broken_piece(self):
        folder = self.copy()
        shutil.copytree(self.top / "pieces", folder, dirs_exist_ok=True)
        pvd = (folder / "water.pvd").read_text()
        (folder / "water.pvd").write_text(pvd.replace("water_000001.vtp", "water_000001.pvtp"))
        piece = folder / "water_000001/water_000001_0001.vtp"
        piece.write_bytes(piece.read_bytes()[:-100])
        return self.page(folder)

    def test_cells_that_do_not_fit(self):
        """Python needs no cells, but ParaView trusts them: pvstate/render checks them first."""
        from barchan.frame import check
        file = pathlib.Path(barchan.write_grains(self.folder / "a.vtp", [[0, 0], [1, 0], [0, 1]], .1))
        check(file)
        whole = file.read_bytes()
        at = whole.rindex((0).to_bytes(8, "little") + (1).to_bytes(8, "little") + (2).to_bytes(8, "little"))
        for place, number in ((at, 3), (at, 1 << 62), (at + 8, -1), (at + 32, 4), (at + 48, 4)):  # three corners, a length, three ends
            file.write_bytes(whole[:place] + number.to_bytes(8, "little", signed=True) + whole[place + 8:])
            self.assertEqual(len(barchan.Frame(file)), 3)
            with self.assertRaisesRegex(barchan.Unreadable, "a.vtp: the cells of Verts do not fit the points"):
                check(file)

    def ask(self, statuses, *words):
        ended = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, timeout=60)
        self.assertIn(ended.returncode, statuses, (words, ended.stderr[-500:]))

    def test_the_program(self):
        """Scenes, checkpoints, frames, lists: refused with a status that says so, or taken; never a signal."""
        few, whole = max(DAMAGES // 20, 1), self.top / "vtp"
        frames = [("a.vtp", whole / "water_000001.vtp"), ("a.vtu", self.top / "vtu/water_000001.vtu"), ("a.pvtp", self.top / "pieces/water_000001.pvtp"), ("run/water.pvd", whole / "water.pvd")]
        shutil.copytree(self.top / "pieces/water_000001", self.folder / "water_000001")
        self.copy()
        for name, file in frames:
            self.try_damages(file.read_bytes(), self.read_as(name, lambda bad, file=file: self.ask((0, 1, 4), "compare", bad, file)), few)
        self.try_damages(SCENE.encode(), self.read_as("a.toml", lambda bad: self.ask((0, 2, 3), "plan", bad, "--set", "time.end=0.001")), few)
        scene = self.top / "water.toml"
        self.try_damages((whole / "water.checkpoint").read_bytes(),
                         self.read_as("a.checkpoint", lambda bad: self.ask((2,), "run", scene, "--set", "time.end=0.011", "--quiet", "--out", self.folder / "new", "--restart", bad)), few)


class Values(Case):
    """run.json with values of every other type."""

    def paths(self, shape, at=()):
        yield at
        for key, inner in shape.items() if isinstance(shape, dict) else enumerate(shape) if isinstance(shape, list) else ():
            yield from self.paths(inner, (*at, "x" if key == ANY else key))

    def test_every_key_of_run_json(self):
        whole = json.loads((self.top / "vtp/run.json").read_text())
        whole["retreats"] = {"count": 1, "list": [{"step": 1, "time": 1, "back_to": 0, "share_of_step": .5, "reason": "r"}]}
        whole["repeats"], whole["threads_used"] = [{"name": "a", "of": "b", "interval": 1, "calls": 3, "seconds": 1}], [{"threads": 1, "steps": 2, "seconds": 1}, {"threads": 2, "steps": 2, "seconds": 1}]
        whole["warnings"], whole["scene"]["set"] = ["w"], ["time.end=0.01"]
        tried = 0
        for path in self.paths(RUN):
            for odd in ODD:
                run = json.loads(json.dumps(whole))
                if not path:
                    run = odd
                else:
                    at = run
                    for key in path[:-1]:
                        at = at[key]
                    at[path[-1]] = odd
                (self.folder / "run.json").write_text(json.dumps(run))
                g = gather.gather(self.folder, with_plan=False)
                text = page.make(g)
                self.assertNotIn("could not be made", text, (path, odd))
                if str(odd).startswith("<"):
                    self.assertEqual(Scripts(text).found, [], path)
                tried += 1
        self.assertGreater(tried, 1000)

    def test_a_wrong_type_is_named(self):
        remarks = []
        run = fitting({"steps": "many", "scene": {"set": ["a=1", 3], "title": None}, "seconds": {"kick": [], "pack": 1}, "new": {}}, RUN, "run.json", remarks)
        self.assertEqual(run, {"scene": {"set": ["a=1"]}, "seconds": {"pack": 1}})
        self.assertEqual(remarks, ["run.json: steps is a text; expected a number: it is left out", "run.json: scene.set[1] is a number; expected a text: it is left out",
                                   "run.json: seconds.kick is a list; expected a number: it is left out"])
        self.assertEqual(fitting([], SALTATION, "saltation_a.json", remarks), {})

    def test_documents_that_are_none(self):
        for text in ("[" * 100000, "", "{", "\ufeff{}", "1" * 10000, "NaN"):
            (self.folder / "run.json").write_text(text)
            self.assertIn("run.json", page.make(gather.gather(self.folder, with_plan=False)))

    def test_words_that_a_page_or_a_plot_would_take_for_more(self):
        folder, evil = self.copy(columns=7), '<script>alert(1)</script>"\'><img src=x onerror=alert(1)>&$x_{$'
        run = json.loads((folder / "run.json").read_text())
        run.update(end_reason=f"breakdown: {evil}", warnings=[evil], host=evil, version=evil, compiler=evil, seconds={evil: 1}, time_step_limits={evil: 1}, pairs={evil: 1}, particles={evil: 1})
        run["scene"].update(title=evil, file=evil, set=[evil])
        (folder / "run.json").write_text(json.dumps(run))
        lines = (folder / "history.csv").read_text().splitlines()
        names = lines[0].split(",")
        lines[0] = ",".join([names[0], *(f"{evil.replace(',', '')}{k}_force_x [{evil}]" for k in range(1, len(names)))])
        (folder / "history.csv").write_text("\n".join(lines) + "\n")
        text = self.page(folder, drawn=True)
        self.assertNotIn("could not be made", text)
        self.assertIn("&lt;script&gt;", text)


class Names(Case):
    """Names and links that lead out of the folder, and names that are programs."""

    def test_lists_name_files_below_their_folder(self):
        folder, pvd = self.copy(), (self.top / "vtp/water.pvd").read_text()
        shutil.copy(folder / "water_000000.vtp", self.folder / "outside.vtp")
        for name in (str(self.folder / "outside.vtp"), "../outside.vtp", "a/../../outside.vtp", ""):
            (folder / "water.pvd").write_text(pvd.replace("water_000000.vtp", name))
            with self.assertRaisesRegex(barchan.Unreadable, "water.pvd: it names .*; expected a file below the folder of the list"):
                barchan.open(folder)
            ended = subprocess.run([PROGRAM, "compare", folder / "water.pvd", self.top / "vtp/water.pvd"], capture_output=True, text=True)
            self.assertEqual(ended.returncode, 4)
            self.assertIn("is not a file below the folder of the list", ended.stderr)
        (folder / "water.pvd").write_text(pvd)
        (folder / "water_000000.vtp").unlink()
        (folder / "water_000000.vtp").symlink_to("../outside.vtp")
        with self.assertRaisesRegex(barchan.Unreadable, "is a link to a file outside of"):
            barchan.open(folder)[0]
        self.assertEqual(len(barchan.open(folder)[1]), len(barchan.Frame(self.folder / "outside.vtp")))
        self.folder.joinpath("link").symlink_to("run")  # a folder that the user names may be a link
        self.assertEqual(len(barchan.open(self.folder / "link")[1]), len(barchan.open(folder)[1]))
        a = self.folder / "a.pvtp"
        a.write_text((self.top / "pieces/water_000001.pvtp").read_text().replace("water_000001/water_000001_0001.vtp", str(self.folder / "outside.vtp")))
        with self.assertRaisesRegex(barchan.Unreadable, "it names"):
            barchan.Frame(a)

    def test_links_and_pipes_in_the_folder_of_a_run(self):
        """What lies outside is not read into the page; a pipe is not waited for; what a link leads to is not written."""
        for name in ("history.csv", "run.json", "water.pvd", "water_000001.vtp", "profile_across.csv", "grid_all.vti", "pictures/airflow_000000.png", "pictures/airflow.mp4"):
            for trap in ("link", "pipe", "folder", "device", "circle"):
                folder = self.copy()
                (folder / "pictures").mkdir(exist_ok=True)
                (folder / name).unlink(missing_ok=True)
                if trap == "pipe":
                    os.mkfifo(folder / name)
                elif trap == "folder":
                    (folder / name).mkdir()
                else:
                    (folder / name).symlink_to({"link": self.top / "secret.txt", "device": "/dev/zero", "circle": pathlib.Path(name).name}[trap])
                begin = time.process_time()
                text = self.page(folder, film=True)  # a pipe that is waited for is a test that never ends
                self.assertLess(time.process_time() - begin, LONGEST, (name, trap))
                self.assertNotIn(SECRET, text, (name, trap))
                self.assertNotIn(base64.b64encode(SECRET.encode()).decode()[:20], text, (name, trap))
                self.assertIn(pathlib.Path(name).name, text, (name, trap))
                shutil.rmtree(folder)

    def test_pictures_are_pictures(self):
        folder = self.copy()
        (folder / "pictures").mkdir()
        (folder / "pictures/airflow_000000.png").write_text(SECRET)
        text = self.page(folder)
        self.assertIn("airflow_000000.png: is no .png", text)

    def test_a_page_is_not_written_through_a_link(self):
        folder, victim = self.copy(), self.folder / "victim"
        victim.write_text("mine")
        for name in ("report.html", "report.html.part"):
            (folder / name).unlink(missing_ok=True)
            (folder / name).symlink_to(victim)
            self.assertIn("<html", self.page(folder))
            self.assertEqual(victim.read_text(), "mine")
        (folder / "report.html").unlink()
        os.mkfifo(folder / "report.html.part")
        self.assertIn("<html", self.page(folder))

    def named_scene(self, folder, file, **more):
        run = json.loads((folder / "run.json").read_text())
        run["scene"].update(file=str(file), **more)
        (folder / "run.json").write_text(json.dumps(run))

    def test_only_the_scene_of_the_run_is_shown(self):
        folder, other = self.copy(), self.folder / "other.toml"
        other.write_text(f'# {SECRET}\n{SCENE}')
        (self.folder / "config.toml").write_text(f'password = "{SECRET}"\n')
        (folder / "link.toml").symlink_to(other)
        (folder / "config.toml").write_text(f'password = "{SECRET}"\n')
        for file in (self.top / "secret.txt", "../other.toml", other, "../config.toml", "config.toml", folder / "config.toml", "link.toml", "/dev/zero", "/etc/passwd", "\0", "x" * 5000, "."):
            for checksum in ("", "0" * 64, hashlib.sha256(SECRET.encode()).hexdigest() if file != self.top / "secret.txt" else ""):
                self.named_scene(folder, file, sha256=checksum)
                text = self.page(folder)
                self.assertNotIn(SECRET, text, file)
                self.assertNotIn("root:", text, file)
                self.assertIn("What this page could not read", text)
        self.named_scene(folder, other, sha256=hashlib.sha256(other.read_bytes()).hexdigest())
        self.assertIn(SECRET, self.page(folder))  # who made run.json has read that file
        other.write_text(other.read_text() + "# changed\n")
        self.assertNotIn(SECRET, self.page(folder))
        text = self.page(folder, scene=other)
        self.assertTrue(SECRET in text and "was changed after the run began, or is another file" in text)
        with self.assertRaisesRegex(barchan.SceneError, "--scene .*config.toml: is no scene: it has no phases"):
            self.page(folder, scene=self.folder / "config.toml")
        (folder / "water.toml").write_text(SCENE)
        self.named_scene(folder, "elsewhere/water.toml", sha256="")
        self.assertIn('title = &quot;water&quot;', self.page(folder))  # it lies in the folder of the run

    def test_a_run_states_the_checksum_of_its_scene(self):
        self.assertEqual(json.loads((self.top / "vtp/run.json").read_text())["scene"]["sha256"], hashlib.sha256(SCENE.encode()).hexdigest())
        text = self.page(self.copy(), plan=True)
        self.assertIn('title = &quot;water&quot;', text)
        self.assertIn("The matrix of interactions", text)

    def evil(self):
        """A program that leaves a trace."""
        file = self.folder / "evil.py"
        file.write_text(f'open({str(self.folder / "PWNED")!r}, "w").write("executed")\n')
        return file

    def test_a_scene_names_no_program(self):
        evil = self.evil()
        (self.folder / "pvstate").mkdir()
        shutil.copy(evil, self.folder / "pvstate/evil.py")
        (self.folder / "pvstate/render").write_text("")
        scene = self.folder / "scene.toml"
        for state, words in (("evil.py", 'is not the name of a state'), (str(evil), 'is not the name of a state'), ("./evil", 'is not the name of a state'), ("evil", 'there is no state "evil" in pvstate'),
                             ("airflow,evil", 'there is no state "evil"'), ("render_frames", "there is no state"), ("../pvstate/airflow", "is not the name of a state")):
            scene.write_text(f'state = "{state}"\n{SCENE}')
            for verb in ("plan", "run"):
                ended = subprocess.run([PROGRAM, verb, scene], capture_output=True, text=True, cwd=self.folder)
                self.assertEqual(ended.returncode, 2, state)
                self.assertRegex(ended.stderr, r"scene.toml:1:9: state: ")
                self.assertIn(words, ended.stderr)
                self.assertIn('"airflow"', ended.stderr)
        self.assertFalse((self.folder / "out").exists())

    def test_a_run_names_no_program(self):
        evil, folder = self.evil(), self.copy()
        shutil.copy(evil, folder / "evil.py")
        render = ROOT / "pvstate/render"
        for state in ("evil.py", str(evil), "./evil.py", "../evil", "evil", "barchan_view", "render_frames", "airflow,evil.py", "-x"):
            run = json.loads((folder / "run.json").read_text())
            run["scene"]["state"] = state
            (folder / "run.json").write_text(json.dumps(run))
            ended = subprocess.run([render, folder / "water.pvd"], capture_output=True, text=True, cwd=folder, timeout=60)
            self.assertEqual(ended.returncode, 2, ended.stderr)
            self.assertRegex(ended.stderr, "render: run.json names the state .*, which is not in pvstate/; known are airflow, ")
        text = self.page(folder, render=True)
        self.assertIn("--render: render: run.json names the state", text)
        self.assertFalse((self.folder / "PWNED").exists())
        self.assertFalse((folder / "PWNED").exists())

    def test_pictures_are_not_written_through_a_link(self):
        folder, outside = self.copy(), self.folder / "outside"
        outside.mkdir()
        (outside / "airflow_000000.png").write_text("mine")
        (folder / "pictures").symlink_to(outside)
        ended = subprocess.run([ROOT / "pvstate/render", folder / "water.pvd"], capture_output=True, text=True, timeout=60)
        self.assertEqual((ended.returncode, (outside / "airflow_000000.png").read_text()), (4, "mine"), ended.stderr)
        self.assertIn("is a link to a file outside of", ended.stderr)

    def test_settings_of_the_folder_it_is_started_in_are_not_read(self):
        folder = self.copy()
        (folder / "matplotlibrc").write_text("backend: module://evil\ntext.usetex: True\nfigure.dpi: nonsense\n")
        for name in ("evil.py", "numpy.py", "json.py", "matplotlib.py"):
            shutil.copy(self.evil(), folder / name)
        ended = subprocess.run([PROGRAM, "report", ".", "--no-plan"], capture_output=True, text=True, cwd=folder)
        self.assertEqual((ended.returncode, ended.stderr, ended.stdout), (0, "", "report    report.html\n"))
        self.assertFalse((self.folder / "PWNED").exists())

    def test_files_that_memory_cannot_hold(self):
        """Sparse files of a terabyte, which an archive of some bytes can hold."""
        folder = self.copy()
        for name in ("history.csv", "water.pvd", "run.json", "water_000001.vtp"):
            with (folder / name).open("r+b") as file:
                file.truncate(1 << 40)
        begin = time.process_time()
        text = self.page(folder)
        self.assertLess(time.process_time() - begin, LONGEST)
        self.assertIn("bytes are too many", text)
        with self.assertRaisesRegex(barchan.Unreadable, "water_000001.vtp"):
            barchan.Frame(folder / "water_000001.vtp")

    def test_xml_that_grows(self):
        laughs = '<!DOCTYPE a [<!ENTITY a "ha">' + "".join(f'<!ENTITY a{k} "{f"&a{k - 1 if k else str()};" * 20}">' for k in range(9)) + "]><VTKFile>&a8;</VTKFile>"
        for name, read in (("a.pvd", barchan.open), ("a.pvtp", barchan.Frame), ("a.vtp", barchan.Frame)):
            (self.folder / name).write_text(laughs)
            with self.assertRaisesRegex(barchan.Unreadable, "declares a document type"):
                read(self.folder / name)
        with self.assertRaises(barchan.Unreadable):
            files.xml("deep.pvd", "<a>" * 200000)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
