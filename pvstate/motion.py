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
flat, top = series.two_dimensional, series.top_speed(moving)
fluids = series.phases("fluid") if flat else []
bodies = series.phases("elastic", "rigid") if flat else []
areas = [figure.field(fluids, "velocity", 0.0, top)] if fluids else []
areas += [figure.field([phase], "velocity", 0.0, top, layer=1, outline=0.5) for phase in bodies]
balls = [figure.particles(phase, radius=None if flat else 0.5, array="velocity", layer=4) for phase in moving if phase not in fluids + bodies]
figure.colours(areas, "smooth", 0.0, top, series.speed_title(moving), preset="Viridis (matplotlib)", bar=not balls)
figure.colours(balls, "velocity", 0.0, top, series.speed_title(moving), preset="Viridis (matplotlib)")
figure.others(moving)
figure.finish()
