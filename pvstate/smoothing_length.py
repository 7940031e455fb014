"""Smoothing lengths: every particle coloured by its h, and for one particle of each phase the reach 2h of its kernel.

Halik et al. 2015, figures 2 and 4. In 2D a close-up of the surface of the grains, where the lengths differ. The ring of a phase
stands about its particle that is nearest to a fixed place, in each frame anew.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
flat = series.two_dimensional
window = series.close_up(rows_below=10, rows_high=22, columns=56) if flat else None
figure = Figure(series, series.title + ": smoothing lengths", window=window)
phases = series.phases("fluid", "grains", "elastic", "wall")
lengths = [1e3 * h for h in (series.values("smoothing_length", [phase]) for phase in phases) if len(h)]
if not lengths:
    raise Wrong(f"{series.path} has no point array 'smoothing_length'")
low, high = min(percentile(h, 0.5) for h in lengths), max(percentile(h, 99.5) for h in lengths)
if high - low < 1e-3 * high:
    low, high = 0.0, 2 * high

shown = []
for phase in phases:
    layer = {"fluid": 0, "grains": 2, "elastic": 2, "wall": 1}[series.phase_kinds[phase]]
    radius = 0.42 if flat else 0.3 if series.phase_kinds[phase] == "fluid" else None
    source = series.calculated(series.source(phase), "h", "1000*smoothing_length")   # mm: short numbers at the colour bar
    shown.append(figure.dots(source, radius=radius, array="h", component=None, layer=layer))
figure.colours(shown, "h", low, high, "smoothing length h (mm)", preset="Viridis (matplotlib)")

if flat:
    x0, x1, y0, y1 = figure.box[:4]
    for number, phase in enumerate(phases):
        figure.reach(phase, [x0 + (0.30 + 0.2 * number) * (x1 - x0), (y0 + y1) / 2], layer=8)
figure.finish()
