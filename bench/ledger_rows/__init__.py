"""The rows of the bias ledger (bench/ledger.py): accuracy.py flows, bodies.py bodies and impacts, sand.py wind and sand. A row is a dictionary made by `row`."""

from barchan_bench import store


def row(quantity, case, reference, measured, source, file, bound=None, met=None, scatter=None, bias=None):
    """One row. `reference` and `measured` are numbers (or words, then `bias` says the bias in per cent). `bound`: words, with `met`; None: nothing is
    asked. `file`: the file of the results, from bench/."""
    if bias is None and isinstance(measured, float | int):
        bias = 100 * measured if reference in (0, None) else 100 * (measured - reference) / abs(reference)
    return {"quantity": quantity, "case": case, "reference": reference, "measured": measured, "bias": bias, "scatter": scatter, "bound": bound,
            "met": met, "source": source, "file": file}


def load(bench, file):
    """Results in a file, from bench/."""
    return store.load(bench / file)


def within(value, most):
    """Words and verdict of a bound on the size of a bias (per cent)."""
    return f"within {most:g} %", bool(abs(value) <= most)
