#!/usr/bin/env python3
"""Builds the pages as a site that can be searched, with mkdocs, and checks its links.

    docs/site.py [--out DIR] [--root DIR] [--program build/barchan]    (default: build-site/)

A copy of the pages, with their tables (docs/tables.py), and of the files they lead to is made, so that links into the repository lead somewhere. Status 1
when mkdocs warns, when a table cannot be made, when a page stands in no menu, when a link or its anchor leads nowhere, or when a page would fetch something from the network.
It prints which pages have long sentences (docs/reading.py), and fails for none.
"""
import argparse
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse
from html.parser import HTMLParser
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import reading  # noqa: E402
from tables import NoTable, Tables  # noqa: E402

IN_PLACE_OF = {"scenes": "docs/gallery/README.md", "docs/gallery": "docs/gallery/README.md"}  # of a folder, which has no page


def pages(root):
    return [*sorted(root.glob("*.md")), *sorted(root.glob("docs/**/*.md"))]


def gather(root, to, tables):
    for page in pages(root):
        def link(match, page=page):
            target = match[1].partition("#")[0]
            file = (page.parent / target).resolve()
            if not target or re.match(r"[a-z]+:", target) or not file.exists():
                return match[0]
            if file.is_dir():
                folder = str(file.relative_to(root))
                other = IN_PLACE_OF.get(folder if folder in IN_PLACE_OF else folder.split("/")[0], "README.md")
                return f"]({'../' * (len(page.relative_to(root).parts) - 1)}{other}"
            if file.suffix != ".md":
                place = to / file.relative_to(root)
                place.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(file, place)
            return match[0]

        place = to / page.relative_to(root)
        place.parent.mkdir(parents=True, exist_ok=True)
        text = re.sub(r"^( *)```[\w-]+$", r"\1```", tables.filled(page.read_text()), flags=re.M)  # no language: nothing highlights it
        place.write_text(re.sub(r"\]\(([^)\s]+)", link, text))


class Links(HTMLParser):
    """The links, anchors and fetched files of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors, self.fetched = [], set(), []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.anchors.update(attributes[key] for key in ("id", "name") if attributes.get(key))
        if tag == "a" and attributes.get("href"):
            self.links.append(attributes["href"])
        self.fetched += [attributes[key] for key in ("src", "href") if tag in ("script", "img", "link") and attributes.get(key)]


def wrong_links(site):
    parsed = {file.resolve(): Links(file.read_text()) for file in site.rglob("*.html")}
    found = []
    for file, page in parsed.items():
        where = file.relative_to(site.resolve())
        if where.name in ("404.html", "search.html"):
            continue
        found += [f"{where}: fetches {url}" for url in page.fetched if re.match(r"(https?:)?//", url)]
        for url in page.links + [url for url in page.fetched if not re.match(r"(https?:)?//", url)]:
            parts = urllib.parse.urlsplit(url)
            if parts.scheme or parts.netloc:
                continue
            target = (file.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else file
            if target.is_dir():
                target /= "index.html"
            if not target.exists():
                found.append(f"{where}: {url} is not there")
            elif parts.fragment and target in parsed and urllib.parse.unquote(parts.fragment) not in parsed[target].anchors:
                found.append(f"{where}: {url} has no such anchor")
    return found


def build(root, out, program=None):
    """The problems found; none when the site is whole."""
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        try:
            gather(root, work / "pages", Tables(root, program))
        except NoTable as problem:
            return [f"tables: {problem}"]
        (work / "mkdocs.yml").write_text(f"INHERIT: {root}/mkdocs.yml\ndocs_dir: {work}/pages\n")
        ended = subprocess.run(["mkdocs", "build", "--strict", "-f", work / "mkdocs.yml", "-d", out], capture_output=True, text=True)
    if ended.returncode != 0:
        return [line for line in (ended.stdout + ended.stderr).splitlines() if line.strip() and not line.startswith("INFO")]
    menu = (root / "mkdocs.yml").read_text()
    lost = [f"mkdocs.yml: {page.relative_to(root)} stands in no menu" for page in pages(root) if f": {page.relative_to(root)}\n" not in menu]
    return lost + wrong_links(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1])
    parser.add_argument("--out", type=Path)
    parser.add_argument("--program", type=Path)
    options = parser.parse_args()
    out = (options.out or options.root / "build-site").resolve()
    problems = build(options.root.resolve(), out, options.program)
    print("\n".join([*reading.report(options.root.resolve()), *(problems or [f"site    {out}/index.html"])]))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
