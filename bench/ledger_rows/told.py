"""Rows that are told by tests and pages: the figure is what the command printed when the page was written (tests.csv). Nothing but a person measures them anew."""

from ledger_rows import load, row

FILE = "ledger_rows/tests.csv"


def rows(bench):
    return [row(t["quantity"], t["case"], t["reference"], t["measured"], t["source"], FILE, bound=t["bound"], met=t["met"], bias=t.get("bias"))
            for t in load(bench, FILE)]
