"""Smoothing lengths: every particle coloured by its h, and for one particle of each phase the reach 2h of its kernel.

Halik et al. 2015, figures 2 and 4. In 2D a close-up of the surface of the grains, where the lengths differ.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

MARK = [0.85, 0.10, 0.15]

series = start(__file__)
flat = series.two_dimensional
window = series.close_up(rows_below=10, rows_high=22, columns=56) if flat else None
figure = Figure(series, series.title + ": smoothing lengths", window=window)
phases = series.phases("fluid", "grains", "elastic", "wall")
lengths = series.values("smoothing_length", phases)
if not len(lengths):
    raise RuntimeError(f"{series.path} has no point array 'smoothing_length'")
low, high = 1e3 * lengths.min(), 1e3 * lengths.max()
if high - low < 1e-3 * high:
    low, high = 0.0, 2 * high


def in_millimetres(source, name):
    """h in mm, so that the colour bar has short numbers."""
    calculator = Calculator(registrationName=name, Input=source)
    calculator.ResultArrayName = "h"
    calculator.Function = "1000*smoothing_length"
    return calculator


shown = []
for phase in phases:
    layer = {"fluid": 0, "grains": 2, "elastic": 2, "wall": 1}[series.phase_kinds[phase]]
    radius = 0.42 if flat else 0.3 if series.phase_kinds[phase] == "fluid" else None
    source = in_millimetres(series.source(phase), series.phase_names[phase] + " h")
    shown.append(figure.dots(source, radius=radius, array="h", component=None, layer=layer))
figure.colours(shown, "h", low, high, "smoothing length h (mm)", preset="Viridis (matplotlib)")

# The reach of one kernel a phase: a ring of radius 2h about the particle nearest to a place in the picture.
first = series.first()
if flat and "id" in first:
    x0, x1, y0, y1 = figure.box[:4]
    for number, phase in enumerate(phases):
        mine = np.flatnonzero(first["phase"] == phase)
        mine = mine[(np.abs(first["points"][mine, 0] - (x0 + x1) / 2) < 0.42 * (x1 - x0))
                    & (np.abs(first["points"][mine, 1] - (y0 + y1) / 2) < 0.40 * (y1 - y0))]
        if not len(mine):
            continue
        place = np.array([x0 + (0.30 + 0.2 * number) * (x1 - x0), (y0 + y1) / 2])
        one = mine[((first["points"][mine, :2] - place) ** 2).sum(axis=1).argmin()]
        chosen = Threshold(registrationName="one of " + series.phase_names[phase], Input=series.reader)
        chosen.Scalars = ["POINTS", "id"]
        chosen.LowerThreshold = chosen.UpperThreshold = float(first["id"][one])
        figure.reach(chosen, colour=MARK)
        figure.dots(chosen, radius=0.18, colour=MARK, layer=8)
figure.finish()
