"""Mean velocity on the first [[grid]] of the scene: speed as colour, and arrows.

From the file grid_NAME.vti beside the series; walls and bodies are those of the last frame.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
figure = Figure(series, series.title + ": mean on a grid")
file = series.file_of("grid", "vti")[0]
grid = XMLImageDataReader(registrationName=os.path.splitext(os.path.basename(file))[0], FileName=[file])
grid.UpdatePipeline()
if "velocity_mean" not in grid.PointData.keys():
    raise Wrong(f"{file} has no array 'velocity_mean'")
box = grid.GetDataInformation().GetBounds()
source = grid if series.two_dimensional else Slice(registrationName="slice", Input=grid)
if not series.two_dimensional:
    source.SliceType.Origin = [(box[2 * k] + box[2 * k + 1]) / 2 for k in range(3)]
    source.SliceType.Normal = [0.0, 0.0, 1.0]
shown = Show(source, figure.view)
shown.SetRepresentationType("Surface" if not series.two_dimensional else "Slice")
ColorBy(shown, ("POINTS", "velocity_mean", "Magnitude"), separate=True)
low, high = grid.PointData["velocity_mean"].GetRange(-1)
figure.colours([shown], "velocity_mean", 0.0, nice_ceiling(high), "mean speed on the grid, m/s", preset="Viridis (matplotlib)")
if series.two_dimensional:   # arrows at some of the points: 32 in a row, 24 rows at most
    renamed = Calculator(registrationName="velocity", Input=grid)
    renamed.ResultArrayName, renamed.Function = "velocity", "velocity_mean"
    extent = list(grid.GetDataInformation().GetExtent())
    columns, rows = max(extent[1] - extent[0], 1), max(extent[3] - extent[2], 1)
    some = ExtractSubset(registrationName="some points", Input=renamed)
    some.VOI = extent
    some.SampleRateI, some.SampleRateJ = max(1, columns // 32), max(1, rows // 24)
    room = min((box[1] - box[0]) / min(columns, 32), (box[3] - box[2]) / min(rows, 24))
    top = nice_ceiling(high)
    figure.arrows(some, 0.95 * room / top, scale_of=top, colour=[1.0, 1.0, 1.0], name="arrow", thickness=1.7, centred=True)
figure.others(series.phases("fluid", "grains"))
figure.finish()
