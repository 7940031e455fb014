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
if fluids:
    shown = [figure.field(fluids, "velocity", 0.0, top, outline=0.1 if series.has_grains else 0.25)] if flat else [figure.particles(phase, radius=0.25, array="velocity") for phase in fluids]
    figure.colours(shown, "smooth" if flat else "velocity", 0.0, top, series.speed_title(fluids), preset="Viridis (matplotlib)")
if flat:
    figure.walls(layer=2)
figure.bodies()
for phase in series.phases("grains"):
    figure.particles(phase, colour=SAND, layer=4)

# Vectors where there is fluid, its mean in cells of about a fortieth of the width.
if flat and fluids:
    mean, side = figure.mean_velocity(fluids, fastest=3 * top)
    figure.arrows(mean, 0.95 * side / top, scale_of=top, colour=[1.0, 1.0, 1.0], name="arrow", thickness=1.7, centred=True)
figure.finish()
