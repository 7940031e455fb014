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
# lifts a grain by its own size, so that a bed at rest looks at rest. A grain moves if it has a tenth of what lifts it by a spacing.
spacing_lift = math.sqrt(2 * 9.81 * series.spacing)
lift = math.sqrt(2 * 9.81 * min((series.size(phase) for phase in grains), default=series.spacing))
# Not counted: grains three times as fast as the fluids, which drive them, or twenty times as fast as half of the others.
speeds = series.speeds(grains)
moving = speeds[speeds > 0.1 * spacing_lift]
if series.phases("fluid") and len(moving):
    moving = moving[moving <= max(spacing_lift, 3 * series.top_speed(series.phases("fluid")))]
if len(moving):
    moving = moving[moving <= 20 * max(spacing_lift, np.median(moving))]
top = nice_ceiling(max(lift, percentile(moving, 98)))

# Arrows of hundreds of grains much finer than the air hide the grains: then the colour alone tells the speed.
few = series.moving_at_once(grains, 0.2 * top) <= 100 or all(series.size(phase) > 0.75 * series.spacing for phase in grains)

arrow = min(6 * series.spacing, 0.07 * (figure.box[1] - figure.box[0]))   # m, the longest

if flat:
    figure.faint(series.phases("fluid"))
    figure.walls(layer=1)
figure.bodies(layer=2)

shown = []
for phase in grains:
    if few:
        figure.arrows(series.source(phase), arrow / top, scale_of=None if shown else top, name="arrow", thickness=0.8,
                      longest=top)
    shown.append(figure.particles(phase, array="velocity", layer=3))
if shown:
    figure.colours(shown, "velocity", 0.0, top, series.speed_title(grains), points=SAND_SPEED)
figure.finish()
