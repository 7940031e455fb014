"""What stands between two marks of a page of docs/, and what pictures and results share."""

import platform

# Okabe & Ito 2008, colours that the colour-blind can tell apart
BLACK, ORANGE, SKY, GREEN, BLUE, VERMILION, PURPLE = "#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"


def marks(name):
    """The lines between which a program writes."""
    return f"<!-- {name}: begin -->", f"<!-- {name}: end -->"


def fill(page, name, text):
    """Writes the lines `text` between the marks `name` of a page; all else stays as it is."""
    begin, end = marks(name)
    before, found_begin, rest = page.read_text().partition(begin)
    _, found_end, after = rest.partition(end)
    if not found_begin or not found_end:
        raise RuntimeError(f"{page} has lost its marks {begin} and {end}")
    page.write_text(f"{before}{begin}\n{text}\n{end}{after}")


def processor():
    """The name of the processor, as results keep it."""
    try:
        return next(line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def pyplot():
    """matplotlib's pyplot, which draws without a display."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot
    return matplotlib.pyplot
