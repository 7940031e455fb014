"""Wind over sand: the air coloured by its speed with vectors on a regular grid, the grains in the colour of sand.

Halik et al. 2015, figures 12-14. Open it in ParaView (File > Load State) or render it with pvstate/render.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
figure = Figure(series, series.title)
air = series.phases("fluid")
top = series.top_speed(air)

# The air overlaps a little, so that it is seen as the continuum that it stands for.
flat = series.two_dimensional
shown = [figure.particles(phase, radius=1.0 if flat else 0.25, array="velocity") for phase in air]
if shown:
    figure.colours(shown, "velocity", 0.0, top, "air speed (m/s)", preset="Viridis (matplotlib)")
for phase in series.phases("grains"):
    figure.particles(phase, colour=SAND, layer=2)
for phase in series.phases("elastic"):
    figure.particles(phase, colour=[0.55, 0.57, 0.60], layer=2)
if flat:
    for phase in series.phases("wall"):
        figure.particles(phase, colour=WALL, layer=3)

# Vectors where there is air, its mean in cells of a fortieth of the width.
if flat:
    for phase in air:
        wind, side = figure.mean_velocity(phase)
        figure.arrows(wind, 0.95 * side / top, colour=[1.0, 1.0, 1.0], name="wind", thickness=1.3, centred=True)
figure.finish()
