"""Mean velocity along the line or the height of each [[profile]] of the scene.

From the files profile_NAME.vtp beside the series.

A profile that runs up has its places on the vertical axis, as a wind profile is drawn; any other has them on the horizontal one.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = Series(find_series(__file__))
readers = [(os.path.splitext(os.path.basename(file))[0].removeprefix("profile_"), Chart.read(file)) for file in series.file_of("profile", "vtp")]


def extent(reader):
    """How far a profile reaches along x, y and z (m)."""
    reader.UpdatePipeline()
    box = reader.GetDataInformation().GetBounds()
    return [box[2 * k + 1] - box[2 * k] for k in range(3)]


extents = [extent(reader) for _, reader in readers]
up = all(sizes[1] >= max(sizes) - 1e-12 for sizes in extents)
chart = Chart(series.title + ": mean velocity", *(("along x, m/s", "height y, m") if up else ("place, m", "mean velocity, m/s")))
for (name, reader), sizes in zip(readers, extents):
    if up:
        chart.line(reader, "velocity_mean_X", {"Points_Y": name.replace("_", " ")})
    else:
        axis = "XYZ"[sizes.index(max(sizes))]
        chart.line(reader, f"Points_{axis}", {f"velocity_mean_{k}": f"{name.replace('_', ' ')}: along {k.lower()}" for k in "XY"})
chart.finish()
