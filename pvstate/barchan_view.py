"""What the ParaView states of Barchan share: finding the series, its phases and ranges, and drawing them as a figure.

A state opens in ParaView (File > Load State) and runs in pvpython alike. It takes what it needs from the environment:

    BARCHAN_SERIES   a series (.pvd) or one frame (.vtp, .vtu)    (else --series FILE, else the newest out/*/*.pvd near the state or
                     the working folder)
    BARCHAN_SIZE     picture, "1600x900" or "1600x" for the height that fits the data    (ParaView's window decides otherwise)
    BARCHAN_WINDOW   part of a 2D scene to show, "x0,x1,y0,y1" in metres
    BARCHAN_HIDE     phases not to draw, "air,wall"

Of a frame it reads the point arrays phase, velocity and smoothing_length and the field data phase_names and, where there is
one, phase_kinds (fluid, grains, elastic, rigid, wall for each phase) and domain (bounds, m).

barchan_series.py holds the series and its ranges, barchan_figure.py the layout, barchan_marks.py what is drawn, barchan_chart.py lines
over axes.
"""

import math  # noqa: F401  (the states use these names)
import os  # noqa: F401
import sys  # noqa: F401

import numpy as np  # noqa: F401
from paraview.simple import *  # noqa: F401,F403

from barchan_chart import Chart  # noqa: F401
from barchan_figure import Figure  # noqa: F401
from barchan_marks import BODY, FAINT_AIR, INK, MARK, SAND, SAND_SPEED, SIGNED, WALL  # noqa: F401
from barchan_numbers import nice_ceiling, percentile, stress_unit  # noqa: F401
from barchan_series import Series, Wrong, find_series  # noqa: F401


def start(state_file, *arrays):
    """The series that the state shows; `arrays`: point arrays whose values the state reads beside those that every frame has."""
    return Series(find_series(state_file), arrays)
