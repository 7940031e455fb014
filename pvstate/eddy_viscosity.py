"""Viscosity of the eddies of fluids with turbulence = "mixing-length". Needs output.fields with "eddy_viscosity"."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "eddy_viscosity")
series.need("eddy_viscosity")
figure = Figure(series, series.title + ": viscosity of the eddies")
fluids = series.phases("fluid")
values = series.values("eddy_viscosity", fluids)
factor, unit = (1e6, "mm²/s") if percentile(values, 99.5) <= 1e-3 else (1.0, "m²/s")   # short numbers at the colour bar
sources = [series.calculated(series.source(phase), "eddies", f"{factor!r}*eddy_viscosity") for phase in fluids]
figure.fluids(fluids, "eddies", factor * values, f"viscosity of the eddies, {unit}", sources)
figure.others(fluids)
figure.finish()
