"""Shear stress of the fluid along each [[wall-shear]] of the scene.

From the files wall_shear_NAME.vtp beside the series."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = Series(find_series(__file__))
chart = Chart(series.title + ": shear stress at the wall", "x, m", "mean shear stress, Pa")
stresses = []
for file in series.file_of("wall_shear", "vtp"):
    name = os.path.splitext(os.path.basename(file))[0].removeprefix("wall_shear_")
    wall = Chart.read(file)
    stresses.append(Chart.values(wall, "shear_stress_mean"))
    chart.line(wall, "Points_X", {"shear_stress_mean_X": name.replace("_", " ")})
stresses = np.concatenate(stresses)
if len(stresses):   # zero belongs to the picture: a stress that is the same everywhere is a level line
    low, high = min(float(stresses.min()), 0.0), max(float(stresses.max()), 0.0)
    chart.span("Left", 1.25 * low, 1.25 * high)
chart.finish()
