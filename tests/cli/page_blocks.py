"""Carries out a page: its code blocks in order, as a reader would.

A block of a page is one of these; what it is stands in the page itself:

    ```sh      commands, run by bash in the folder of the reader. A line that ends with `# not run by the test` is left out.
    ```text    what the commands before it print: each line stands in their output, `...` for anything; blanks do not count
    ```toml    with a first line `# NAME.toml...`: the file of that name. Other blocks of TOML are parts of such files.
    ```python  with a first line `# NAME.py...`: likewise; so are blocks of other languages with such a first line
"""
import os
import re
import subprocess
from pathlib import Path

LEFT_OUT = "# not run by the test"
FILE = re.compile(r"^(?:#!.*\n)?(?:#|//|%) ([\w.-]+\.\w+)\b")


def blocks(page):
    """(language, text, line) of each fenced block."""
    found = []
    for match in re.finditer(r"^```(\w*)\n(.*?)^```$", page.read_text(), flags=re.S | re.M):
        found.append((match[1], match[2], page.read_text().count("\n", 0, match.start()) + 1))
    return found


def folder(at, program, source):
    """A folder that looks like the root of the repository after the build."""
    (at / "build").mkdir()
    (at / "build/barchan").symlink_to(program)
    for name in ("scenes", "pvstate", "bench", "docs", "python"):
        (at / name).symlink_to(source / name)
    tools = at / "tools"
    tools.mkdir()
    (tools / "python3").symlink_to("/usr/bin/python3")
    (tools / "barchan").symlink_to(program)
    return at


def environment(at, source):
    paths = [str(at / "tools"), os.environ["PATH"]]
    python = [str(source / "python"), os.environ.get("PYTHONPATH", "")]
    return {**os.environ, "PATH": ":".join(paths), "PYTHONPATH": ":".join(filter(None, python)), "OMP_NUM_THREADS": "1"}


class Failed(Exception):
    """A block that does not do what its page says."""


def carry_out(page, at, source):
    """Runs the page in the folder `at`; returns how many commands ran. Raises Failed with the block's line."""
    printed, count = "", 0
    for language, text, line in blocks(page):
        place = f"{page.relative_to(source)}:{line}"
        named = FILE.match(text)
        if language == "text":
            for wanted in filter(str.strip, text.splitlines()):
                pattern = ".*".join(re.escape(" ".join(part.split())) for part in wanted.split("..."))
                if not any(re.search(pattern, " ".join(row.split())) for row in printed.splitlines()):
                    raise Failed(f"{place}: this is not printed:\n  {wanted}\nbut this:\n{printed}")
        elif named:
            (at / named[1]).write_text(text)
        elif language == "sh":
            kept = "\n".join(row for row in text.splitlines() if not row.rstrip().endswith(LEFT_OUT))
            ended = subprocess.run(["bash", "-e", "-o", "pipefail", "-c", kept], cwd=at, env=environment(at, source), text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600)
            printed = ended.stdout
            if ended.returncode != 0:
                raise Failed(f"{place}: status {ended.returncode} of\n{kept}\n{printed}")
            count += sum(1 for row in kept.splitlines() if row.strip() and not row.lstrip().startswith("#"))
        elif language not in ("toml", "json"):
            raise Failed(f"{place}: a block of {language or 'no language'} without a name in its first line; nothing checks it")
    return count
