"""Density of the fluids: how far, in per cent, each particle is from the middle density of its phase, over the frames that give the ranges.

Air and water of one scene differ by a factor of a thousand; the deviation of each from its own density can be shown together.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "density")
figure = Figure(series, series.title + ": density")
fluids = series.phases("fluid")
if not fluids:
    raise Wrong(f"{series.path} has no fluid, whose density could be shown")
sources, drawn, deviations = [], [], []
for phase in fluids:
    density = series.values("density", [phase])
    middle = percentile(density, 50)
    if middle <= 0:
        continue
    deviations.append(100 * (density / middle - 1))
    drawn.append(phase)
    sources.append(series.calculated(series.source(phase), "deviation", f"100*(density/{middle!r}-1)"))
if not drawn:
    raise Wrong(f"{series.path}: the fluids have no density above zero")
figure.fluids(drawn, "deviation", np.concatenate(deviations), "density of " + series.names_of(fluids) + " from its middle, %", sources)
figure.others(fluids)
figure.finish()
