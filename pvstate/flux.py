"""Flux of grains by height over the bed of each [[saltation]] of the scene.

From the files saltation_NAME.vtp beside the series.

The axis of the flux is logarithmic: a flux that falls exponentially with the height is a straight line.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = Series(find_series(__file__))
chart = Chart(series.title + ": flux by height", "flux, kg/m²/s", "height over the bed, m")
largest, reach = 0.0, 0.0
for file in series.file_of("saltation", "vtp"):
    name = os.path.splitext(os.path.basename(file))[0].removeprefix("saltation_")
    measured = Chart.read(file)
    flux = Chart.values(measured, "flux")
    if not (flux > 0).any():
        continue
    largest = max(largest, float(flux.max()))
    reach = max(reach, float(Chart.values(measured, "height_over_bed")[flux > 1e-6 * flux.max()].max()))
    above_zero = Calculator(registrationName=name + ", above zero", Input=measured)   # zero has no logarithm
    above_zero.ResultArrayName, above_zero.Function = "flux above zero", f"max(flux,{1e-9 * largest!r})"
    chart.line(above_zero, "flux above zero", {"height_over_bed": name.replace("_", " ")})
if not largest:
    raise Wrong(f"{series.path}: the instruments of the scene have measured no flux yet")
chart.view.BottomAxisLogScale = 1
chart.span("Bottom", 1e-5 * largest, 2 * largest)
chart.span("Left", 0.0, nice_ceiling(reach))
chart.finish()
