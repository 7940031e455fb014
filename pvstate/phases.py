"""Each phase that moves in its own colour: two sizes of grains, two fluids. Grains have their own size where `output.fields` names `radius`."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

# Okabe & Ito, Color Universal Design (2008): told apart by the colour-blind.
COLOURS = [[0.902, 0.624, 0.0], [0.0, 0.447, 0.698], [0.835, 0.369, 0.0], [0.0, 0.620, 0.451], [0.800, 0.475, 0.655], [0.337, 0.706, 0.914]]

series = start(__file__, "radius")
figure = Figure(series, series.title)
moving = series.phases("fluid", "grains", "elastic", "rigid")
if not moving:
    raise Wrong(f"{series.path} has nothing that moves")
figure.walls()
for number, phase in enumerate(moving):
    colour = COLOURS[number % len(COLOURS)]
    if series.two_dimensional and series.phase_kinds[phase] != "grains":
        figure.field([phase], colour=colour, layer=1, outline=0.25 if series.phase_kinds[phase] == "fluid" else 0.5)
    else:
        figure.particles(phase, colour=colour, layer=4)
figure.legend([(series.phase_names[phase], COLOURS[number % len(COLOURS)]) for number, phase in enumerate(moving)])
figure.finish()
