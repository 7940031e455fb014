"""Barchan in Python: read what a run wrote, start runs, make scenes, beds and bodies.

    import barchan
    velocity = barchan.open("out/dune")[-1]["velocity"]     # (particles, 3), m/s, of the last frame

Plain Python over NumPy and VTK's Python modules, for Debian's /usr/bin/python3. There are no bindings to the C++ code (pybind11, for example): the package reads the files that the program
writes, and starts the program. So it needs no compiler, it fits every build of the program, and a run that crashes or takes all memory does not end the interpreter.
docs/python.md describes it.
"""

from . import scene, shapes  # noqa: F401
from .errors import (BarchanError, Breakdown, Mistake, NoSeries, OutputError, PackageMissing, ProgramNotFound, SceneError, Stopped, UnknownName,  # noqa: F401
                     Unreadable)
from .program import Difference, RunWarning, compare, find_program, generate, plan, run, schema, version  # noqa: F401
from .series import Series, open  # noqa: F401
from .shapes import write_grains, write_outline, write_surface  # noqa: F401
from .tables import Table, table  # noqa: F401


def __getattr__(name):
    """Frame and Grid come with VTK, which is loaded when they are first asked for: scenes, runs, tables and sweeps do without it."""
    if name in ("Frame", "Grid"):
        from . import frame
        return getattr(frame, name)
    raise AttributeError(f"module barchan has no attribute {name}")
