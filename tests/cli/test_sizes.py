#!/usr/bin/python3
"""Files of src above 400 lines and functions above 60: each has its reason here; others fail.

    test_sizes.py PROGRAM SOURCE_DIR

The lines of a function are counted from its head to its closing brace; what stands in it (closures) is part of it.
"""

import pathlib
import re
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else ".")
MOST_LINES_OF_A_FILE, MOST_LINES_OF_A_FUNCTION = 400, 60

LONG_FILES = {
    "scene/scene.hpp": "a scene as data: one member a key of the scene file",
    "simd/vec.hpp": "one type with all of its operations, for three instruction sets",
}
LONG_FUNCTIONS = {
    "app/main.cpp: dispatch": "one statement an option of the command line",
    "plan/plan_report.cpp: to_json": "one statement a value of the report",
    "simd/vec.hpp: load_transposed": "one case a width of the registers, in the order of the shuffles",
    "models/fluid/fluid_finish.hpp: finish_consistent": "the formulas that close the sums of the consistent scheme, in the order of "
                                                      "docs/method.md; each uses what the ones before it found",
    "models/bodies/updated_lagrangian.cpp: strain": "loop and closing terms of the strain of a body, an in-place update of its stress",
    "models/grains/sphere_forces.cpp: group_of": "contacts side by side: their geometry, springs and dashpots share registers",
}


def long_files(src):
    return {str(f.relative_to(src)): n for f in sorted(src.rglob("*.?pp"))
            if (n := len(f.read_text().splitlines())) > MOST_LINES_OF_A_FILE}


def bare(text):
    """The text with its comments and strings blanked, line by line as long as before."""
    hide = lambda m: re.sub(r"[^\n]", " ", m.group())
    return re.sub(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', hide, text, flags=re.S)


def kind_of(head):
    """Of a block from what stands before its brace: "outer" holds functions, "function" is one."""
    if re.search(r"\b(namespace|struct|class|enum|union)\b[^()]*$", head) or head.strip() == 'extern':
        return "outer"
    return "function" if re.search(r"\)[\w\s:&<>,\-()\[\].*]*$", head) and not re.search(r"[^=!<>]=\s*$", head) else "value"


def functions(text):
    """(name, lines) of each function that stands in no other."""
    text = "\n".join("" if line.startswith("#") else line for line in bare(text).split("\n"))
    blocks, after = [], 0
    for at, c in enumerate(text):
        if c == "{":
            head = text[after:at]
            blocks.append((kind_of(head), head, text.count("\n", 0, after + len(head) - len(head.lstrip()))))
        elif c == "}" and blocks:
            kind, head, first = blocks.pop()
            if kind == "function" and all(outer[0] == "outer" for outer in blocks):
                name = re.search(r"([\w:~]+|operator\S+)\s*\(", re.sub(r"__attribute__\s*\(\([^)]*\)\)", "", head))
                yield name.group(1) if name else head.strip(), text.count("\n", 0, at) - first + 1
        if c in "{};":
            after = at + 1


def long_functions(src):
    return {f"{f.relative_to(src)}: {name}": n for f in sorted(src.rglob("*.?pp"))
            for name, n in functions(f.read_text()) if n > MOST_LINES_OF_A_FUNCTION}


class Sizes(unittest.TestCase):
    def test_long_files_have_a_reason(self):
        self.assertEqual({f: n for f, n in long_files(ROOT / "src").items() if f not in LONG_FILES}, {})

    def test_long_functions_have_a_reason(self):
        self.assertEqual({f: n for f, n in long_functions(ROOT / "src").items() if f not in LONG_FUNCTIONS}, {})

    def test_planted_ones_are_found(self):
        with tempfile.TemporaryDirectory() as scratch:
            src = pathlib.Path(scratch)
            body = "  int x;\n" * 61
            (src / "a.cpp").write_text("void f(int a) {\n" + body + "}\n\nstruct S {\n  int g() {\n" +
                                       "  " + body.replace("\n", "\n  ") + "}\n};\n" + "// more\n" * 300)
            self.assertEqual(long_files(src), {"a.cpp": 429})
            self.assertEqual(long_functions(src), {"a.cpp: f": 63, "a.cpp: g": 63})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
