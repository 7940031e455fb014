"""Barchan in Python: read what a run wrote, start runs, make scenes, beds and bodies.

    import barchan
    velocity = barchan.open("out/dune")[-1]["velocity"]     # (particles, 3), m/s, of the last frame

Plain Python over NumPy, for Debian's /usr/bin/python3. There are no bindings to the C++ code (pybind11, for example): the package reads the files that the program
writes, starts the program, and steps it through a pipe (Simulation). So it needs no compiler, it fits every build of the program, and a run that crashes or takes all memory does not end the interpreter.
docs/python.md describes it.

Each name is loaded from its file when it is first used: scenes do without NumPy.
"""

import importlib
import typing

if typing.TYPE_CHECKING:  # for editors; __getattr__ does it
    from . import scene, shapes  # noqa: F401
    from .errors import (BarchanError, Breakdown, Mistake, NoSeries, OutputError, PackageMissing, ProgramNotFound, SceneError, Stopped, UnknownName,  # noqa: F401
                         Unreadable, UsageError)
    from .frame import Frame, Grid  # noqa: F401
    from .program import Difference, RunWarning, compare, find_program, generate, plan, run, schema, version  # noqa: F401
    from .series import Series, open  # noqa: F401
    from .shapes import write_grains, write_outline, write_surface  # noqa: F401
    from .simulation import Simulation  # noqa: F401
    from .tables import Table, table  # noqa: F401

_NAMES = {
    "errors": "BarchanError Breakdown Mistake NoSeries OutputError PackageMissing ProgramNotFound SceneError Stopped UnknownName Unreadable UsageError",
    "frame": "Frame Grid",
    "program": "Difference RunWarning compare find_program generate plan run schema version",
    "series": "Series open",
    "simulation": "Simulation",
    "shapes": "write_grains write_outline write_surface",
    "tables": "Table table",
}
_HOMES = {name: home for home, names in _NAMES.items() for name in names.split()}
__all__ = [*_HOMES, "scene", "shapes"]


def __getattr__(name):
    if name in ("scene", "shapes"):
        return importlib.import_module(f".{name}", __name__)
    if name not in _HOMES:
        from .errors import nearest
        raise AttributeError(f"barchan has no {name}{nearest(name, __all__)}")
    value = getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__():
    return sorted([*globals(), *__all__])
