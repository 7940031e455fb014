#!/usr/bin/env python3
"""Breaks the lines of the pages at one width.

    docs/wrap.py [--write | --check] [PAGE...] [--root DIR]    (default: all pages; --check)

A paragraph or an item of a list with a line of more than 140 characters is filled anew. Tables, code, headings, pictures, quotes and what programs
write between `<!-- NAME: begin -->` and its end stay as they are. Code in a line and links are never cut. --check has status 1 and
names each line that is too long.
"""
import argparse
import re
import sys
from pathlib import Path

WIDTH = 140
WHOLE = re.compile(r"!?\[[^\]]*\]\([^)]*\)|`[^`]*`|\S")  # \S: any other character of a word
ITEM = re.compile(r"^( *)([-*] |\d+\. )")
AS_IT_IS = re.compile(r"^(\||#|>|!\[|<!--|    )")


def words(text):
    """Words, in which marks, links and code are single characters."""
    found, at = [], 0
    while at < len(text):
        if text[at].isspace():
            at += 1
            continue
        begin = at
        while at < len(text) and not text[at].isspace():
            at = WHOLE.match(text, at).end()
        found.append(text[begin:at])
    return found


def filled(lines):
    """One paragraph or item, at the width."""
    item = ITEM.match(lines[0])
    first = item[0] if item else re.match(r" *", lines[0])[0]
    indent = " " * len(first)
    text = " ".join(line.strip() for line in lines)[len(item[2]) if item else 0:]
    out, row = [], first
    for word in words(text):
        if row.strip() and row != first and len(row) + 1 + len(word) > WIDTH:
            out.append(row)
            row = indent + word
        else:
            row += word if row in (first, indent) else " " + word
    return [*out, row]


def units(text):
    """(lines, whether they may be filled) in the order of the page."""
    lines, at, fenced, made = text.split("\n"), 0, False, False
    while at < len(lines):
        line = lines[at]
        if line.lstrip().startswith("```"):
            fenced = not fenced
        if re.match(r"<!-- [\w ./-]+: begin -->", line):
            made = True
        if re.match(r"<!-- [\w ./-]+: end -->", line):
            made = False
        if fenced or made or not line.strip() or line.lstrip().startswith("```") or AS_IT_IS.match(line):
            yield [line], False
            at += 1
            continue
        end = at + 1
        while end < len(lines) and lines[end].strip() and not ITEM.match(lines[end]) and not AS_IT_IS.match(lines[end]) \
                and not lines[end].lstrip().startswith("```"):
            end += 1
        yield lines[at:end], True
        at = end


def wrapped(text):
    out = []
    for lines, free in units(text):
        out += filled(lines) if free and any(len(line) > WIDTH for line in lines) else lines
    return "\n".join(out)


def too_long(text):
    """Numbers of the lines that could be shorter."""
    number, found = 1, []
    for lines, free in units(text):
        found += [number + k for k, line in enumerate(lines) if free and len(line) > WIDTH and len(words(line)) > 1]
        number += len(lines)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--root", type=Path, default=Path(__file__).resolve().parents[1])
    options = parser.parse_args()
    root = options.root
    status = 0
    for page in options.pages or [*sorted(root.glob("*.md")), *sorted(root.glob("docs/**/*.md"))]:
        text = page.read_text()
        if options.write:
            page.write_text(wrapped(text))
        else:
            for number in too_long(text):
                print(f"{page}:{number}: a line of more than {WIDTH} characters; docs/wrap.py --write breaks it")
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
