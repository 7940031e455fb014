"""Pictures for a paper: text, axes and colour bars as letters and lines (PDF, SVG, or PNG of 300 dots an inch) around what ParaView drew.

ParaView draws the data alone (BARCHAN_PLAIN) and says beside the picture, in a .json of the same name, what stands around it.
"""
import json
import math

DOTS = 300              # an inch, of what ParaView draws
LETTERS = 7.5           # points
MILLIMETRE = 1 / 25.4   # inch
BAR_BESIDE, BAR_BELOW, LEFT, BELOW, ABOVE, EDGE = 17.0, 11.5, 12.0, 9.0, 6.0, 2.0   # mm


def pixels(width):
    """How wide ParaView draws for a figure of a width in mm, before it knows the form of the data."""
    return int(round((width - LEFT - EDGE) * MILLIMETRE * DOTS))


def compose(drawn, words, targets, width):
    """Writes one figure of `width` mm: `drawn` is the picture (PNG), `words` the .json, `targets` the files (.pdf, .svg, .png)."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import image, pyplot
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize
    about = json.loads(words.read_text())
    data = image.imread(drawn)
    high, wide = data.shape[:2]
    beside = about["bars"] and wide < 1.6 * high
    left, below = (LEFT, BELOW) if about["axes"] else (EDGE, EDGE)
    under = below + (BAR_BELOW if (about["bars"] or about["arrow"]) and not beside else 0.0)
    across = width - left - EDGE - (BAR_BESIDE if beside else 0.0)
    up = across * high / wide
    height = under + up + ABOVE
    with pyplot.rc_context({"font.size": LETTERS, "axes.linewidth": 0.5, "xtick.major.width": 0.5, "ytick.major.width": 0.5, "xtick.major.size": 2.5,
                            "ytick.major.size": 2.5, "svg.fonttype": "none", "pdf.fonttype": 42, "savefig.dpi": DOTS}):
        figure = pyplot.figure(figsize=(width * MILLIMETRE, height * MILLIMETRE))

        def place(x, y, w, h):   # mm from the left and from below
            return figure.add_axes([x / width, y / height, w / width, h / height])
        axes = place(left, under, across, up)
        if about["axes"]:
            a = about["axes"]
            axes.imshow(data, extent=[v * a["factor"] for v in a["box"]], aspect="auto", interpolation="none")
            axes.set_xlabel(f"x ({a['unit']})", labelpad=1.5)
            axes.set_ylabel(f"y ({a['unit']})", labelpad=2)
            axes.locator_params("x", nbins=max(2, min(9, round(across / 12))))
            axes.locator_params("y", nbins=max(2, min(7, round(up / 7))))
        else:
            axes.imshow(data, aspect="auto", interpolation="none")
            axes.axis("off")
        top = figure.text(left / width, 1 - 0.7 * ABOVE / height, about["title"], va="baseline")
        time = figure.text(1 - (EDGE + (BAR_BESIDE if beside else 0.0)) / width, 1 - 0.7 * ABOVE / height, about["time"], va="baseline", ha="right")
        shorten(figure, top, time)
        for number, (name, colour) in enumerate(about.get("names", [])):
            figure.text((left + 0.5) / width, (under + up - 3.5 * (number + 1)) / height, name, color=colour, weight="bold", va="baseline")
        bars = about["bars"]
        for number, bar in enumerate(bars):
            colours = ScalarMappable(Normalize(bar["low"], bar["high"]), ListedColormap(bar["colours"]))
            if beside:
                step = up / len(bars)
                where = place(left + across + 3.0, under + (len(bars) - 1 - number + 0.08) * step, 2.5, 0.84 * step)
                figure.colorbar(colours, cax=where, ticks=bar["ticks"]).set_label(bar["title"], labelpad=2)
            else:
                step = (across - (0.3 * across if about["arrow"] else 0.0)) / len(bars)
                where = place(left + (number + 0.05) * step, 8.3, 0.9 * step, 2.0)
                figure.colorbar(colours, cax=where, orientation="horizontal", ticks=bar["ticks"]).set_label(bar["title"], labelpad=1)
        if about["arrow"]:
            arrow(figure, about["arrow"], across, about, (width - EDGE, 8.6 if not beside else 1.5), width, height)
        for target in targets:
            figure.savefig(target, metadata={"Date": None} if target.suffix == ".svg" else {"CreationDate": None} if target.suffix == ".pdf" else None)
        pyplot.close(figure)


def shorten(figure, title, time):
    """Leaves out the end of a title that would run into the time."""
    figure.canvas.draw()
    room = time.get_window_extent().x0 - 4 * DOTS / 72
    words = title.get_text()
    while len(words) > 1 and title.get_window_extent().x1 > room:
        words = words[:-1]
        title.set_text(words.rstrip() + "...")


def arrow(figure, about, across, words, at, width, height):
    """An arrow of a round speed, at its true length in the figure, with its value; its right end stands `at` (mm)."""
    metres = words["axes"]["box"][1] - words["axes"]["box"][0]
    room, length = 0.2 * across, about["metres"] / metres * across
    speed = about["speed"]
    if length > room:
        power = 10.0 ** math.floor(math.log10(speed * room / length))
        shorter = max(m * power for m in (1, 2, 5) if m * power <= speed * room / length * (1 + 1e-9))
        length, speed = length * shorter / speed, shorter
    x, y = at
    figure.text(x / width, (y + 1.2) / height, f"{speed:g} m/s", ha="right", va="bottom")
    figure.add_artist(_arrow(figure, (x - length) / width, x / width, y / height))


def _arrow(figure, begin, end, y):
    from matplotlib.patches import FancyArrowPatch
    return FancyArrowPatch((begin, y), (end, y), transform=figure.transFigure, arrowstyle="-|>", mutation_scale=6, linewidth=0.7, color="0.1", shrinkA=0, shrinkB=0)
