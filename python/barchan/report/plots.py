"""Plots of a report as SVG in the page. Colours of Okabe & Ito (2008), a line style besides, so that nobody depends on colours."""

import io
import os
import re
import warnings

import numpy

from ..errors import package
from ..tables import bare

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")  # blue, vermilion, green, purple, orange, sky, black
STYLES = ("-", "--", "-.", ":")
MOST_LINES = 7      # in one plot
SMALLEST_SHARE = 5e-3  # of the largest line: smaller ones get a plot of their own
MOST_POINTS = 600   # of one line; of more, the least and the largest of each piece are drawn


def pyplot():
    """matplotlib's pyplot, which draws without a display. Throws PackageMissing."""
    here = os.open(".", os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.chdir(os.path.dirname(__file__))  # matplotlib reads a file "matplotlibrc" of the folder that it is loaded in, which may be another person's
        matplotlib = package("matplotlib", "python3-matplotlib", "a report")
    finally:
        os.fchdir(here)
        os.close(here)
    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.fonttype": "none", "text.parse_math": False, "text.usetex": False, "font.family": "sans-serif", "svg.hashsalt": "barchan", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True,
                                "grid.color": "#e4e4e4", "grid.linewidth": .6, "lines.linewidth": 1.4, "path.simplify": True, "path.simplify_threshold": .3,
                                "axes.formatter.limits": (-3, 4), "legend.frameon": False, "legend.fontsize": 8})
    import matplotlib.pyplot
    return matplotlib.pyplot


def svg(figure):
    """The <svg> element of a figure, which is closed."""
    out = io.StringIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a plot of nothing but nan
        figure.savefig(out, format="svg", metadata={"Date": None, "Creator": None})
    pyplot().close(figure)
    text = out.getvalue()
    text = re.sub(r"<metadata>.*?</metadata>", "", text[text.index("<svg"):], flags=re.S)
    svg.count += 1  # ids are used by references within one figure: make them unique in the page
    text = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>f{svg.count}-", text)
    return text.replace('xmlns:xlink="http://www.w3.org/1999/xlink"', "").replace('xmlns="http://www.w3.org/2000/svg"', "").replace("xlink:href", "href")


svg.count = 0


