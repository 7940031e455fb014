"""All grains, from the colour of sand at rest to dark when fast; all else faint.

Fluids are faint, bodies grey, walls dark."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__, "radius")
figure = Figure(series, series.title)
grains = series.phases("grains")
if not grains:
    raise Wrong(f"{series.path} has no grains")
speeds = series.speeds(grains)
fast = speeds[speeds > 0.05 * percentile(speeds, 99.9)] if len(speeds) else speeds   # a bed at rest does not decide
top = nice_ceiling(percentile(fast, 98)) if len(fast) and fast.max() > 0 else 1.0
figure.others(grains)
shown = [figure.particles(phase, array="velocity", layer=4) for phase in grains]
figure.colours(shown, "velocity", 0.0, top, series.speed_title(grains), points=SAND_SPEED)
figure.finish()
