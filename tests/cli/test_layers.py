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
DOWN = "app simulation plan measure models output engine laws state checks start scene kernels simd base".split()


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


def reach_ranks(src):
    """Files above the engine that reach other ranks by themselves: engine/exchange.hpp does it for them."""
    above = DOWN[DOWN.index("simulation"):DOWN.index("models") + 1]
    return [str(f.relative_to(src)) for f in sorted(src.rglob("*.?pp"))
            if f.relative_to(src).parts[0] in above and re.search(r'"base/ranks.hpp"|\branks::', f.read_text())]


# Questions for the kind of a phase or of an entry, by its name or by what only one kind has. What is asked instead is a
# fact that the model declares (models/layout.hpp: PlanPhase, PlanEntry).
QUESTIONS = {
    "the kind of a phase": r"\bPhaseKind\b|(\.|->)kind(_word)?\(\)|\bown\.index\(\)",
    "the word of a kind": r"\bkind\s*[!=]=\s*\"",
    "the kind of an entry": r"\bEntryKind\b",
    "the word of a law": r"(\.|->)law\s*[!=]=\s*\"",
    "the keys of one kind": r"\bif_(column|wall|grains|fluid|elastic|rigid)\(\)|\b(get_if|holds_alternative)<\w*Keys>",
    "a diameter": r"\bdiameter(\(\))?\s*(>|[!=]=|<=)\s*0|\b(if|while) \(.*\.diameter\(\)\)",
    "rigid bodies": r"\brigid_bodies\.(empty\(\)|size\(\)\s*(>|[!=]=))",
    "an entry of one kind": r"\b(of_spheres|of_bodies|of_surfaces|of_many_elastic|sees_solid|is_body|are_grains)\b",
    "a pair of kinds": r"\b(touch_as_bodies|touch_by_surfaces|bodies_may_touch|touches_itself|meets)\(",
    "grains by their friction": r"[!=]=\s*Friction::grains\b",
    "a body": r"\bplan_?\.body\b",
    "what moves a phase": r"\bmover\s*([!=]=|[<>])",
}
# (file, question): the reason why it may stand there.
ALLOWED = {
    ("models/layout.hpp", "what moves a phase"): "its facts follow from it",
    ("models/layout.hpp", "a diameter"): "the size of a particle follows from it",
    ("models/fluid/fluid_attach.cpp", "grains by their friction"): "the fluid applies this law",
    ("models/fluid/eddy_rates.cpp", "grains by their friction"): "the same",
}


def kinds(src):
    """Places outside scene/, start/, checks/ and the one visit that ask for the kind of a phase or of an entry."""
    found = []
    for f in sorted(src.rglob("*.?pp")):
        name = str(f.relative_to(src))
        if name.startswith(("scene/", "start/", "checks/")) or name == "models/catalogue.cpp":
            continue
        code = re.sub(r"//.*", "", f.read_text())
        found += [f"{name} asks for {what}" for what, how in QUESTIONS.items()
                  if re.search(how, code) and (name, what) not in ALLOWED]
    return found


def assigned(src):
    """Files that say of a phase what moves it: models, each of its own kind."""
    return {str(f.relative_to(src)) for f in src.rglob("*.?pp")
            if re.search(r"(\.|->)mover\s*=[^=]", re.sub(r"//.*", "", f.read_text()))}


def twins(src):
    """Names of files that stand in two folders: each name says one thing."""
    where = {}
    for f in sorted(src.rglob("*.?pp")):
        where.setdefault(f.stem, set()).add(str(f.relative_to(src).parent))
    return {name: sorted(folders) for name, folders in where.items() if len(folders) > 1}


