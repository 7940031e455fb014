"""Markdown tables, and figures beside their bounds: a figure that misses its bound is marked MISSED."""

from barchan_bench.run import Broken, Seconds

rows = []  # what has been reported, for the results' file; who begins anew clears it


def row(*cells):
    """A line of a table."""
    return "| " + " | ".join(map(str, cells)) + " |"


def head(*names):
    """The first two lines of a table."""
    return row(*names) + "\n" + "| --- " * len(names) + "|"


def missed(good):
    """The mark of a figure beside its bound."""
    return "" if good else "MISSED"


HEAD = "| case | scheme | N | figure | measured | bound | | user CPU s | particle-steps/s |\n" + "| --- " * 9 + "|"


def line(r):
    """The line of what `report`, `tell` or `attempt` kept."""
    rate = f"{r['rate'] / 1e6:.2f} M" if r["rate"] else ""
    bound = r["bound"] if r["bound"] is not None else ""
    if isinstance(bound, float | int):
        bound = f"{'>=' if r['at_least'] else '<='} {bound:g}"
    value = r["value"] if isinstance(r["value"], str) else f"{r['value']:.3g}"
    time = f"{r['seconds']:.1f}" if r["seconds"] else ""
    return row(r["case"], r["scheme"], r["n"], r["what"], value, bound, missed(r["good"]), time, rate)


def report(case, scheme, n, what, value, bound, seconds, at_least=False):
    """One figure, which may not be above its bound (with at_least: below it). A bound of None: nothing is asked of it."""
    good = bound is None or bool(value >= bound if at_least else value <= bound)
    rate = seconds.work / seconds if isinstance(seconds, Seconds) and seconds > 0 else None
    rows.append({"case": case, "scheme": scheme, "n": n, "what": what, "value": float(value), "bound": bound, "at_least": at_least,
                 "good": good, "seconds": round(float(seconds), 2), "rate": rate})
    print(line(rows[-1]), flush=True)


def tell(case, scheme, n, what, value, beside, seconds):
    """A figure in words, without a bound, with what others found."""
    rows.append({"case": case, "scheme": scheme, "n": n, "what": what, "value": str(value), "bound": beside, "good": True,
                 "seconds": round(float(seconds), 2), "rate": None})
    print(line(rows[-1]), flush=True)


def attempt(case, scheme, n, measure):
    """Calls measure(); a run that breaks down is a missed figure with the program's message, and the others go on."""
    try:
        measure()
    except Broken as broken:
        rows.append({"case": case, "scheme": scheme, "n": n, "what": "runs to the end", "value": str(broken).replace("|", "/")[:160],
                     "bound": "status 0", "good": False, "seconds": 0., "rate": None})
        print(line(rows[-1]), flush=True)
