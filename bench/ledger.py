#!/usr/bin/python3
"""The bias ledger, docs/ledger.md: every quantity that is compared with an exact solution, a measurement, the paper or another program, misses first.

    /usr/bin/python3 bench/ledger.py --write                          notes the day of each file of results that has changed
    /usr/bin/python3 bench/ledger.py --measure build/barchan --write  measures what is cheap anew before that (see MEASURES; under 90 minutes on two cores)
    /usr/bin/python3 bench/ledger.py --check                          says whether results have changed since --write; exit status 1 if so

bench/ledger_rows/ says which rows there are and where each comes from. bench/ledger_rows/measured.csv holds for each file of results its checksum, the
command that makes it, and the day on which the ledger found it changed.
"""

import argparse
import datetime
import hashlib
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from barchan_bench import run, store, table  # noqa: E402
from ledger_rows import accuracy, bodies, sand, told  # noqa: E402

MEASURED = HERE / "ledger_rows/measured.csv"
FIELDS = ("quantity", "case", "reference", "measured", "bias", "scatter", "bound", "met", "source", "file")
LEAST = 100

# What --measure runs, and about how many minutes of one core it takes by the seconds in the results: forty in all. The rest (heaps, threshold, flux,
# resolved, the paper's scenes, LAMMPS) needs hours or other programs: its rows are those of the stored results.
MEASURES = (
    ("accuracy/cases.py", tuple(accuracy.SOURCES), 28),
    ("impacts/cases.py", (), 5),
    ("saltation/cases.py", ("settling", "hop", "splash"), 7),
)


def command_of(file):
    """The command that makes a file of results (a path from bench/)."""
    folder, name = file.split("/")[0], pathlib.Path(file).stem
    if name == "peers":
        return "by hand, as the file says"
    if folder in ("accuracy", "saltation"):
        if (folder, name) == ("saltation", "storm"):
            return "bench/saltation/storm.py"
        return f"bench/saltation/cases.py {name}" if folder == "saltation" else f"bench/accuracy/cases.py build/barchan {name} --write"
    return {"impacts": "bench/impacts/cases.py build/barchan", "paper": "bench/paper/figures.py build/barchan --write",
            "grains": "bench/grains/lammps.py", "ledger_rows": "of each row in the file, by hand"}[folder]


def days(rows, known, today):
    """measured.csv for these rows: a file whose checksum is new has the day `today`."""
    found = {}
    for file in sorted({r["file"] for r in rows}):
        checksum = hashlib.sha256((HERE / file).read_bytes()).hexdigest()[:16]
        old = known.get(file, {})
        found[file] = {"command": command_of(file), "checksum": checksum, "day": old["day"] if old.get("checksum") == checksum else today}
    return found


def number(value, digits=4):
    if value is None:
        return ""
    return value if isinstance(value, str) else f"{value:.{digits}g}"


def percent(bias):
    """A bias as per cent: two figures, at most two places behind the point unless it is tiny."""
    if bias is None:
        return ""
    return "0" if bias == 0 else f"{bias:+.1e}" if abs(bias) < .01 else f"{bias:+.2f}" if abs(bias) < 10 else f"{bias:+.0f}"


def order(row):
    """Misses first, then what has no bound, then what is met; within them the largest bias first."""
    rank = {"MISSED": 0, "": 1, "met": 2}[verdict(row)]
    return rank, -abs(row["bias"] or 0), row["case"], row["quantity"]


def verdict(row):
    return "" if row["met"] is None else "met" if row["met"] else "MISSED"


def text_of(rows, known):
    """The tables of docs/ledger.md."""
    missed = sum(verdict(r) == "MISSED" for r in rows)
    free = sum(verdict(r) == "" for r in rows)
    lines = [f"{len(rows)} rows: {missed} miss their bound, {len(rows) - missed - free} meet it, {free} have none and are told for comparison.", "",
             table.head("quantity", "case", "reference", "measured", "bias, %", "scatter", "bound", "", "source of the reference", "file")]
    numbers = {file: k + 1 for k, file in enumerate(sorted(known))}
    for r in sorted(rows, key=order):
        lines.append(table.row(r["quantity"], r["case"], number(r["reference"]), number(r["measured"]), percent(r["bias"]), number(r["scatter"], 2),
                               number(r["bound"]), verdict(r), r["source"], numbers[r["file"]]))
    lines += ["", "## When and how they were measured", "",
              "The day is that on which the ledger first found the file as it is; the measurement was on that day or before.", "",
              table.head("", "results", "command", "day")]
    for file, k in sorted(numbers.items(), key=lambda item: item[1]):
        about = known[file]
        command = f"`/usr/bin/python3 {about['command']}`" if about["command"].startswith("bench/") else about["command"]
        lines.append(table.row(k, f"`bench/{file}`", command, about["day"]))
    return "\n".join(lines) + "\n"


def rows_now():
    """All rows, from the stored results. Throws when one is not complete."""
    rows = [*accuracy.rows(HERE), *bodies.rows(HERE), *sand.rows(HERE), *told.rows(HERE)]
    for r in rows:
        lacking = [f for f in FIELDS if f not in r] + [f for f in ("quantity", "case", "source", "file") if not r.get(f)]
        if lacking:
            raise SystemExit(f"ledger: a row lacks {', '.join(lacking)}: {r}")
    return rows


def tables():
    """That of docs/ledger.md."""
    return {"ledger": text_of(rows_now(), store.load(MEASURED))}


def measure(program, only):
    """Runs what MEASURES names, or of it the cases `only`; their programs write their results and pages themselves. A figure that misses its bound
    (status 1) is a row as any other; a program that breaks down is named."""
    for script, names, minutes in MEASURES:
        chosen = [name for name in names if not only or name in only]
        if only and not chosen:
            continue
        print(f"ledger: {script} {' '.join(chosen)} (about {minutes} minutes of one core for all)", flush=True)
        words = [*chosen, "--barchan", program] if script.startswith("saltation") else [program, *chosen, *["--write"] * script.startswith("accuracy")]
        ended = run.command([sys.executable, HERE / script, *words], shown=True)
        if ended.status not in (0, 1):
            sys.exit(f"ledger: {script} ended with status {ended.status}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", metavar="PROGRAM")
    parser.add_argument("--only", default="", help="with --measure: these cases, by comma")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.measure:
        measure(given.measure, list(filter(None, given.only.split(","))))
    rows, known = rows_now(), store.load(MEASURED, {})
    known = days(rows, known, str(datetime.date.today()))
    if given.check:
        if known != store.load(MEASURED):
            sys.exit("ledger: results have changed since their days were noted: run /usr/bin/python3 bench/ledger.py --write")
        if len(rows) < LEAST:
            sys.exit(f"ledger: {len(rows)} rows, expected {LEAST} or more")
    elif given.write:
        store.keep(MEASURED, known)
    if not given.check:
        print(f"{len(rows)} rows, {sum(verdict(r) == 'MISSED' for r in rows)} missed")


if __name__ == "__main__":
    main()
