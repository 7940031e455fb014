"""Wind over sand, or any other fluid: it is coloured by its speed with vectors on a regular grid, grains in the colour of sand.

Halik et al. 2015, figures 12-14. Open it in ParaView (File > Load State) or render it with pvstate/render.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
figure = Figure(series, series.title)
fluids = series.phases("fluid")
top = series.top_speed(fluids)

flat = series.two_dimensional
shown = [figure.particles(phase, radius="whole" if flat else 0.25, array="velocity") for phase in fluids]
if shown:
    figure.colours(shown, "velocity", 0.0, top, series.speed_title(fluids), preset="Viridis (matplotlib)")
for phase in series.phases("grains"):
    figure.particles(phase, colour=SAND, layer=2)
for phase in series.phases("elastic", "rigid"):
    figure.particles(phase, radius="body", colour=BODY, layer=2)
if flat:
    for phase in series.phases("wall"):
        figure.particles(phase, radius="body", colour=WALL, layer=3)

# Vectors where there is fluid, its mean in cells of about a fortieth of the width.
if flat:
    for number, phase in enumerate(fluids):
        mean, side = figure.mean_velocity(phase, fastest=3 * top)
        figure.arrows(mean, 0.95 * side / top, scale_of=None if number else top, colour=[1.0, 1.0, 1.0], name="arrow",
                      thickness=1.7, centred=True)
figure.finish()
