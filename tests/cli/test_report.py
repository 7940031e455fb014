#!/usr/bin/python3
"""barchan report: pages of runs that ended, broke down, were killed, go on; each is whole, needs no other file, and says what run.json, plan and history say.

    /usr/bin/python3 tests/cli/test_report.py PROGRAM ROOT

Where Chromium is installed (scripts/setup --all), it opens a page: a picture that is not blank, and no request leaves it.
"""

import contextlib
import html.parser
import io
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import unittest

import numpy

PROGRAM = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build/barchan").resolve()
ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2]).resolve()
sys.path.insert(0, str(ROOT / "python"))
os.environ["BARCHAN_PROGRAM"] = str(PROGRAM)
from barchan.report import command, gather, parts, plots  # noqa: E402
from barchan.report.page import make as make_page  # noqa: E402
from barchan.tables import Table  # noqa: E402

MOST_BYTES = 10_000_000
VOID = {"meta", "img", "br", "link", "input", "hr", "use", "path"}


class Page(html.parser.HTMLParser):
    """The texts, links and sources of a page; whether its elements are closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.wrong, self.sources, self.texts, self.images, self.svgs, self.ids = [], [], [], [], [], 0, []
        self.feed(text)
        self.text = " ".join(" ".join(self.texts).split())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.sources += [attributes[name] for name in ("src", "href", "xlink:href", "data", "action", "poster", "srcset") if name in attributes]
        self.images += [attributes["src"]] if tag == "img" else []
        self.svgs += tag == "svg"
        self.ids += [attributes["id"]] if "id" in attributes else []
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if tag in VOID:
            return
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.texts.append(data)


class Reports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.run_scene("verification/poiseuille.toml", "poiseuille")
        cls.run_scene("verification/hop.toml", "broken", ["time.end=0.2"])
        cls.run_scene("verification/hop.toml", "hop", ["time.end=0.02", "output.history-every=0.01"])

    @classmethod
    def run_scene(cls, scene, name, settings=()):
        return subprocess.run([PROGRAM, "run", ROOT / "scenes" / scene, "--out", cls.folder / name, "--quiet", "--threads", "1", *(w for s in settings for w in ("--set", s))],
                              capture_output=True).returncode

    def report(self, name, *options):
        """The page of a run, made in this process: matplotlib is loaded once."""
        with contextlib.redirect_stdout(io.StringIO()) as said:
            self.assertEqual(command.main([str(self.folder / name), *options]), 0)
        file = self.folder / name / "report.html"
        self.assertEqual(said.getvalue(), f"report    {file}\n")
        return self.check(file)

    def check(self, file):
        """A page: whole, small, and nothing in it leads out of it."""
        text = file.read_text()
        self.assertLess(len(text.encode()), MOST_BYTES)
        page = Page(text)
        self.assertEqual((page.open, page.wrong), ([], []))
        self.assertEqual(len(page.ids), len(set(page.ids)))
        for source in page.sources:
            if not source.startswith((ROOT / "docs/faq.md").as_uri() + "#"):
                self.assertRegex(source, r"^(data:(image/(png|jpeg)|video/mp4);base64,|#)", source[:80])
        references = re.findall(r"url\(([^)]*)\)|@import([^;]*)", re.sub(r"<pre>.*?</pre>", "", text, flags=re.S))
        self.assertTrue(all(where.startswith("#") and not imported for where, imported in references))
        for each in [s[1:] for s in page.sources if s.startswith("#")] + [where[1:] for where, _ in references]:
            self.assertIn(each, page.ids)
        self.assertNotRegex(re.sub(r"data:[\w/;]+,[\w+/=]*|<pre>.*?</pre>|<desc>.*?</desc>", "", text, flags=re.S), r"https?://|<script|<iframe|<object|<link")
        self.assertIn("default-src 'none'", text)
        return page

    def test_a_run_that_ended(self):
        page = self.report("poiseuille")
        run = json.loads((self.folder / "poiseuille/run.json").read_text())
        for words in ("Plane Poiseuille flow from rest", "The run ended at 1 s of 1 s, after 3000 steps. Exit status 0.", "The program gave no warning", run["commit"],
                      run["instruction_set"], "water_equivalent_friction_velocity", "profile across", "wall-shear bottom", "probe axis", "grid channel", "velocity mean",
                      "Skipped , because this scene does not need it: ", "grain contacts", "corrected to first order", "particle-steps a second", 'title = "Plane Poiseuille'):
            self.assertIn(words, page.text)
        for name in run["passes"]:
            self.assertIn(name, page.text)
        self.assertEqual(len(page.images), 3)
        self.assertGreater(page.svgs, 15)

    def test_a_run_that_broke_down(self):
        ended = subprocess.run([PROGRAM, "report", self.folder / "broken"], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (0, f"report    {self.folder / 'broken/report.html'}\n", ""))
        page = self.check(self.folder / "broken/report.html")
        for words in ("The run broke down at", "of 0.2 s", "Exit status 3.", "escaped through the lower side", "the first bad state", "time.end=0.2"):
            self.assertIn(words, page.text)
        self.assertEqual(len(page.images), 4)

    def copy(self, name, **changes):
        """The run `hop` in another folder, with a changed run.json."""
        shutil.copytree(self.folder / "hop", self.folder / name)
        run = json.loads((self.folder / name / "run.json").read_text())
        run.update(changes)
        (self.folder / name / "run.json").write_text(json.dumps(run))
        return self.folder / name

    def test_a_run_that_goes_on_or_was_killed(self):
        gone = subprocess.Popen(["true"])
        gone.wait()
        folder = self.copy("running", end_reason="running", process=os.getpid(), host="elsewhere")
        self.assertIn("The run is still running; it has come to 0.02 s of 0.02 s.", self.report("running", "--no-plan").text)
        run = json.loads((folder / "run.json").read_text())
        (folder / "run.json").write_text(json.dumps({**run, "process": gone.pid, "host": socket.gethostname()}))
        page = self.report("running", "--no-plan")
        self.assertIn("The run was killed, or its machine stopped", page.text)
        self.assertIn("--restart latest", page.text)

    def test_warnings_stand_on_top(self):
        self.copy("warned", warnings=["a <b>bold</b> warning & more", "another"], end_reason="SIGTERM",
                  retreats={"count": 2, "list": [{"step": 900, "time": .1, "back_to": 768, "share_of_step": .5, "reason": "it was too fast"}]})
        page = self.report("warned", "--no-plan")
        self.assertIn("a <b>bold</b> warning & more", page.text)
        self.assertIn("2 warnings of the program", page.text[:800])
        self.assertRegex(page.text, "The run went back 2 times.* 900 0.1 768 0.5 it was too fast")
        self.assertIn("The run was stopped by a signal at 0.02 s of 0.02 s, after", page.text)

    def test_a_warning_leads_to_its_question(self):
        faq, asked = (ROOT / "docs/faq.md").read_text(), (
            ('interactions.a-b: under the cubic spline particles pair with more than 2.4 spacings', "under-the-cubic-spline-particles-pair"),
            ('9 particles of "water", 0.5 % of its mass at the start, left through the open side (top)', "particles-left-through-the-open-side"),
            ('"air" was pulled with 1.4 Pa, a mean over the last tenth', "the-wind-pulls-much-harder-than-the-scene-says"),
            ('the ground took 1.4 Pa from "air"', "the-ground-takes-more-than-the-wind-that-the-scene-states"),
            ('the flux of "sand" still grows at the outflow', "the-ground-takes-more-than-the-wind-that-the-scene-states"),
            ("the ground is dry", None))
        self.copy("asked", warnings=[warning for warning, _ in asked])
        page = self.report("asked", "--no-plan")
        links = [source.split("#")[1] for source in page.sources if source.startswith("file:")]
        self.assertEqual(links, [anchor for _, anchor in asked if anchor])
        for _, heading in parts.QUESTIONS:
            self.assertIn(f"\n## {heading}\n", faq)
        self.assertEqual([s for s in self.report("broken", "--no-plan").sources if s.startswith("file:")],
                         [(ROOT / "docs/faq.md").as_uri() + "#a-body-passed-a-wall-or-a-particle-left-the-domain"])

    def test_how_to_cite(self):
        run = json.loads((self.folder / "hop/run.json").read_text())
        text = self.report("hop", "--no-plan").text
        title = re.search(r'^title: "(.*)"$', (ROOT / "CITATION.cff").read_text(), re.M)[1]
        self.assertIn(f"The Barchan developers: {title}, version {run['version']} (commit {run['commit']}). Method: A. Halik, R. Imin, M. Geni, A. Jin, Y. Mou (2015): Numerical Modeling", text)
        from unittest import mock
        with mock.patch.object(parts, "shared", lambda name: None):   # an installation without documents
            self.assertIn("The Barchan developers: Barchan, version", self.report("hop", "--no-plan").text)

    def test_damage_is_said_and_the_rest_is_shown(self):
        folder = self.folder / "damaged"
        self.run_scene("verification/poiseuille.toml", "damaged", ["time.end=0.2"])
        run = json.loads((folder / "run.json").read_text())
        (folder / "run.json").write_text(json.dumps({**run, "scene": {**run["scene"], "file": "gone.toml"}}))
        (folder / "history.csv").write_text("time [s],x\n0,abc\n")
        (folder / "profile_across.csv").write_text("")
        (folder / "poiseuille_000000.vtp").write_bytes((folder / "poiseuille_000000.vtp").read_bytes()[:400])
        page = self.report("damaged")
        for words in ("What this page could not read", "history.csv: ", "profile_across.csv", "poiseuille_000000.vtp", "gone.toml is no longer there"):
            self.assertIn(words, page.text)
        self.assertEqual(len(page.images), 2)
        (folder / "run.json").write_text("{")
        self.assertIn("run.json cannot be read", self.report("damaged").text)
        (folder / "poiseuille.pvd").unlink()
        (folder / "run.json").unlink()
        ended = subprocess.run([PROGRAM, "report", folder], capture_output=True, text=True)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("no series (.pvd) in this folder; a report needs the folder of a run", ended.stderr)

    def test_a_page_that_cannot_be_written(self):
        ended = subprocess.run([PROGRAM, "report", self.folder / "hop", "--no-plan", "-o", self.folder / "none/page.html"], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr.count("\n")), (4, 1))
        self.assertIn("cannot write", ended.stderr)

    def test_pictures_that_were_rendered_are_taken(self):
        folder = self.copy("rendered")
        (folder / "pictures").mkdir()
        from PIL import Image
        noise = numpy.random.default_rng(1).integers(0, 255, (400, 700, 3), numpy.uint8)  # compresses badly
        Image.fromarray(noise).save(folder / "pictures/airflow_000000.png")
        for k in range(1, 5):
            shutil.copy(folder / "pictures/airflow_000000.png", folder / f"pictures/airflow_{k:06d}.png")
        (folder / "pictures/airflow.mp4").write_bytes(b"\0\0\0\x18ftypisom" + b"0" * 1000)
        page = self.report("rendered", "--no-plan")
        self.assertEqual([uri[:16] for uri in page.images], ["data:image/jpeg;"] * 3)
        self.assertIn("airflow: frame 2, 0.002 s", page.text)
        self.assertIn("airflow.mp4 in the folder pictures", page.text)
        self.assertTrue(any(source.startswith("data:video/mp4") for source in self.report("rendered", "--no-plan", "--film").sources))

    @unittest.skipUnless(shutil.which("chromium"), "Chromium is not installed")
    def test_chromium_opens_it_and_nothing_leaves(self):
        if not (self.folder / "poiseuille/report.html").exists():
            self.report("poiseuille")
        picture, log = self.folder / "page.png", self.folder / "net.json"
        subprocess.run(["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update",
                        "--disable-sync", f"--user-data-dir={self.folder / 'profile'}", f"--screenshot={picture}", "--window-size=1400,2000", f"--log-net-log={log}",
                        (self.folder / "poiseuille/report.html").as_uri()], capture_output=True, timeout=120, check=True)
        from PIL import Image
        pixels = numpy.asarray(Image.open(picture).convert("RGB"))
        self.assertGreater(len(numpy.unique(pixels.astype(numpy.int32) @ [65536, 256, 1])), 500)
        self.assertGreater((pixels.min(axis=2) < 100).mean(), .005)  # there are texts
        text = log.read_text()
        asked = set(re.findall(r'"url":"([^"]*)"', text))
        self.assertEqual({url for url in asked if re.match("https?:|wss?:", url) and "report.html" in url}, set())
        self.assertNotIn("report.html", " ".join(url for url in asked if not url.startswith("file:")))
        self.assertEqual([url[:60] for url in asked if url.startswith("file:") and not url.endswith("report.html")], [])


class Parts(unittest.TestCase):
    def test_each_column_is_in_one_plot_or_constant(self):
        t = numpy.linspace(0, 1, 2000)
        names = ["time [s]", "step", "dt [s]", "a_kinetic_energy [J]", "b_kinetic_energy [J]", "odd [K]", "odder [K]", "flat [m]", "rounded [m]", "tiny [m]", *(f"m{k}_x [m]" for k in range(9))]
        history = Table({name: (numpy.ones(2000) if name.startswith("flat") else 5 + 1e-14 * t if name.startswith("rounded") else numpy.cos(9 * t) * (1e-6 if name.startswith("b_") else 1e-13 if name.startswith("tiny") else 1.)) for name in names})
        groups, constant = plots.history_groups(history)
        shown = [name for _, _, columns in groups for name in columns]
        self.assertEqual(sorted(shown + [name for name, _, _ in constant]), sorted(name.split(" [")[0] for name in names if name not in ("time [s]", "step")))
        self.assertEqual([n for n, _, _ in constant], ["flat", "rounded", "tiny"])
        self.assertTrue(all(len(columns) <= plots.MOST_LINES for _, _, columns in groups))
        self.assertFalse(any({"a_kinetic_energy", "b_kinetic_energy"} <= set(columns) for _, _, columns in groups))  # one would be flat beside the other

    def test_thinned_lines_keep_their_peaks(self):
        x = numpy.arange(100_000.)
        y = numpy.sin(x / 999)
        y[[7, 54_321]] = 50, -70
        y[500:900] = numpy.nan
        a, b = plots.thinned(x, y)
        self.assertLessEqual(len(a), plots.MOST_POINTS + 2)
        self.assertEqual((numpy.nanmax(b), numpy.nanmin(b), a[0], a[-1]), (50, -70, 0, 99_999))

    def test_a_part_that_fails_leaves_the_others(self):
        g = gather.Gathered(pathlib.Path("."), "n", {"end_reason": "end", "seconds": {"kick": "long"}}, state="ended", plan={"title": "t", "phases": {}})
        page = Page(make_page(g))
        self.assertIn('the part "How the time went" could not be made: TypeError', page.text)
        self.assertIn("Program, machine, scene", page.text)

    def test_a_scene_without_interactions(self):
        plan = {"phases": {"bar": {"kind": "rigid", "particles": 3, "spacing": .1, "mass": 1., "sound_speed": 0.}}}
        self.assertIn("the matrix is empty", parts.matrix(gather.Gathered(pathlib.Path("."), "n", {}, plan=plan)))

    def test_numbers(self):
        for value, text in ((0, "0"), (1234, "1234"), (19852, "19&#8201;852"), (1.1025e-05, "1.103e-5"), (2.5e10 + .5, "2.5e10"), (float("nan"), "nan"), (None, ""), ("<", "&lt;")):
            self.assertEqual(parts.number(value), text)

    def test_settings_are_applied(self):
        scene = {"time": {"end": 1}, "fill": [{"phase": "a"}, {"phase": "b"}], "x": 3}
        gather.with_settings(scene, ["time.end=0.5", "fill.1.velocity=[1, 2]", "new.key=word", "x=true", "fill.7.a=1", "x.y=2"])
        self.assertEqual(scene, {"time": {"end": .5}, "fill": [{"phase": "a"}, {"phase": "b", "velocity": [1, 2]}], "x": True, "new": {"key": "word"}})

    def test_friction_velocity_of_the_scene(self):
        wind = {"log-profile": {"friction-velocity": .3}}
        for scene, expected in (({"fill": [{"phase": "air", "velocity": wind}]}, .3), ({"fill": [{"phase": "air", "velocity": wind}], "forcing": [{"phase": "air", "friction-velocity": .4}]}, .4),
                                ({"phases": {"air": {"friction-velocity": .5}}}, .5), ({"fill": [{"phase": "sand", "velocity": wind}]}, None), (None, None)):
            self.assertEqual(parts.asked_friction_velocity(gather.Gathered(pathlib.Path("."), "n", {}, scene=scene), "air"), expected)

    def test_means_and_coefficients(self):
        t = numpy.linspace(0, 80, 4001)
        drag, lift = 0.7 + 0.01 * numpy.sin(4 * t) + 2 * numpy.exp(-t), 0.15 * numpy.sin(2 * numpy.pi * 0.165 * t)
        history = Table({"time [s]": t, "a_force_x [N]": drag, "a_force_y [N]": lift, "a_flux [kg/s]": t, "b_flux [kg/s]": 1e-14 * t})
        scene = {"dimensions": 2, "phases": {"water": {"kind": "fluid", "density": 2.}, "a": {"kind": "wall"}}}
        g = gather.Gathered(pathlib.Path("."), "n", {}, state="ended", scene=scene, history=history, plan={"dimensions": 2})
        mean, deviation, state = parts.halves(t, drag)
        self.assertAlmostEqual(mean, .7, places=3)
        self.assertAlmostEqual(deviation, .01 / 2 ** .5, places=3)
        self.assertEqual(state, "settled")
        self.assertAlmostEqual(parts.strouhal(t, lift, 1., 1.), .165, places=4)
        self.assertIsNone(parts.strouhal(t, numpy.random.default_rng(1).normal(size=len(t)), 1., 1.))
        page = parts.means(g, (1., 1.))
        self.assertIn("<td class=\"n\">0.165</td>", page)
        self.assertEqual(page.count(">0.6999<"), 2)   # Cd = F/(1/2 rho U^2 L), with a density of 2
        self.assertRegex(page, "<b>Cd</b></td><td[^>]*><code>a_force_x</code>.*<b>Cl</b></td><td[^>]*><code>a_force_y</code>")
        self.assertIn("taken as x", page)
        g.history = Table({**history, "water_mean_vx [m/s]": 0 * t, "water_mean_vy [m/s]": 0 * t - .9})   # it flows downwards
        page = parts.means(g, (1., 1.))
        self.assertRegex(page, "<b>Cd</b></td><td[^>]*><code>a_force_y</code>.*<b>Cl</b></td><td[^>]*><code>a_force_x</code>")
        self.assertIn("-y, the mean velocity of &quot;water&quot;", page)
        g.history = Table({name: values for name, values in history.items() if "force" not in name})
        self.assertIn("the scene has no [[force]]", parts.means(g, (1., 1.)))
        self.assertNotIn("[[force]]", parts.means(g))
        g.history = Table({name: values[:9] for name, values in history.items()})
        self.assertIn("fewer than 16 rows", parts.means(g, (1., 1.)))
        g.history = history
        page = parts.means(g, (1., 1.))
        self.assertNotIn("b_flux", page)
        self.assertLess(page.index("a_force_x"), page.index("a_flux"))
        self.assertEqual((page.count("settled"), page.count("still changes")), (4, 1))
        scene["phases"]["air"] = {"kind": "fluid", "density": 1.}
        self.assertIn("not one fluid alone", parts.means(g, (1., 1.)))

    def test_settled_or_not(self):
        """Of a sine, a ramp, noise, noise with a trend, a short record and a decay; the autocorrelation time is that of bench."""
        sys.path.insert(0, str(ROOT / "bench"))
        from barchan_bench import statistics
        some = numpy.random.default_rng(4)
        noise = some.normal(size=2000)
        slow = numpy.convolve(some.normal(size=2200), numpy.exp(-numpy.arange(200) / 10))[200:2200]
        for values in (noise, slow, numpy.sin(numpy.linspace(0, 30, 500)), numpy.ones(9), noise[:2]):
            self.assertAlmostEqual(parts.autocorrelation_time(values), statistics.autocorrelation_time(values), places=9)
        t = numpy.linspace(0, 1, 2000)
        state = lambda values: parts.halves(t, values)[2]
        for phase in numpy.linspace(0, 6, 13):
            self.assertEqual(state(numpy.sin(10 * numpy.pi * t + phase)), "settled")            # five periods about 0
            self.assertNotEqual(state(1210 + 345 * numpy.sin(4 * numpy.pi * t + phase)), "settled")  # 1210 +- 244, one period in the second half
        self.assertEqual([state(each) for each in (t, numpy.exp(-2 * t), noise + 3 * t, slow + 30 * t)], ["still changes"] * 4)
        self.assertEqual([state(each) for each in (noise, slow, 1210 + 244 * noise, 1 - numpy.exp(-12 * t), 0 * t)], ["settled"] * 5)
        self.assertNotEqual(parts.halves(numpy.linspace(0, .1, 60), 1210 + 244 * slow[:60] / slow.std())[2], "settled")
        self.assertIsNone(parts.halves(t[:10], t[:10]))

    def test_states(self):
        for reason, expected in (("end", ("ended", 0)), ("TERMINATE", ("ended", 0)), ("breakdown: x", ("broken", 3)), ("output failed: x", ("failed", 4)), ("SIGINT", ("stopped", 130)), ("", ("killed", None))):
            self.assertEqual(gather.state_of({"end_reason": reason}), expected)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
