"""Grains by their diameter, from light (small) to dark (large); all else faint.

Needs output.fields with "radius".
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "radius")
series.need("radius")
figure = Figure(series, series.title + ": diameters")
grains = series.phases("grains")
if not grains:
    raise Wrong(f"{series.path} has no grains")
diameters = 2e3 * series.values("radius", grains)
low, high = diameters.min(), diameters.max()
figure.others(grains)
sources = [series.calculated(series.source(phase), "diameter", "2000*radius") for phase in grains]
shown = [figure.dots(source, array="diameter", layer=4, size=series.size(phase)) for phase, source in zip(grains, sources)]
figure.colours(shown, "diameter", low if low < high else 0.9 * low, high if low < high else 1.1 * high, f"diameter of {series.names_of(grains)} (grains), mm", points=SAND_SPEED)
figure.finish()
