"""Pressure of the fluids: blue and red about a white zero where it has both signs, else from zero or from its lowest value on.

Bodies, grains and walls have the colours that they have in every state.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "pressure")
figure = Figure(series, series.title + ": pressure")
fluids = series.phases("fluid")
if not fluids:
    raise Wrong(f"{series.path} has no fluid, whose pressure could be shown")
figure.fluids(fluids, "pressure", series.values("pressure", fluids), "pressure of " + series.names_of(fluids) + ", Pa")
figure.others(fluids)
figure.finish()
