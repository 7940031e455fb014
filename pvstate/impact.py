"""Impact of bodies in 2D or 3D: their particles coloured by the velocity along the axis of the motion, zero white, or by the
speed where the motion has no such axis.

Halik et al. 2015, figures 5-9. The axis is the direction that holds at least nine tenths of the sum of the squared velocities of the
bodies over the series; it points along the fastest body of the first frame.
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
flat = series.two_dimensional
figure = Figure(series, series.title)
bodies = series.phases("elastic", "rigid") or series.phases("grains") or series.phases("fluid")


def motion_axis(velocity, first):
    """The unit vector of the common direction of the velocities, None without one."""
    if not len(velocity) or not velocity.any():
        return None
    shares, directions = np.linalg.eigh(velocity.T @ velocity)
    if shares[-1] < 0.9 * shares.sum():
        return None
    axis = directions[:, -1]
    fastest = first[np.linalg.norm(first, axis=1).argmax()] if len(first) else axis
    return axis if axis @ fastest >= 0 else -axis


def name_of(axis):
    """An axis in a title: x, y or z if it is one to a hundredth, else its components."""
    nearest = int(np.abs(axis).argmax())
    if abs(axis[nearest]) > 0.99:
        return ("" if axis[nearest] > 0 else "-") + "xyz"[nearest]
    return "(" + ", ".join(f"{c:.2f}" for c in axis[:2 if flat else 3]) + ")"


velocity = series.values("velocity", bodies)
first = series.first()
axis = motion_axis(velocity, first["velocity"][np.isin(first["phase"], bodies)])
if flat:
    figure.rims(bodies)   # without it white bodies would vanish on white
shown = []
top = series.top_speed(bodies) if axis is None else nice_ceiling(percentile(np.abs(velocity @ axis), 99.5))
for phase in bodies:
    if axis is None:
        shown.append(figure.field([phase], "velocity", 0.0, top, layer=1, outline=0.5) if flat else figure.particles(phase, radius=0.5, array="velocity"))
    else:
        along = "+".join(f"({c!r})*velocity_{'XYZ'[k]}" for k, c in enumerate(map(float, axis)))
        source = series.calculated(series.source(phase), "along", along)
        shown.append(figure.field([phase], "along", -top, top, layer=1, sources=[source], outline=0.5) if flat
                     else figure.dots(source, radius=0.5, array="along", component=None))
if shown and axis is None:
    figure.colours(shown, "smooth" if flat else "velocity", 0.0, top, series.speed_title(bodies), preset="Viridis (matplotlib)")
elif shown:
    figure.colours(shown, "smooth" if flat else "along", -top, top, f"velocity along {name_of(axis)} (m/s)", points=SIGNED)
for phase in series.phases("fluid", "grains"):
    if phase not in bodies:
        figure.particles(phase, radius=0.2, colour=FAINT_AIR if series.phase_kinds[phase] == "fluid" else SAND)
figure.walls(layer=2)   # in 3D small dots, through which the bodies are seen
figure.finish()
