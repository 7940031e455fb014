"""The pages build as a site: mkdocs warns of nothing, every link and anchor leads somewhere, nothing comes from the network, and it can be searched.

    test_site.py PROGRAM SOURCE_DIR
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
sys.path.insert(0, str(SOURCE / "docs"))
import reading  # noqa: E402


def build(root, out):
    return subprocess.run([sys.executable, SOURCE / "docs/site.py", "--root", root, "--out", out, "--program", PROGRAM], capture_output=True, text=True)


class Site(unittest.TestCase):
    def test_builds_and_can_be_searched(self):
        with tempfile.TemporaryDirectory() as name:
            ended = build(SOURCE, name)
            self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
            index = json.loads((Path(name) / "search/search_index.json").read_text())["docs"]
            found = [entry["location"] for entry in index if "roughness" in entry["text"]]
            self.assertTrue(any(place.startswith("docs/scenes.html") for place in found), found)
            pages = {page.name: page.read_text() for page in Path(name).rglob("*.html")}
            self.assertEqual([page for page, text in pages.items() if re.search(r"^(<p>)?{{ ", text, re.M)], [], "a table was not made")
            for page, words in (("scenes.html", "friction-velocity"), ("ledger.html", "MISSED"), ("accuracy.html", "Measured on"), ("ranks.html", "the same bytes in all")):
                self.assertIn(words, pages[page])

    def test_words_of_sentences_are_counted(self):
        text = ("# A heading of five words\n\nTwo words. One [link of four words](a.md#b) and `code of three`.\n\n- an item\n  of a list\n\n"
                "| a | table |\n\n    code = 1\n\n```\nmore code\n```\n\nA fluid knows " + "word " * 40 + "end.\n")
        of = reading.read(text)
        self.assertEqual((of["words"], of["longest"], len(of["long"]), of["guessed"]), (2 + 7 + 5 + 44, 44, 1, 1))

    def test_what_is_wrong_is_named(self):
        with tempfile.TemporaryDirectory() as name:
            root = Path(name) / "root"
            (root / "docs").mkdir(parents=True)
            shutil.copy(SOURCE / "docs/site.py", root / "docs/site.py")
            (root / "mkdocs.yml").write_text("site_name: Test\ntheme: {name: mkdocs, highlightjs: false}\nuse_directory_urls: false\n"
                                             "nav:\n  - One: README.md\n")
            (root / "README.md").write_text("# One\n\n[two](docs/two.md#no-such-part)\n\n![a picture](https://example.org/a.png)\n")
            (root / "docs/two.md").write_text("# Two\n")
            ended = build(root, Path(name) / "site")
            self.assertEqual(ended.returncode, 1)
            for words in ("docs/two.html#no-such-part has no such anchor", "fetches https://example.org/a.png", "docs/two.md stands in no menu"):
                self.assertIn(words, ended.stdout)
            (root / "README.md").write_text("# One\n\n[three](docs/three.md)\n")
            ended = build(root, Path(name) / "site")
            self.assertEqual(ended.returncode, 1)
            self.assertIn("three.md", ended.stdout)
            for mark, words in (("bench/none.py: x", "bench/none.py"), ("docs/some.py: x", "docs/some.py has no table x; it has y"), ("barchan no-such-command", "barchan no-such-command")):
                (root / "docs/some.py").write_text("def tables():\n    return {'y': ''}\n")
                (root / "README.md").write_text(f"# One\n\n{{{{ {mark} }}}}\n")
                ended = build(root, Path(name) / "site")
                self.assertEqual(ended.returncode, 1)
                self.assertIn(f"tables: {words}", ended.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
