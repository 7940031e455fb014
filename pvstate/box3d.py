"""A scene in three dimensions with the box of its domain, axes and a cut: particles in front of the plane through the middle are left out.

Colours tell the speed of what moves; walls are left out, the box stands for them. BARCHAN_CUT chooses the plane: x, y, z, or none; with a number the place in
metres, "z=0.01".
"""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from barchan_view import *  # noqa: E402,F403

series = start(__file__)
if series.two_dimensional:
    raise Wrong(f"{series.path} is a 2D scene; the state box3d shows 3D scenes")
moving = series.phases("fluid", "grains", "elastic", "rigid")
held = series.bounds(moving or [0])
box = [float(x) for x in series.domain] if series.domain is not None else held
figure = Figure(series, series.title, box=box)
axis, _, place = os.environ.get("BARCHAN_CUT", "y" if series.up == "z" else "z").partition("=")
if axis not in ("x", "y", "z", "none"):
    raise Wrong(f"BARCHAN_CUT={axis}: expected x, y, z or none, or a place such as z=0.01")
k = "xyz".find(axis)
try:
    where = float(place) if place else (held[2 * k] + held[2 * k + 1]) / 2 if k >= 0 else 0.0
except ValueError:
    raise Wrong(f"BARCHAN_CUT: '{place}' is no place in metres") from None


def behind(source, name):
    """What lies behind the plane, seen from the eye (at positive x, y and z; where gravity is along z at negative y): whole particles by their centres."""
    if k < 0:
        return source
    cut = Calculator(registrationName=name + ": place", Input=source)
    cut.ResultArrayName, cut.Function = "place", f"coords{'XYZ'[k]}"
    part = Threshold(registrationName=name + " behind the cut", Input=cut)
    part.Scalars = ["POINTS", "place"]
    part.LowerThreshold, part.UpperThreshold = (where, 1e30) if axis == "y" and series.up == "z" else (-1e30, where)
    return part


shown = [figure.dots(behind(series.source(phase), series.phase_names[phase]), radius=0.5, array="velocity", size=series.size(phase) if series.phase_kinds[phase] == "grains" else None) for phase in moving]
if shown:
    figure.colours(shown, "velocity", 0.0, series.top_speed(moving), series.speed_title(moving), preset="Viridis (matplotlib)")

figure.finish()
