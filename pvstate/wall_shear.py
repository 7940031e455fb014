"""Shear stress of the fluid along each [[wall-shear]] of the scene, from the files wall_shear_NAME.vtp beside the series."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = Series(find_series(__file__))
chart = Chart(series.title + ": shear stress at the wall", "x, m", "mean shear stress, Pa")
for file in series.file_of("wall_shear", "vtp"):
    name = os.path.splitext(os.path.basename(file))[0].removeprefix("wall_shear_")
    chart.line(Chart.read(file), "Points_X", {"shear_stress_mean": name.replace("_", " ")})
chart.finish()
