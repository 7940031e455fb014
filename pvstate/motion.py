"""Speed of everything that moves: fluids, grains and bodies on one range of colours. Walls are grey."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
figure = Figure(series, series.title + ": speed")
moving = series.phases("fluid", "grains", "elastic", "rigid")
if not moving:
    raise Wrong(f"{series.path} has nothing that moves")
radii = {"fluid": "whole", "grains": None, "elastic": "body", "rigid": "body"}
shown = [figure.particles(phase, radius=radii[series.phase_kinds[phase]] if series.two_dimensional else 0.5, array="velocity",
                          layer=0 if series.phase_kinds[phase] == "fluid" else 1) for phase in moving]
figure.colours(shown, "velocity", 0.0, series.top_speed(moving), series.speed_title(moving), preset="Viridis (matplotlib)")
figure.others(moving)
figure.finish()
