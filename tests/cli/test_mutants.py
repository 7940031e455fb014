#!/usr/bin/python3
"""The table of mutants (bench/robustness/mutants.toml) fits the present sources: each text stands in its file once.

    test_mutants.py PROGRAM SOURCE_DIR

The mutants themselves are run by bench/robustness/mutants.py: hours, not part of the tests.
"""

import collections
import pathlib
import sys
import tomllib
import unittest

ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".").resolve()
FOLDER = ROOT / "bench/robustness"
sys.path.insert(0, str(ROOT / "bench"))
from barchan_bench import store  # noqa: E402

LEAST = {"laws": 14, "engine": 10, "models": 16, "state": 2, "output": 6, "scene": 8, "measure": 4}  # by folder of src


class Mutants(unittest.TestCase):
    def setUp(self):
        self.table = tomllib.loads((FOLDER / "mutants.toml").read_text())["mutant"]

    def test_each_applies_once(self):
        wrong = []
        for mutant in self.table:
            text = (ROOT / mutant["file"]).read_text()
            if text.count(mutant["find"]) != 1:
                wrong.append(f"{mutant['name']}: \"{mutant['find']}\" stands {text.count(mutant['find'])} times in {mutant['file']}")
        self.assertEqual(wrong, [])

    def test_each_is_whole(self):
        for mutant in self.table:
            with self.subTest(mutant.get("name")):
                self.assertLessEqual({"name", "file", "find", "replace", "wrong"}, mutant.keys())
                self.assertLessEqual(mutant.keys(), {"name", "file", "find", "replace", "wrong", "form"})
                self.assertNotEqual(mutant["find"], mutant["replace"])
                self.assertIn(mutant.get("form", "choice"), {"choice", "statement", "build"})

    def test_there_are_enough_everywhere(self):
        self.assertEqual(len({m["name"] for m in self.table}), len(self.table))
        self.assertGreaterEqual(len(self.table), 60)
        by_folder = collections.Counter(m["file"].split("/")[1] for m in self.table)
        by_folder["output"] += by_folder["simulation"]  # frames and rows
        by_folder["scene"] += by_folder["start"] + by_folder["checks"]  # a document, its particles, what is refused
        for folder, least in LEAST.items():
            self.assertGreaterEqual(by_folder[folder], least, folder)

    def test_results_are_of_these(self):
        results = store.load(FOLDER / "results/mutants.csv")
        self.assertLessEqual(results.keys(), {m["name"] for m in self.table})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