def clashes(src):
    """Names that two files of a folder give in namespaces without a name: some presets compile a folder's files together
    (cmake/options.cmake). Functions clash when the types of their arguments are the same too."""
    found = []
    for folder in sorted({f.parent for f in src.rglob("*.cpp")}):
        where = {}
        for f in sorted(folder.glob("*.cpp")):
            text = f.read_text()
            outer = re.search(r"^namespace (barchan\S*)", text, re.M)
            for inner in re.findall(r"^namespace {$(.*?)^}  // namespace$", text, re.M | re.S):
                names = set(re.findall(r"^(?:struct|class|enum class|enum|using) (\w+)(?: [:={]|;)", inner, re.M))
                for line in re.findall(r"^(?:static |inline )?(?:constexpr|const) ([^(]*?=.*?);", inner, re.M | re.S):
                    names |= set(re.findall(r"(?<!:)\b([a-z_]\w*)(?:\[\w*\])?\s*(?:=[^=]|$)", re.sub(r"{[^{}]*}", "", line)))
                for name, arguments in re.findall(r"^[a-z][\w:<>&*, ]*?\b(\w+)\(([^(){};]*)\)(?: const)? {", inner, re.M):
                    names.add(name + "(" + ", ".join(re.sub(r"\s*\w+$", "", " ".join(a.split())) for a in arguments.split(",")) + ")")
                for name in names:
                    where.setdefault((name, outer and outer[1]), []).append(f.name)
        found += [f"{folder.relative_to(src)}: {name} in {' and '.join(files)}"
                  for (name, _), files in where.items() if len(files) > 1]
    return sorted(found)


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

    def test_hidden_names_differ_within_a_folder(self):
        self.assertEqual(clashes(ROOT / "src"), [])

    def test_planted_clashes_are_found(self):
        with tempfile.TemporaryDirectory() as scratch:
            src = pathlib.Path(scratch)
            for name, text in {"a/x.cpp": "constexpr double room = 0.02, far = 0.2;  // m\nstruct S {\n};\n",
                               "a/y.cpp": "constexpr double far = 0.2;\nstruct S {\n  int room = 1;\n};\n",
                               "b/z.cpp": "constexpr double room = 1.0;\nint f(double x) {\n}\nint g(int a,\n      int b) {\n}\n",
                               "b/w.cpp": "int f(float x) {\n}\nint g(int c, int d) {\n}\n"}.items():
                (src / name).parent.mkdir(exist_ok=True)
                (src / name).write_text(f"namespace barchan {{\n\nnamespace {{\n\n{text}\n}}  // namespace\n\n}}\n")
            self.assertEqual(clashes(src), ["a: S in x.cpp and y.cpp", "a: far in x.cpp and y.cpp", "b: g(int, int) in w.cpp and z.cpp"])

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

    def test_only_the_engine_reaches_other_ranks(self):
        self.assertEqual(reach_ranks(ROOT / "src"), [])
        with tempfile.TemporaryDirectory() as scratch:
            for name in ("models/fluid", "engine"):
                (pathlib.Path(scratch) / name).mkdir(parents=True)
                (pathlib.Path(scratch) / name / f"{name[0]}.cpp").write_text('#include "base/ranks.hpp"\n')
            self.assertEqual(reach_ranks(pathlib.Path(scratch)), ["models/fluid/m.cpp"])

    def test_nobody_asks_for_a_kind(self):
        self.assertEqual(kinds(ROOT / "src"), [])

    def test_every_exception_is_needed(self):
        for name, what in ALLOWED:
            self.assertRegex(re.sub(r"//.*", "", (ROOT / "src" / name).read_text()), QUESTIONS[what], name)

    def test_models_say_who_moves(self):
        self.assertTrue(assigned(ROOT / "src"))
        for name in assigned(ROOT / "src"):
            self.assertRegex(name, "^models/[a-z]+/")

    def test_planted_questions_are_found(self):
        planted = {
            "the kind of a phase": ["if (a.kind() == k)", "PhaseKind kind;", "p->kind_word()",
                                    "phase.own.index() == 2"],
            "the word of a kind": ['if (p.kind == "grains")', 'p.kind != "wall"'],
            "the kind of an entry": ["e.kind == EntryKind::fluid", "EntryKind kind;"],
            "the word of a law": ['if (e.law == "coupling")'],
            "the keys of one kind": ["if (p.if_wall())", "phase->if_grains()", "p.if_column()", "p.if_rigid()",
                                     "std::get_if<WallKeys>(&p.own)", "std::holds_alternative<FluidKeys>(p.own)"],
            "what moves a phase": ["if (p.mover == Mover::rigid)", "plan_.mover >= Mover::fluid"],
            "a diameter": ["p.diameter > 0", "p.diameter > 0.0", "plan_.diameter == 0", "p.diameter() > 0",
                           "if (scene.phases[k].diameter()) n += 1;"],
            "rigid bodies": ["p.rigid_bodies.empty()", "p.rigid_bodies.size() > 0", "p.rigid_bodies.size() != 0"],
            "an entry of one kind": ["e.of_spheres()", "of_spheres(pair)", "e.of_bodies", "e.of_surfaces",
                                     "e.sees_solid()", "e.of_many_elastic", "is_body(p)", "are_grains(p)"],
            "a pair of kinds": ["touch_as_bodies(pair, a, b)", "touch_by_surfaces(a, b)", "meets(scene, p, k)"],
            "grains by their friction": ["p.friction == Friction::grains"],
            "a body": ["plan.body && n", "plan_.body"],
        }
        self.assertEqual(set(planted), set(QUESTIONS))
        with tempfile.TemporaryDirectory() as scratch:
            for folder in ("plan", "scene", "models/fluid"):
                (pathlib.Path(scratch) / folder).mkdir(parents=True)
            for what, lines in planted.items():
                for line in lines:
                    with self.subTest(line):
                        for name in ("plan/x.cpp", "scene/x.cpp", "models/catalogue.cpp"):
                            (pathlib.Path(scratch) / name).write_text(line + "\n")
                        self.assertIn(f"plan/x.cpp asks for {what}", kinds(pathlib.Path(scratch)))
                        self.assertEqual([k for k in kinds(pathlib.Path(scratch)) if not k.startswith("plan/")], [])
            (pathlib.Path(scratch) / "plan/x.cpp").write_text(
                "// e.of_spheres() is gone, and p.diameter > 0 too\nsize(p.diameter); p.rigid_bodies.size();\n"
                "std::get_if<BoxShape>(&shape);\nmeets_sound();\nif (i.kind == InstrumentKind::probe) e.law = \"x\";\n")
            self.assertEqual(kinds(pathlib.Path(scratch)), [])
            (pathlib.Path(scratch) / "plan/x.cpp").write_text("p.mover = Mover::fluid;\nif (p.mover_ == q.mover_) {}\n")
            self.assertEqual(assigned(pathlib.Path(scratch)), {"plan/x.cpp"})

    def test_a_planted_include_is_found(self):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch) / "laws"
            folder.mkdir()
            (folder / "x.hpp").write_text('#include "base/vec3.hpp"\n#include "plan/plan.hpp"\nPhaseKind kind;\n')
            self.assertEqual(climbs(pathlib.Path(scratch)), ["laws/x.hpp includes plan/plan.hpp"])
            self.assertEqual(kinds(pathlib.Path(scratch)), ["laws/x.hpp asks for the kind of a phase"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
