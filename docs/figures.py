#!/usr/bin/python3
"""Figures that stand on several pages come from one file: docs/figures.json.

    /usr/bin/python3 docs/figures.py --check       says which page disagrees; exit status 1 if one does
    /usr/bin/python3 docs/figures.py --write       writes the figures into the pages

A figure on a page is a link to that file, whose title is its name and a format of Python:

    [0.0028](figures.json "taylor-green.50 .4f")

docs/figures.json says where each figure comes from. One of:

    "value"           the number itself, with the "command" that measured it
    "file", "row"     the value of the row of a results file whose keys are those of "row"
    "file", "path"    the number at this path of a results file; with "over", divided by the number at that path; with "scale", times
                      that factor (from pairs to million pairs, for example)

"""

import argparse
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench"))
sys.dont_write_bytecode = True
from barchan_bench import store  # noqa: E402

MARK = re.compile(r'\[([^\]]*)\]\(((?:\.\./|docs/)*figures\.json) "([\w.-]+) ([^\s"]+)"\)')


class Wrong(Exception):
    """A figure or a mark that cannot be used; the message says why."""


def at(data, path):
    for key in path:
        data = data[key]
    return float(data)


def value_of(name, figure, root):
    """The number of a figure."""
    if "value" in figure:
        if "command" not in figure:
            raise Wrong(f"docs/figures.json: {name}: a value needs the command that measured it")
        return float(figure["value"])
    try:
        file = root / figure["file"]
        data = store.load(file) if file.suffix == ".csv" else json.loads(file.read_text())
        if "path" in figure:
            over = at(data, figure["over"]) if "over" in figure else 1.0
            return at(data, figure["path"]) / over * figure.get("scale", 1.0)
        rows = [row for row in data["rows"] if all(row.get(key) == wanted for key, wanted in figure["row"].items())]
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise Wrong(f"docs/figures.json: {name}: {type(error).__name__}: {error}") from None
    if len(rows) != 1:
        raise Wrong(f"docs/figures.json: {name}: {figure['file']} has {len(rows)} rows of {figure['row']}, expected one")
    return float(rows[0]["value"])


def text_of(value, form):
    """A number as the pages write it: 1.0 % with a space, powers of ten as 3e-5."""
    text = format(value, form)
    return re.sub(r"e([+-])0", r"e\1", text).replace("e+", "e").replace("%", " %")


def filled(page, text, figures, used):
    """A page's text with its marked figures as they should be, and a line for each that is not."""
    faults = []

    def fill(mark):
        found, file, name, form = mark.groups()
        if name not in figures:
            raise Wrong(f"{page}: no figure '{name}' in docs/figures.json")
        used.add(name)
        expected = text_of(figures[name], form)
        if found != expected:
            faults.append(f"{page}: {name} is {found} here and {expected} in docs/figures.json")
        return f'[{expected}]({file} "{name} {form}")'

    if text.count('figures.json "') != len(MARK.findall(text)):
        raise Wrong(f"{page}: a link of a figure is not complete")
    return MARK.sub(fill, text), faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--check", action="store_true")
    what.add_argument("--write", action="store_true")
    parser.add_argument("--root", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[1], help="the repository")
    options = parser.parse_args()
    root = options.root.resolve()
    faults, used = [], set()
    try:
        about = json.loads((root / "docs/figures.json").read_text())
        figures = {name: value_of(name, figure, root) for name, figure in about.items()}
        for page in [*sorted(root.glob("*.md")), *sorted(root.glob("docs/**/*.md"))]:
            text = page.read_text()
            new, found = filled(page.relative_to(root), text, figures, used)
            faults += found
            if options.write and new != text:
                page.write_text(new)
        if unused := set(figures) - used:
            raise Wrong(f"docs/figures.json: no page shows {', '.join(sorted(unused))}")
    except Wrong as error:
        sys.exit(f"figures: {error}")
    print("\n".join(faults) if faults else f"{len(used)} figures agree with their file")
    return 1 if faults and options.check else 0


if __name__ == "__main__":
    sys.exit(main())
