#!/usr/bin/python3
"""The bias ledger (bench/ledger.py): 100 rows or more, misses first, and no row without a source; the days of the results are those of their files.

    /usr/bin/python3 tests/cli/test_ledger.py PROGRAM ROOT"""

import pathlib
import sys
import unittest

import numpy

ROOT = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else pathlib.Path(__file__).resolve().parents[2])
sys.path.insert(0, str(ROOT / "bench"))
import ledger  # noqa: E402
from barchan_bench import statistics, store  # noqa: E402


def table_of(page):
    """Cells of the rows of the ledger's table."""
    lines = page.split("| quantity |")[1].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


class Ledger(unittest.TestCase):
    page = ledger.tables()["ledger"]

    def test_the_days_are_those_of_the_stored_results(self):
        known = store.load(ledger.MEASURED)
        self.assertEqual(ledger.days(ledger.rows_now(), known, "another day"), known, "results changed: /usr/bin/python3 bench/ledger.py --write")

    def test_rows(self):
        rows = table_of(self.page)
        self.assertGreaterEqual(len(rows), ledger.LEAST)
        for row in rows:
            self.assertEqual(len(row), 10, row)
            self.assertTrue(row[0] and row[1] and row[3], f"what was measured? {row}")
            self.assertTrue(row[8], f"no source: {row}")
            self.assertTrue("exact" in row[8] or any(c.isdigit() for c in row[8]) or "law of the wall" in row[8], f"a source has a year, or is exact: {row[8]}")
        verdicts = [row[7] for row in rows]
        self.assertEqual(verdicts, sorted(verdicts, key=("MISSED", "", "met").index), "misses come first")

    def test_no_stored_miss_is_left_out(self):
        """Figures of bench/accuracy that miss their bound, counted apart from the ledger's own choice."""
        missed = sum(not r["good"] for file in (ROOT / "bench/accuracy/results").glob("*.csv") if file.stem in ledger.accuracy.SOURCES | ledger.accuracy.LONG
                     for r in store.load(file)["rows"])
        flows = [r for r in ledger.accuracy.rows(ROOT / "bench") if ledger.verdict(r) == "MISSED"]
        self.assertEqual(len(flows), missed)

    def test_a_bias_has_the_sign_and_size_of_its_figures(self):
        from ledger_rows import row
        self.assertAlmostEqual(row("q", "c", 4., 5., "s", "f")["bias"], 25)
        self.assertAlmostEqual(row("q", "c", -4., -5., "s", "f")["bias"], -25)
        self.assertAlmostEqual(row("q", "c", 0, .02, "s", "f")["bias"], 2)

    def test_error_of_the_mean_of_values_that_follow_each_other(self):
        """An autoregressive series x(i) = a x(i-1) + noise has the correlation time (1 + a)/(1 - a)."""
        noise, a = numpy.random.default_rng(1).normal(size=150000), .8
        x = numpy.zeros(150000)
        for k in range(1, len(x)):
            x[k] = a * x[k - 1] + noise[k]
        self.assertAlmostEqual(statistics.autocorrelation_time(x), 9, delta=.9)
        error, independent = statistics.error_of_mean(x)
        self.assertAlmostEqual(error, 1 / (1 - a) / len(x)**.5, delta=.1 / (1 - a) / len(x)**.5)   # sqrt of sum of covariances over n
        self.assertAlmostEqual(independent, len(x) / 9, delta=len(x) / 90)
        self.assertAlmostEqual(statistics.autocorrelation_time(noise), 1, delta=.1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
