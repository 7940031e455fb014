#!/usr/bin/python3
"""Includes among the folders of src point down one list only: who may know whom (docs/architecture.md).

    test_layers.py PROGRAM SOURCE_DIR
"""

import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")
DOWN = "app simulation plan measure models output engine laws state scene kernels simd base".split()


def climbs(src):
    """Includes that point up, "models/fluid/fluid_phase.cpp includes plan/plan.hpp"."""
    found = []
    for file in sorted(src.rglob("*.?pp")):
        own = file.relative_to(src).parts[0]
        for include in re.findall(r'^\s*#\s*include\s+"([^"]+)"', file.read_text(), re.M):
            other = include.split("/")[0]
            if other not in DOWN or own not in DOWN or DOWN.index(other) < DOWN.index(own):
                found.append(f"{file.relative_to(src)} includes {include}")
    return found


def kinds(src):
    """Places outside scene/ and the one visit that ask for the kind of a phase."""
    return [str(f.relative_to(src)) for f in sorted(src.rglob("*.?pp"))
            if "PhaseKind" in f.read_text() and f.relative_to(src).parts[0] != "scene" and f.name != "catalogue.cpp"]


def twins(src):
    """Names of files that stand in two folders: each name says one thing."""
    where = {}
    for f in sorted(src.rglob("*.?pp")):
        where.setdefault(f.stem, set()).add(str(f.relative_to(src).parent))
    return {name: sorted(folders) for name, folders in where.items() if len(folders) > 1}


def circles(src):
    """Circles of includes among the files of src, each as the list of its files."""
    includes = {}
    for f in src.rglob("*.?pp"):
        names = re.findall(r'^\s*#\s*include\s+"([^"]+)"', f.read_text(), re.M)
        includes[str(f.relative_to(src))] = [n for n in names if (src / n).exists()]
    found, done = [], set()

    def walk(file, way):
        if file in way:
            found.append(way[way.index(file):] + [file])
        elif file not in done:
            for other in includes.get(file, []):
                walk(other, way + [file])
            done.add(file)

    for file in sorted(includes):
        walk(file, [])
    return found


def strangers(tests, src):
    """Files of tests/unit that no folder of src finds: each is named for it, models_grains_search.cpp."""
    folders = {str(f.relative_to(src)).replace("/", "_") for f in src.rglob("*") if f.is_dir()}
    return [f.name for f in sorted(tests.glob("*.cpp"))
            if not any(f.stem == folder or f.stem.startswith(folder + "_") for folder in folders)]


class Layers(unittest.TestCase):
    def test_a_unit_test_is_named_for_its_folder(self):
        self.assertEqual(strangers(ROOT / "tests/unit", ROOT / "src"), [])

    def test_a_planted_stranger_is_found(self):
        with tempfile.TemporaryDirectory() as scratch:
            for name in ("src/models/grains", "unit"):
                (pathlib.Path(scratch) / name).mkdir(parents=True)
            for name in ("models_grains_x", "models", "grains_x", "model_x"):
                (pathlib.Path(scratch) / "unit" / f"{name}.cpp").write_text("")
            self.assertEqual(strangers(pathlib.Path(scratch) / "unit", pathlib.Path(scratch) / "src"),
                             ["grains_x.cpp", "model_x.cpp"])

    def test_a_name_of_a_file_stands_once(self):
        self.assertEqual(twins(ROOT / "src"), {})

    def test_no_circle_of_includes(self):
        self.assertEqual(circles(ROOT / "src"), [])

    def test_planted_twins_and_circles_are_found(self):
        with tempfile.TemporaryDirectory() as scratch:
            src = pathlib.Path(scratch)
            for name, text in {"laws/x.hpp": '#include "base/y.hpp"\n', "base/y.hpp": '#include "base/z.hpp"\n',
                               "base/z.hpp": '#include "laws/x.hpp"\n', "models/x.hpp": ""}.items():
                (src / name).parent.mkdir(exist_ok=True)
                (src / name).write_text(text)
            self.assertEqual(twins(src), {"x": ["laws", "models"]})
            self.assertEqual(circles(src), [["base/y.hpp", "base/z.hpp", "laws/x.hpp", "base/y.hpp"]])

    def test_includes_point_down(self):
        self.assertEqual(climbs(ROOT / "src"), [])

    def test_nobody_asks_for_the_kind_of_a_phase(self):
        self.assertEqual(kinds(ROOT / "src"), [])

    def test_a_planted_include_is_found(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch) / "laws"
            folder.mkdir()
            (folder / "x.hpp").write_text('#include "base/vec3.hpp"\n#include "plan/plan.hpp"\nPhaseKind kind;\n')
            self.assertEqual(climbs(pathlib.Path(scratch)), ["laws/x.hpp includes plan/plan.hpp"])
            self.assertEqual(kinds(pathlib.Path(scratch)), ["laws/x.hpp"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
