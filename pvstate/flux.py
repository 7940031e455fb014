"""Flux of grains by height over the bed of each [[saltation]] of the scene, from the files saltation_NAME.vtp beside the series.

The axis of the flux is logarithmic: a flux that falls exponentially with the height is a straight line.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = Series(find_series(__file__))
chart = Chart(series.title + ": flux by height", "flux, kg/m²/s", "height over the bed, m")
for file in series.file_of("saltation", "vtp"):
    above = Threshold(registrationName="slices with a flux", Input=Chart.read(file))
    above.Scalars = ["POINTS", "flux"]
    above.LowerThreshold, above.UpperThreshold = 1e-12, 1e30   # zero has no logarithm
    name = os.path.splitext(os.path.basename(file))[0].removeprefix("saltation_")
    chart.line(above, "flux", {"height_over_bed": name.replace("_", " ")})
chart.view.BottomAxisLogScale = 1
chart.finish()
