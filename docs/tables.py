#!/usr/bin/python3
"""The tables of the pages: made when a page is read, from the results in bench/ and from the program.

    docs/tables.py PAGE [--program build/barchan]            prints a page with its tables
    docs/tables.py --into DIR [--program build/barchan]      writes all pages of docs/ with their tables below DIR

A page names a table on a line of its own:

    {{ bench/ranks/weak.py: weak }}         the text `weak` of tables() of that file
    {{ barchan schema --markdown }}         what the program prints

docs/site.py builds the site with all of them.
"""
import argparse
import json
import re
import subprocess
import sys
from pathlib import Path

MARK = re.compile(r"^\{\{ (?:barchan ([\w -]+)|([\w/]+\.py): ([\w -]+)) \}\}$", flags=re.M)
PYTHON = "/usr/bin/python3"  # it has Debian's packages
CALL = "import json, runpy, sys; sys.argv[:] = sys.argv[1:]; print(json.dumps(runpy.run_path(sys.argv[0], run_name='tables')['tables']()))"


class NoTable(Exception):
    """A table that a page names cannot be made; the message says which and why."""


def output(command, what):
    ended = subprocess.run(command, capture_output=True, text=True)
    if ended.returncode != 0:
        raise NoTable(f"{what}: {(ended.stderr.strip() or 'no output').splitlines()[-1]}")
    return ended.stdout


class Tables:
    """Those of the repository `root`; `program` makes the ones that are its own."""

    def __init__(self, root, program=None):
        self.root, self.program, self.of = root, program or root / "build/barchan", {}

    def table(self, file, name):
        if file not in self.of:
            path = self.root / file
            self.of[file] = json.loads(output([PYTHON, "-B", "-c", f"import sys; sys.path.insert(0, {str(path.parent)!r}); {CALL}", path], file))
        if name not in self.of[file]:
            raise NoTable(f"{file} has no table {name}; it has {', '.join(self.of[file])}")
        return self.of[file][name]

    def filled(self, text):
        """A page's text with its tables. Throws NoTable."""
        def put(mark):
            made = output([self.program, *mark[1].split()], f"barchan {mark[1]}") if mark[1] else self.table(mark[2], mark[3])
            return made.strip("\n")
        return MARK.sub(put, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path, nargs="?")
    parser.add_argument("--into", type=Path)
    parser.add_argument("--program", type=Path)
    options = parser.parse_args()
    root = Path(__file__).resolve().parents[1]
    tables = Tables(root, options.program)
    try:
        if options.page:
            print(tables.filled(options.page.read_text()), end="")
        if options.into:
            for page in sorted(root.glob("docs/**/*.md")):
                place = options.into / page.relative_to(root / "docs")
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_text(tables.filled(page.read_text()))
    except NoTable as problem:
        sys.exit(f"tables: {problem}")


if __name__ == "__main__":
    main()