def thinned(x, y):
    """x and y with at most MOST_POINTS points; the extremes of each piece stay."""
    if len(x) <= MOST_POINTS:
        return x, y
    edges = numpy.linspace(0, len(x), MOST_POINTS // 2 + 1).astype(int)
    kept = [0, len(x) - 1]
    for a, b in zip(edges[:-1], edges[1:]):
        piece = y[a:b]
        if numpy.isfinite(piece).any():
            kept += [a + int(numpy.nanargmin(piece)), a + int(numpy.nanargmax(piece))]
    kept = numpy.unique(kept)
    return x[kept], y[kept]


def panel(labels, width, height):
    """A figure of this width (inches) and its axes of this height, with room below for a legend of the `labels`: nothing has to be measured, which would take as long as drawing."""
    across = 2 if width > 5 and max(map(len, labels), default=0) < 36 else 1
    below = .48 + .17 * -(-len(labels) // across) + (.16 if labels else 0)
    figure, axes = pyplot().subplots(figsize=(width, height + below))
    figure.subplots_adjust(left=.72 / width, right=1 - .1 / width, top=1 - .2 / (height + below), bottom=below / (height + below))
    axes.legend_below = lambda: axes.legend(loc="upper left", bbox_to_anchor=(-.04, -.47 / (height - .2)), ncol=across, handlelength=2.4, borderaxespad=0, labelspacing=.25) if labels else None
    return figure, axes


def lines(x, columns, xlabel, ylabel, upright=False, log=False):
    """One plot of `columns` (label: values) over x; `upright`: x is a height and stands upwards. An <svg>."""
    figure, axes = panel(list(columns) if len(columns) > 1 else [], 3.1 if upright else 5.6, 2.9 if upright else 2.4)
    for k, (label, y) in enumerate(columns.items()):
        a, b = thinned(x, y)
        short = len(x) < 25
        axes.plot(*((b, a) if upright else (a, b)), STYLES[k // len(COLOURS) if len(columns) > len(COLOURS) else k % len(STYLES)], color=COLOURS[k % len(COLOURS)], label=label,
                  marker="o" if short else None, markersize=3)
    (axes.set_ylabel if upright else axes.set_xlabel)(xlabel)
    (axes.set_xlabel if upright else axes.set_ylabel)(ylabel)
    axes.locator_params(axis="x", nbins=4 if upright else 6)
    if log:
        (axes.set_xscale if upright else axes.set_yscale)("log")
    axes.legend_below()
    return svg(figure)


# ---- history -------------------------------------------------------------------------------------------------------------------------------------------------------------

FAMILIES = (  # heading, pattern of the columns' names without units
    ("Friction velocity u* of the wind", r".*friction_velocity$"),
    ("Stress that drives the wind, and at the ground", r".*(_pull|_ground_stress|_bed_stress)$"),
    ("Flux of grains", r".*_flux$"),
    ("Energies", r".*(kinetic_energy|potential_energy|compression_energy|internal_energy|strain_energy|hourglass_energy|stored_energy|lost_energy|rotation_energy|taken_energy|_work)$"),
    ("What took energy of a fluid since the start", r".*_taken_(by_[a-z_]+|unexplained)$"),
    ("Largest speed", r".*largest_speed$"),
    ("Mean velocity", r".*mean_v[xyz]$"),
    ("Centre of mass", r".*_centre_[xyz]$"),
    ("Density error", r".*density_error(_rms)?$"),
    ("Mean pressure", r".*mean_pressure$"),
    ("Step", r"dt$"),
    ("Momentum", r"momentum_[xyz]$"),
    ("Angular momentum", r".*angular_momentum(_[xyz])?$"),
    ("Grains in flight", r".*(in_flight)$"),
    ("Bed height", r".*_bed$"),
    ("Forces", r".*_force_[xyz]$"),
    ("Torques", r".*_torque(_[xyz])?$"),
    ("Impulses", r".*_impulse(_[xyz])?$"),
    ("Contacts", r"(contacts|asleep)$"),
    ("Deepest overlap of contacts", r"(contacts_deepest|.*_overlap)$"),
    ("What passed the sides", r".*_(in|out|left)$"),
)


def is_round_off(full, history):
    """Whether a column with a unit is everywhere smaller than 1e-11 of the largest value with this unit: the momentum along x of a body that falls, for one."""
    unit = history.unit(full)
    top = lambda values: abs(values[numpy.isfinite(values)]).max(initial=0.)
    return bool(unit) and bare(full) != "dt" and top(history[full]) < 1e-11 * max(top(values) for other, values in history.items() if history.unit(other) == unit and bare(other) != "time")


def history_groups(history):
    """Plots of history.csv as (heading, unit, columns), in the order of FAMILIES, then by unit; and the columns that never change, or by round-off alone, as (name, unit, value). Each
    column is in one."""
    rest = {full: values for full, values in history.items() if bare(full) not in ("time", "step")}
    constant = []
    for full in list(rest):
        finite = rest[full][numpy.isfinite(rest[full])]
        if not len(finite) or numpy.ptp(finite) <= 1e-9 * abs(finite).max():  # round-off is no change
            constant.append((bare(full), history.unit(full), float(finite[0]) if len(finite) else float("nan")))
            del rest[full]
    for full in [full for full in rest if is_round_off(full, history)]:
        constant.append((bare(full), history.unit(full), float(rest.pop(full)[-1])))
    groups = []
    for heading, pattern in FAMILIES:
        chosen = [full for full in rest if re.fullmatch(pattern, bare(full))]
        for unit in dict.fromkeys(history.unit(full) for full in chosen):
            of_unit = [full for full in chosen if history.unit(full) == unit]
            groups.append((heading, unit, {bare(full): rest.pop(full) for full in of_unit}))
    for unit in dict.fromkeys(history.unit(full) for full in rest):
        groups.append((f"Others in {unit}" if unit else "Other numbers", unit, {bare(full): rest[full] for full in rest if history.unit(full) == unit}))
    return [piece for group in groups for piece in pieces(*group)], constant


def pieces(heading, unit, columns):
    """A plot of too many lines, or of lines of which some would be flat beside others, as several."""
    top = {name: float(abs(values[numpy.isfinite(values)]).max()) for name, values in columns.items()}
    parts, rest = [], list(columns)
    while rest:
        largest = max(top[name] for name in rest)
        chosen = [name for name in rest if top[name] >= SMALLEST_SHARE * largest]
        parts += [chosen[k:k + MOST_LINES] for k in range(0, len(chosen), MOST_LINES)]
        rest = [name for name in rest if name not in chosen]
    for k, names in enumerate(parts):
        yield heading + (f" ({k + 1})" if len(parts) > 1 else ""), unit, {name: columns[name] for name in names}


def history_plots(history):
    """(heading, <svg>) of each plot of the history, and the constant columns."""
    t = history["time [s]"]
    groups, constant = history_groups(history) if len(t) > 1 else ([], [])
    name = lambda heading, columns: f"{heading}: {next(iter(columns))}" if len(columns) == 1 else heading
    return [(name(heading, columns), lines(t, columns, "time (s)", unit)) for heading, unit, columns in groups], constant


# ---- instruments -----------------------------------------------------------------------------------------------------------------------------------------------------------

def instrument_plots(name, table):
    """(heading, <svg>) of the plots of one table of an instrument; an empty list when it holds no sample."""
    places = [full for full in table if bare(full) in ("time", "x", "y", "z", "height_over_bed")]
    values = {full: v for full, v in table.items() if full not in places and bare(full) != "samples" and numpy.isfinite(v).any()}
    if not values or not places or table.length < 2:
        return []
    if bare(places[0]) == "time":
        along = places[0]
    elif "height_over_bed" in table:
        along = next(full for full in places if bare(full) == "height_over_bed")
    else:
        along = max(places, key=lambda full: numpy.ptp(table[full]))
    upright = bare(along) in ("height_over_bed", "z") or (bare(along) == "y")
    groups = {}
    for full, v in values.items():
        base = re.sub(r"_(x|y|z)$", "", bare(full))
        groups.setdefault((base, table.unit(full)), {})[bare(full)] = v
    plots = []
    for (base, unit), columns in groups.items():
        positive = name.startswith("saltation_") and base in ("flux", "concentration") and all((v[numpy.isfinite(v)] >= 0).all() and (v > 0).sum() > 2 for v in columns.values())
        shown = {n: numpy.where(v > 0, v, numpy.nan) for n, v in columns.items()} if positive else columns
        plots.append((base.replace("_", " "), lines(table[along], shown, f"{bare(along).replace('_', ' ')} ({table.unit(along)})", unit, upright, positive)))
    return plots


def grid_plots(grid):
    """(heading, <svg>) of the mean speed or the first scalar of a grid in 2D."""
    if len(grid.axes[2]) > 1 or min(len(axis) for axis in grid.axes[:2]) < 2:
        return []
    plt, plots = pyplot(), []
    for name in ("velocity_mean", "pressure_mean"):
        if name not in grid.arrays:
            continue
        values = grid[name][0]
        values = numpy.sqrt((values ** 2).sum(axis=-1)) if values.ndim == 3 else values
        if not numpy.isfinite(values).any():
            continue
        x, y = grid.axes[:2]
        figure, axes = plt.subplots(figsize=(5.6, 4.6 * min(max((y[-1] - y[0]) / (x[-1] - x[0]), .25), .9) + .6), layout="constrained")
        image = axes.imshow(values, origin="lower", extent=(x[0], x[-1], y[0], y[-1]), cmap="viridis" if name == "velocity_mean" else "cividis", aspect="equal")
        axes.grid(False)
        axes.set_xlabel("x (m)")
        axes.set_ylabel("y (m)")
        figure.colorbar(image, label="mean speed (m/s)" if name == "velocity_mean" else "mean pressure (Pa)", shrink=.8)
        plots.append((name.replace("_", " "), svg(figure)))
    return plots
