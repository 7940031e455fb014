"""Ways of the particles that travel farthest, coloured by their speed.

All else is shown as in the last frame, faint.

Grains are taken where there are some, else bodies, else fluids. Positions are those of the frames, joined by straight lines; a jump of more than half of the
domain is a periodic side, and parts the line. BARCHAN_TRAJECTORIES=24 chooses how many.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
try:
    number = int(os.environ.get("BARCHAN_TRAJECTORIES", "24"))
except ValueError:
    number = 0
if number < 1:
    raise Wrong(f"BARCHAN_TRAJECTORIES={os.environ['BARCHAN_TRAJECTORIES']}: expected a number from 1")
moving = series.phases("grains") or series.phases("elastic", "rigid") or series.phases("fluid")
if len(series.times) < 2 or not moving:
    raise Wrong(f"{series.path}: trajectories need two frames and something that moves")
ways, speeds = series.ways(moving, number)
box = series.bounds(series.phases("fluid", "grains", "elastic", "rigid", "wall"))
places = np.concatenate(ways)
room = 1.5 * series.spacing + 0.015 * float(np.ptp(places, axis=0).max())
for axis in range(2 if series.two_dimensional else 3):   # the view holds the ways too
    box[2 * axis] = min(box[2 * axis], float(places[:, axis].min()) - room)
    box[2 * axis + 1] = max(box[2 * axis + 1], float(places[:, axis].max()) + room)
if series.two_dimensional:   # ways along one line have room beside them
    lack = 0.4 * (box[3] - box[2]) - (box[1] - box[0])
    box[0], box[1] = box[0] - max(lack, 0) / 2, box[1] + max(lack, 0) / 2
figure = Figure(series, series.title + ": trajectories", box=box)
figure.others([])
lines = figure.paths(ways, speeds)
figure.colours([lines], "speed", 0.0, nice_ceiling(percentile(np.concatenate(speeds), 99.5)), series.speed_title(moving), preset="Viridis (matplotlib)")
figure.finish()
