"""The pages agree with the figures, with the tree and with each other.

    test_pages.py PROGRAM SOURCE_DIR

Figures that stand on several pages come from docs/figures.json, through docs/figures.py. Links lead to files and headings that are there.
No page has a figure that was not measured. Lines have one width. Every scene is in the gallery. README and the program say the same of --restart.
"""
import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
sys.path[:0] = [str(SOURCE / "bench"), str(SOURCE / "docs")]
from barchan_bench import store  # noqa: E402
from tables import MARK, Tables  # noqa: E402

TABLES = Tables(SOURCE, PROGRAM)

PAGES = [*sorted(SOURCE.glob("*.md")), *sorted(SOURCE.glob("docs/**/*.md"))]

NOT_YET_OF_ONE_WIDTH = ("CHANGELOG.md",)  # a list that several people add to


def anchors(text):
    """The anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ +(.*)$", re.sub(r"```.*?```", "", text, flags=re.S), flags=re.M)
    return {re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-") for heading in headings}


class Pages(unittest.TestCase):
    def copy(self):
        """The pages, figures and results of the repository in a folder that a test may change."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = Path(folder.name)
        for page in PAGES:
            (root / page.relative_to(SOURCE)).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(page, root / page.relative_to(SOURCE))
        shutil.copy(SOURCE / "docs/figures.json", root / "docs/figures.json")
        for part in ("bench/accuracy/results", "bench/throughput", "bench/barchan_bench", "tests/instructions"):
            shutil.copytree(SOURCE / part, root / part)
        return root

    @staticmethod
    def figures(root, what="--check"):
        return subprocess.run([sys.executable, SOURCE / "docs/figures.py", what, "--root", root], capture_output=True, text=True)

    def test_figures_agree_with_their_file(self):
        result = self.figures(SOURCE)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_a_page_that_disagrees_is_named(self):
        root = self.copy()
        page = root / "docs/validation.md"
        right = page.read_text()
        wrong, count = re.subn(r'\[[^\]]*(\]\(figures\.json "dune\.crest )', r"[99.9\1", right)
        self.assertEqual(count, 1)
        page.write_text(wrong)
        result = self.figures(root)
        self.assertEqual(result.returncode, 1)
        self.assertIn("docs/validation.md: dune.crest is 99.9", result.stdout)
        self.assertEqual(self.figures(root, "--write").returncode, 0)
        self.assertEqual(page.read_text(), right)

    def test_a_new_measurement_makes_pages_disagree(self):
        root = self.copy()
        file = root / "bench/accuracy/results/taylor-green.csv"
        results = store.load(file)
        for row in results["rows"]:
            row["value"] *= 2
        store.keep(file, results)
        result = self.figures(root)
        self.assertEqual(result.returncode, 1)
        self.assertIn("README.md: taylor-green.50", result.stdout)
        self.assertIn("docs/validation.md: taylor-green.50", result.stdout)

    def test_every_table_is_made_and_none_is_kept(self):
        """A table of results stands in no page: the page names who makes it."""
        for page in PAGES:
            text = page.read_text()
            for mark in MARK.finditer(text):
                self.assertGreater(len(TABLES.filled(mark[0])), 100, f"{page.relative_to(SOURCE)}: {mark[0]}")
            self.assertNotRegex(text, r"<!-- [\w ]+: begin -->", page)
        self.assertGreater(len(TABLES.of), 15)

    def test_wrong_marks_are_refused(self):
        for text in ('[1](docs/figures.json "no.such .2f")', '[1](docs/figures.json "dune.crest .2f)'):
            root = self.copy()
            (root / "README.md").write_text(text)
            result = self.figures(root)
            self.assertEqual(result.returncode, 1, text)
            self.assertIn("README.md", result.stderr)

    def test_everything_was_measured(self):
        for page in PAGES:
            for number, line in enumerate(page.read_text().splitlines(), 1):
                self.assertNotIn("not measured yet", line.lower(), f"{page.relative_to(SOURCE)}:{number}")

    def test_links_lead_somewhere(self):
        count = 0
        for page in PAGES:
            for target in re.findall(r"\]\(([^)\s]+)", TABLES.filled(page.read_text())):
                if re.match(r"[a-z]+:", target):
                    continue
                name, _, anchor = target.partition("#")
                file = (page.parent / name).resolve() if name else page
                self.assertTrue(file.exists(), f"{page.relative_to(SOURCE)}: {target} is not there")
                if anchor:
                    self.assertIn(anchor, anchors(TABLES.filled(file.read_text())), f"{page.relative_to(SOURCE)}: {target}")
                count += 1
        self.assertGreater(count, 10)

    def test_lines_have_one_width(self):
        ended = subprocess.run([sys.executable, SOURCE / "docs/wrap.py", "--check", *(page for page in PAGES if page.name not in NOT_YET_OF_ONE_WIDTH)],
                               capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stdout)

    def test_filling_keeps_words_marks_and_what_is_no_paragraph(self):
        words = "a word " * 30
        text = (f"{words}[0.4 %](figures.json \"one .1%\") `code that is long` [a link of words](page.md#part)\n\n- {words}\n  of an item\n\n"
                f"| {words} |\n\n    {words}\n\n```sh\n{words}\n```\n\n<!-- x: begin -->\n{words}\n<!-- x: end -->\n")
        with tempfile.TemporaryDirectory() as folder:
            page = Path(folder) / "page.md"
            page.write_text(text)
            check = [sys.executable, SOURCE / "docs/wrap.py", page]
            first = subprocess.run([*check, "--check"], capture_output=True, text=True)
            self.assertEqual((first.returncode, first.stdout.count("docs/wrap.py --write")), (1, 2))
            self.assertEqual(subprocess.run([*check, "--write"]).returncode, 0)
            after = page.read_text()
            self.assertEqual(after.split(), text.split())
            for kept in ("[0.4 %](figures.json \"one .1%\")", "`code that is long`", "[a link of words](page.md#part)", f"| {words} |", f"    {words}",
                         f"```sh\n{words}\n```", f"begin -->\n{words}\n<!-- x"):
                self.assertIn(kept, after)
            self.assertEqual(subprocess.run([*check, "--check"]).returncode, 0)

    def test_every_scene_is_in_the_gallery(self):
        ended = subprocess.run([sys.executable, SOURCE / "docs/gallery.py"], capture_output=True, text=True)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        page = TABLES.filled((SOURCE / "docs/gallery/README.md").read_text())
        for scene in SOURCE.glob("scenes/**/*.toml"):
            self.assertIn(f"`{scene.relative_to(SOURCE)}`", page)

    def test_a_scene_that_is_missing_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for part in ("scenes", "docs/gallery"):
                (root / part).mkdir(parents=True)
            (root / "scenes/new.toml").write_text('title = "New"\n')
            row = {"scene": "scenes/old.toml", "picture": "scenes/old.png", "state": "airflow", "settings": [], "frame": "last", "seen": ""}
            (root / "docs/gallery/scenes.json").write_text(json.dumps([row]))
            ended = subprocess.run([sys.executable, SOURCE / "docs/gallery.py", "--root", root], capture_output=True, text=True)
            self.assertEqual(ended.returncode, 1)
            for words in ("no row of scenes/new.toml", "there is no scenes/old.toml"):
                self.assertIn(words, ended.stdout)

    def test_every_picture_of_the_gallery_has_its_command(self):
        page = TABLES.filled((SOURCE / "docs/gallery/README.md").read_text())
        for picture in sorted((SOURCE / "docs/gallery").glob("*.png")):
            self.assertIn(f"`{picture.name}`", page)

    def test_restart_keeps_the_frames_of_an_earlier_run(self):
        """A series without its checkpoint is not overwritten."""
        with tempfile.TemporaryDirectory() as folder:
            def start(*options):
                return subprocess.run([PROGRAM, "run", SOURCE / "scenes/verification/couette.toml", "--out", folder, "--quiet",
                                       "--threads", "1", *options], capture_output=True, text=True)

            first = start("--set", "time.end=1e-4", "--restart", "latest")
            self.assertEqual(first.returncode, 0, first.stderr)
            self.assertIn("starting at the beginning", first.stderr)
            (Path(folder) / "couette.checkpoint").unlink()
            before = {file: file.read_bytes() for file in Path(folder).iterdir()}
            self.assertTrue(any(file.suffix == ".vtp" for file in before))
            again = start("--set", "time.end=2e-4", "--restart", "latest")
            self.assertEqual(again.returncode, 2, again.stderr)
            self.assertIn("would remove its frames", again.stderr)
            self.assertEqual(before, {file: file.read_bytes() for file in Path(folder).iterdir()})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
