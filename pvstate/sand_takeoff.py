"""Grains taking off: each grain with its velocity, from sand-coloured at rest to dark when fast, the air faint behind.

Halik et al. 2015, figure 10. In 2D a close-up of the bed where it is highest; BARCHAN_WINDOW chooses another place.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
figure = Figure(series, series.title + ": grains taking off", window=series.close_up() if series.two_dimensional else None)
flat = series.two_dimensional
grains = series.phases("grains")
# The top of the scale, also the speed of the longest arrows: what nearly all moving grains stay below, but no less than what
# lifts a grain by its own size, so that a bed at rest looks at rest.
lift = math.sqrt(2 * 9.81 * series.spacing)
moving = series.values("velocity", grains)
speeds = np.linalg.norm(moving, axis=1) if len(moving) else np.zeros(1)
speeds = speeds[np.isfinite(speeds) & (speeds > 0.1 * lift)]
top = nice_ceiling(max(lift, np.percentile(speeds, 98) if len(speeds) else 0.0))

if flat:
    for phase in series.phases("fluid"):
        figure.particles(phase, radius=0.22, colour=FAINT_AIR)
    for phase in series.phases("wall"):
        figure.particles(phase, colour=WALL, layer=1)
for phase in series.phases("elastic"):
    figure.particles(phase, colour=[0.55, 0.57, 0.60], layer=2)

shown = []
for phase in grains:
    shown.append(figure.particles(phase, array="velocity", layer=3))
    arrows = figure.arrows(series.source(phase), 6 * series.spacing / top, colour=INK, name="velocity", thickness=0.8)
if shown:
    figure.colours(shown, "velocity", 0.0, top, "grain speed (m/s)", points=SAND_SPEED)
figure.finish()
