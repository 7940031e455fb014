#!/usr/bin/env python3
"""The list of scenes in docs/gallery/README.md: each scene with its picture, what it shows and its size.

    docs/gallery.py [--root DIR]

The scenes are those of scenes/. docs/gallery/scenes.json has for each scene its picture (in docs/gallery), the ParaView state, the settings of the
run, the time, and what is seen in it; bench/gallery.py makes the pictures. A picture that is not there is left out. The status is 1 when a scene has
no row, or when a row names a scene that is not there. Without the file the scenes are listed without pictures.
"""
import argparse
import json
import re
import sys
from pathlib import Path


def title(scene):
    return re.search(r'^title *= *"(.*)"', scene.read_text(), flags=re.M)[1]


def command(row):
    settings = "".join(f" --set {entry}" if re.fullmatch(r"[\w.=+-]+", entry) else f" --set '{entry}'" for entry in row["settings"])
    return f"build/barchan run {row['scene']}{settings}"


def rows(root):
    file = root / "docs/gallery/scenes.json"
    return {row["scene"]: row for row in json.loads(file.read_text())} if file.exists() else {}


def table(root):
    pictures = rows(root)
    scenes = sorted(root.glob("scenes/**/*.toml"), key=lambda path: (len(path.parts), str(path)))
    lines = ["| scene | picture | what is seen, and the run |", "| --- | --- | --- |"]
    for scene in scenes:
        name = str(scene.relative_to(root))
        link = f"[{title(scene)}](../../{name})<br>`{name}`"
        row = pictures.get(name)
        if row is None:
            lines.append(f"| {link} | | |")
        else:
            moment = f" at {row['time']:.4g} s" if "time" in row else ""
            picture = f"![{title(scene)}]({row['picture']})" if (root / "docs/gallery" / row["picture"]).exists() else ""
            lines.append(f"| {link} | {picture} | {row['seen']} State `{row['state']}`{moment}.<br>`{command(row)}` |")
    return lines


def wrong(root):
    """What the rows name that is not there."""
    found, named = [], rows(root)
    scenes = [str(scene.relative_to(root)) for scene in sorted(root.glob("scenes/**/*.toml"))] if named else []
    found += [f"docs/gallery/scenes.json: no row of {scene}" for scene in scenes if scene not in named]
    return found + [f"docs/gallery/scenes.json: there is no {name}" for name in named if not (root / name).exists()]


def tables():
    """That of docs/gallery/README.md."""
    return {"scenes": "\n".join(table(Path(__file__).resolve().parents[1]))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1])
    options = parser.parse_args()
    problems = wrong(options.root)
    print("\n".join(problems), end="\n" if problems else "")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
