"""Beds and bodies from arrays, as files that a scene takes: grains (`shape = { file = ... }`), outlines and surfaces (`shape = { surface = ... }`).

Each function writes a file and returns its whole path as a text, so that it can stand in the dictionary of a scene at once.
"""

import pathlib

import numpy

from .errors import SceneError


def _points(values, components, what):
    """An array (n, components) of finite numbers. Throws SceneError."""
    try:
        points = numpy.asarray(values, float)
    except (TypeError, ValueError) as error:
        raise SceneError(f"{what}: {error}") from error
    if points.ndim != 2 or points.shape[1] not in components or not len(points):
        raise SceneError(f"{what}: expected an array (n, {' or '.join(map(str, components))}), found {points.shape}")
    if not numpy.isfinite(points).all():
        raise SceneError(f"{what}: row {int(numpy.argmin(numpy.isfinite(points).all(axis=1)))} is not finite")
    return points


def _path(file, endings):
    path = pathlib.Path(file).absolute()
    if path.suffix not in endings:
        raise SceneError(f"{file}: expected a file that ends in {' or '.join(endings)}")
    return path


def write_grains(file, positions, radii, phase="sand"):
    """Grains at `positions` (n, 2 or 3) in m with `radii` (n,) or one number in m, of the phase of this name, as a .vtp. In 2D z is 0."""
    path = _path(file, (".vtp",))
    x = _points(positions, (2, 3), "positions of grains")
    try:
        r = numpy.broadcast_to(numpy.asarray(radii, float), len(x))
    except ValueError as error:
        raise SceneError(f"radii of grains: expected one or {len(x)}, found an array {numpy.shape(radii)}") from error
    if not (numpy.isfinite(r).all() and (r > 0).all()):
        raise SceneError("radii of grains: each is a number above 0")
    from .frame import write_particles
    write_particles(path, numpy.column_stack([x, numpy.zeros((len(x), 3 - x.shape[1]))]), phase, radius=r)
    return str(path)


def write_outline(file, corners):
    """A closed outline with `corners` (n, 2) in m, in their order, as a .csv; the last corner is joined to the first."""
    path = _path(file, (".csv",))
    x = _points(corners, (2,), "corners of an outline")
    if len(x) < 3:
        raise SceneError(f"corners of an outline: expected at least 3, found {len(x)}")
    path.write_text("x,y\n" + "".join(f"{a!r},{b!r}\n" for a, b in x.tolist()))
    return str(path)


def write_surface(file, points, triangles):
    """A closed surface of `triangles` (m, 3), each three indices of `points` (n, 3) in m, anticlockwise seen from outside, as an .obj."""
    path = _path(file, (".obj",))
    x = _points(points, (3,), "points of a surface")
    t = numpy.asarray(triangles)
    if t.ndim != 2 or t.shape[1] != 3 or not numpy.issubdtype(t.dtype, numpy.integer):
        raise SceneError(f"triangles of a surface: expected an array (m, 3) of integers, found {t.shape} of {t.dtype}")
    if t.size and not (t.min() >= 0 and t.max() < len(x)):
        raise SceneError(f"triangles of a surface: indices go from 0 to {len(x) - 1}, found {t.min()} to {t.max()}")
    path.write_text("".join(f"v {a!r} {b!r} {c!r}\n" for a, b, c in x.tolist()) + "".join(f"f {a} {b} {c}\n" for a, b, c in (t + 1).tolist()))
    return str(path)
