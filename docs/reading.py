#!/usr/bin/python3
"""How long the pages and their sentences are, and which words a reader must guess. It prints and fails nothing.

    docs/reading.py [PAGE...] [--long]     (default: all pages; --long lists every sentence of more than 40 words)

Counted are the words of paragraphs and lists: not those of code, tables, headings and pictures.
"""
import argparse
import re
import statistics
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LONGEST = 40  # words
MEDIAN = 17
# Particles, ranks and files are no persons, and "beside" has three meanings.
GUESSED = re.compile(r"\b(feels?|felt|knows?|knew|tells?|told|hears?|heard|calm|lonely|gives? way|come along|beside|asks?|wants?|wins?)\b", re.I)


def sentences(text):
    """The sentences of a page's paragraphs and lists."""
    text = re.sub(r"```.*?```", "", text, flags=re.S)
    blocks, block = [], []
    for line in [*text.split("\n"), ""]:
        begins = re.match(r" *([-*]|\d+\.) ", line)
        if begins or not line.strip() or re.match(r"(\||#|>|!\[|<|    |\{\{)", line):
            blocks.append(" ".join(block))
            block = []
        if line.strip() and not re.match(r"(\||#|>|!\[|<|\{\{|    (?! *([-*]|\d+\.) ))", line):
            block.append(re.sub(r"^ *([-*]|\d+\.) ", "", line).strip())
    found = []
    for words in blocks:
        words = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", words)
        words = re.sub(r"`[^`]*`", "Code", words).replace("**", "")
        found += [s for s in re.split(r"(?<=[.!?:])\s+(?=[A-Z(])", words) if len(s.split()) > 1]
    return found


def read(text):
    """Words, median and longest sentence, sentences that are too long, and the words to be guessed."""
    found = sentences(text)
    lengths = [len(s.split()) for s in found] or [0]
    return {"words": sum(lengths), "median": statistics.median(lengths), "longest": max(lengths),
            "long": [s for s in found if len(s.split()) > LONGEST], "guessed": len(GUESSED.findall(" ".join(found)))}


def report(root, pages=()):
    """A line for each page that exceeds, and one for all (default: all pages but the changelog, which is a list)."""
    lines, total, lengths = [], 0, [0]
    for page in pages or pages_of(root):
        of = read(page.read_text())
        total += of["words"]
        lengths += [len(s.split()) for s in sentences(page.read_text())]
        if of["median"] > MEDIAN or of["long"] or of["guessed"]:
            lines.append(f"{str(page.relative_to(root)):32} {of['words']:6d} words, median {of['median']:4.1f}, longest {of['longest']:3d}, "
                         f"{len(of['long']):3d} above {LONGEST}, {of['guessed']:3d} words to be guessed")
    return [*lines, f"reading: {total} words in {len(lengths)} sentences, median {statistics.median(lengths):.0f}, longest {max(lengths)}"]


def pages_of(root):
    return [page for page in [*sorted(root.glob("*.md")), *sorted(root.glob("docs/**/*.md"))] if page.name != "CHANGELOG.md"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", type=Path)
    parser.add_argument("--long", action="store_true")
    options = parser.parse_args()
    print("\n".join(report(ROOT, [page.resolve() for page in options.pages])))
    for page in (options.pages or pages_of(ROOT)) if options.long else ():
        for sentence in read(page.read_text())["long"]:
            print(f"\n{page}: {sentence}")


if __name__ == "__main__":
    main()
