"""Viscosity of the eddies of fluids with turbulence = "mixing-length". Needs output.fields with "eddy_viscosity"."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "eddy_viscosity")
series.need("eddy_viscosity")
figure = Figure(series, series.title + ": viscosity of the eddies")
fluids = series.phases("fluid")
values = 1e6 * series.values("eddy_viscosity", fluids)
sources = [series.calculated(series.source(phase), "eddies", "1e6*eddy_viscosity") for phase in fluids]   # mm2/s: short numbers at the colour bar
figure.fluids(fluids, "eddies", values, "viscosity of the eddies, mm²/s", sources)
figure.others(fluids)
figure.finish()
