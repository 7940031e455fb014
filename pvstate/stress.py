"""Mean stress of bodies, a third of the trace of Cauchy's stress: tension positive (red), compression negative (blue).

It is the pressure of the bodies with the other sign, which every frame has (docs/output.md).
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "pressure")
figure = Figure(series, series.title + ": mean stress")
bodies = series.phases("elastic")
if not bodies:
    raise Wrong(f"{series.path} has no elastic body, whose stress could be shown")
values = -series.values("pressure", bodies)
unit, factor = stress_unit(values)
if series.two_dimensional:   # an outline, without which white discs would vanish on white
    figure.rims(bodies)
sources = [series.calculated(series.source(phase), "mean_stress", f"{-1 / factor!r}*pressure") for phase in bodies]
figure.valued_bodies(bodies, "mean_stress", values / factor, f"mean stress, tension positive, {unit}", sources)
figure.others(bodies)
figure.finish()
