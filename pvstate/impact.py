"""Impact of bodies: their particles coloured by the velocity along the axis of the impact, in 2D or 3D.

Halik et al. 2015, figures 5-9. The axis is the one along which the velocities of the first frame differ most.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
figure = Figure(series, series.title, walls=False)
bodies = series.phases("elastic") or series.phases("grains") or series.phases("fluid")
first = series.first()
begin = first["velocity"][np.isin(first["phase"], bodies)]
axis = int(np.ptp(begin, axis=0).argmax()) if len(begin) else 0
along = series.values("velocity", bodies)[:, axis]
low, high = (np.percentile(along, [0.5, 99.5]) if len(along) else (0.0, 1.0))
if high - low < 1e-12:
    low, high = low - 0.5, high + 0.5
step = nice_ceiling((high - low) / 5)
low, high = step * math.floor(low / step + 1e-6), step * math.ceil(high / step - 1e-6)

shown = [figure.particles(phase, radius=0.5, array="velocity", component="XYZ"[axis]) for phase in bodies]
if shown:
    figure.colours(shown, "velocity", low, high, f"velocity along {'xyz'[axis]} (m/s)",
                   preset="Cool to Warm")
for phase in series.phases("fluid", "grains"):
    if phase not in bodies:
        figure.particles(phase, radius=0.2, colour=FAINT_AIR if series.phase_kinds[phase] == "fluid" else SAND)
figure.finish()
