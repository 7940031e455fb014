"""What pictures and results share. Tables of a page: a function tables() of the program (docs/tables.py)."""

import platform

# Okabe & Ito 2008, colours that the colour-blind can tell apart
BLACK, ORANGE, SKY, GREEN, BLUE, VERMILION, PURPLE = "#000000", "#E69F00", "#56B4E9", "#009E73", "#0072B2", "#D55E00", "#CC79A7"


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
