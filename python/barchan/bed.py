"""The surface of a bed of grains along x, and how much lies there."""

import pathlib
import typing

import numpy

from . import files, run_scene
from .errors import BarchanError, SceneError, Unreadable, UsageError
from .tables import table

CLOSEST = {2: 0.70, 3: 0.85}   # share of a slice that equal spheres can fill, with the rows of a regular packing in the worst places: 0.664 and 0.827
LOOSEST = 0.30                 # share of a slice that grains fill in a bed of one phase alone
THICK = 3                      # slices: a stream of falling grains is not as dense over so many


class Bed(typing.NamedTuple):
    """`x`: middles of the columns (m); `height`: of the surface (m), nan where no grains lie; `solid`: volume of the grains by area of ground (m), those in flight too; `width`: of a
    column (m); `volume`: of all grains (m3; in 2D by metre of depth, of the slab in which the program has the grains)."""
    x: numpy.ndarray
    height: numpy.ndarray
    solid: numpy.ndarray
    width: float
    volume: float


class About(typing.NamedTuple):
    """What the folder of a run says of its grains. `gravity`: (3,) in m/s2, None where nothing says it; `sized`: by phase whether its diameters differ; `diameters`: by phase the mean
    diameter of the scene (m); `slab`: thickness of the slab of the grains in 2D (m), None where nothing says it; `spacing`: of the scene (m), 0 where nothing says it."""
    folder: pathlib.Path
    gravity: typing.Optional[numpy.ndarray]
    sized: dict
    diameters: dict
    slab: typing.Optional[float]
    spacing: float


def about(folder):
    """What run.json in this folder, and the scene that it names, say (About); all is empty without a run.json that can be read."""
    folder = pathlib.Path(folder)
    try:
        run = files.document(files.below(folder, folder / "run.json"))
    except Unreadable:
        run = {}
    run = run if isinstance(run, dict) else {}
    said = run.get("scene") if isinstance(run.get("scene"), dict) else {}
    gravity = said.get("gravity")
    gravity = numpy.array(gravity, float) if isinstance(gravity, list) and len(gravity) == 3 and all(map(_is_finite, gravity)) else None
    fields = run.get("fields") if isinstance(run.get("fields"), dict) else {}
    phases = (run_scene.unchanged(folder, run) or {}).get("phases", {})
    diameters = {name: mean for name, phase in phases.items() if isinstance(phase, dict) and (mean := _mean(phase.get("diameter"))) is not None} if isinstance(phases, dict) else {}
    slab = said.get("slab")
    if not (_is_finite(slab) and slab > 0):
        slab = max(diameters.values(), default=None)   # the largest mean diameter, as src/models/catalogue.cpp has it
    spacing = said.get("spacing")
    return About(folder, gravity, {name: "radius" in of for name, of in fields.items() if isinstance(of, list)}, diameters, slab, spacing if _is_finite(spacing) else 0.0)


def _is_finite(value):
    return isinstance(value, (int, float)) and abs(value) < 1e300


def _mean(diameter):
    """The mean diameter (m) that `diameter` of a phase of a scene gives; of a sieve curve without a mean that which half of the mass passes. None for what is no number."""
    mean = diameter.get("mean") if isinstance(diameter, dict) else diameter
    if _is_finite(mean) and mean > 0:
        return float(mean)
    try:
        corners = diameter["sieve"]
        return next(a + (0.5 - p) / (q - p) * (b - a) for (a, p), (b, q) in zip(corners, corners[1:]) if q >= 0.5 and q > p)
    except (LookupError, TypeError, ValueError, StopIteration):
        return None


def bed(frame, phase, width=None, up=None, known=None):
    """The bed of the spheres of a phase (Bed). `width`: of a column along x, m (default 4 mean diameters); `up`: the axis of the heights, "y" or "z" (default: against the gravity of
    run.json next to the frame; without one y in 2D); `known`: what `about` said of the folder of the frame.

    In slices one diameter high, over which each grain is spread by its own height, the bed of a column goes from its lowest full slice upwards until two slices follow each other that
    are less than a third as full as the bed; the surface is where the last half full slice is passed. What is higher is in flight. Where less than two slices are full, the height is the mean top of
    the grains that lie there: those at most one and a half diameters above the ground that move up or down slower than after a fall of a quarter of a diameter.
    A thick bed without ground below, over the outlet of a hopper, counts where the beds next to it reach its height.

    Throws SceneError where diameters differ and the frame has no field `radius`, UsageError where nothing says what is up, UnknownName for a phase that is not there."""
    known = about(frame.path.parent if frame.path else ".") if known is None else known
    grains = frame.of(phase)
    flat = not numpy.ptp(frame.domain[2]) if frame.domain is not None else not frame.x[:, 2].any()
    axis = _upward(frame, known, up, flat)
    across = 3 - axis
    radius, sure = _radius(grains, phase, known)
    diameter = 2 * float(radius.mean()) if len(radius) else 0.0
    if not diameter > 0:
        raise SceneError(f'"{phase}" has no spheres in this frame')
    x, y = grains.x[:, 0], grains.x[:, axis]
    low, high = (frame.domain[0] if frame.domain is not None else (x.min() - diameter / 2, x.max() + diameter / 2))
    deep = diameter if flat else float(frame.domain[across, 1] - frame.domain[across, 0]) if frame.domain is not None else float(numpy.ptp(grains.x[:, across])) + diameter
    columns = max(int(round((high - low) / (width or 4 * diameter))), 1)
    width = (high - low) / columns
    volume = 4 / 3 * numpy.pi * radius ** 3
    if flat:   # of a slab, by metre of depth
        volume, deep = volume / _slab(frame, grains, phase, volume, known), 1.0
    column = numpy.clip(((x - low) / width).astype(int), 0, columns - 1)
    bottom = numpy.full(columns, numpy.inf)   # of the lowest grain of each column
    numpy.minimum.at(bottom, column, y - radius)
    filled = _filled(y - radius - bottom[column], radius, volume, column, columns, diameter) / (width * diameter * deep)
    full = _median(filled)
    if not sure and full > CLOSEST[2 if flat else 3]:
        raise SceneError(f'"{phase}" fills {full:.2f} of the space of its bed, more than spheres of one diameter of {diameter:g} m can: its diameters differ, or it has no spheres; '
                         'expected a run with output.fields = ["radius"]')
    alone = sum(kind == "grains" for kind in frame.kinds) <= 1
    full = max(full, LOOSEST if alone else 0.0)
    slow, under = _slow(grains, axis, diameter, known), _Ground(frame, phase, axis, bottom, low, width, diameter, known)
    height, base, tops = numpy.full(columns, numpy.nan), y - radius, y + radius
    order = numpy.argsort(column, kind="stable")
    begins = numpy.searchsorted(column[order], numpy.arange(columns + 1))
    hanging = {}   # thick beds without ground below: over the outlet of a hopper
    for c in numpy.flatnonzero(numpy.isfinite(bottom)):
        first, last = _run(filled[c], full)
        surface = _surface(filled[c], last - 1, 0.5 * full) * diameter + bottom[c] if last - first > 1 else numpy.nan
        if last - first > 1 and under.reaches(c, bottom[c] + first * diameter, width, last - first >= THICK):   # `width`: a slope of 45 degrees fills its lowest slices in part
            height[c] = surface
        else:
            lying = order[begins[c]:begins[c + 1]]
            lying = lying[slow[lying] & under.reaches(c, base[lying])]
            height[c] = tops[lying].mean() if len(lying) else numpy.nan
            if last - first >= THICK and not len(lying):
                hanging[c] = (bottom[c] + first * diameter, surface)
    held = list(hanging)
    while held:   # those that the beds next to them hold, from the sides inwards
        found = [c for c in held if any(0 <= k < columns and bottom[k] < hanging[c][1] and hanging[c][0] < height[k] for k in (c - 1, c + 1))]
        for c in found:
            height[c] = hanging[c][1]
        held = [c for c in held if c not in found] if found else []
    solid = numpy.bincount(column, volume, columns) / (width * deep)
    return Bed(low + (numpy.arange(columns) + 0.5) * width, height, solid, width, float(volume.sum()))


def _upward(frame, known, up, flat):
    """The axis (1: y, 2: z) of the heights."""
    if up is None:
        if known.gravity is None or not known.gravity.any():
            if not flat:
                raise UsageError(f'{frame.path or "frame"}: no run.json next to the frame says where gravity pulls; expected up="y" or up="z"')
            return 1
        axis = int(abs(known.gravity).argmax())
        if axis == 0 or known.gravity[axis] > 0:
            raise UsageError(f'{frame.path or "frame"}: gravity is along {"-+"[int(known.gravity[axis] > 0)]}{"xyz"[axis]}; expected gravity along -y or -z, or up="y" or up="z"')
        return axis
    if up not in ("y", "z") or (flat and up == "z"):
        raise UsageError(f'up={up!r}: expected "y"' + ("" if flat else ' or "z"'))
    return {"y": 1, "z": 2}[up]


def _radius(grains, phase, known):
    """Radii (m) of the grains, and whether they are sure. Throws SceneError where the diameters differ and the frame does not have them."""
    radius = grains["radius"] if "radius" in grains else numpy.zeros(0)
    if radius.any():   # a phase of one diameter has 0 there
        return radius, True
    if known.sized.get(phase):
        raise SceneError(f'the diameters of "{phase}" differ, and the frame has no field "radius"; expected a run with output.fields = ["radius"]')
    if phase in known.diameters:
        return numpy.full(len(grains), known.diameters[phase] / 2), True
    return grains["smoothing_length"] if len(grains) else grains.x[:, 0], phase in known.sized


def _slab(frame, grains, phase, volume, known):
    """Thickness (m) of the slab of the grains in 2D: the program's own, from run.json or the scene, else from the mass in history.csv at the time of the frame; without all of them the
    largest mean diameter of the phases of grains of the frame."""
    if known.slab is not None:
        return known.slab
    try:
        history = table(files.below(known.folder, known.folder / "history.csv"))
        k = int(abs(history["time"] - frame.time).argmin())
        if f"{phase}_mass" in history and abs(history["time"][k] - frame.time) <= 1e-9 * max(abs(frame.time), 1e-9) and history[f"{phase}_mass"][k] > 0:
            return float((grains["density"] * volume).sum() / history[f"{phase}_mass"][k])
    except (BarchanError, LookupError, TypeError, ValueError):
        pass
    means = []
    for name in [name for name, kind in zip(frame.names, frame.kinds) if kind == "grains"] or [phase]:
        of = frame.of(name)
        radius = of["radius"] if "radius" in of and of["radius"].any() else of["smoothing_length"] if "smoothing_length" in of else of.x[:0, 0]
        means += [2 * float(radius.mean())] if len(radius) else []
    return max(means)


def _filled(above, radius, volume, column, columns, diameter):
    """Volume of the grains in each slice of each column (columns, slices), m3. `above`: from the bottom of the column to that of the grain, m."""
    slices = int(numpy.ceil(float((above + 2 * radius).max()) / diameter)) + 1
    filled = numpy.zeros((columns, slices))
    first = (above / diameter).astype(int)
    for step in range(int(numpy.ceil(2 * radius.max() / diameter)) + 1):   # the slices over which a grain reaches
        k = numpy.clip(first + step, 0, slices - 1)
        share = numpy.clip(numpy.minimum(above + 2 * radius, (k + 1) * diameter) - numpy.maximum(above, k * diameter), 0, None) / (2 * radius)
        numpy.add.at(filled, (column, k), numpy.where(first + step < slices, share, 0.0) * volume)
    return filled


def _median(filled):
    """How full the slices are in which the middle one of all grains lies."""
    full = numpy.sort(filled[filled > 0])
    return float(full[numpy.searchsorted(numpy.cumsum(full), 0.5 * full.sum())])


def _run(row, full):
    """The slices [first, last) of the bed of a column, of which the first and the last one are half full at least; equal where none is. Two slices with less than a third of `full` end
    it."""
    half = numpy.flatnonzero(row >= 0.5 * full)
    if not len(half):
        return 0, 0
    weak = numpy.append(row, 0.0) < 0.3 * full
    ends = numpy.flatnonzero(weak[:-1] & weak[1:])
    ends = ends[ends > half[0]]
    return int(half[0]), int(half[half < ends[0]][-1] if len(ends) else half[-1]) + 1


def _surface(row, last, half):
    """Where, in slices, the fullness passes `half` above the middle of the slice `last`."""
    above = row[last + 1] if last + 1 < len(row) else 0.0
    return last + 0.5 + (row[last] - half) / (row[last] - above)


class _Ground:
    """What grains may lie on: walls, bodies and other grains in their column, by the particles of the frame; where there are none the lowest grains nearby."""

    def __init__(self, frame, phase, axis, bottom, low, width, diameter, known):
        self._bottom, self._width, self._diameter, self._spacing = bottom, width, diameter, known.spacing
        solid = [k for k, (name, kind) in enumerate(zip(frame.names, frame.kinds)) if kind in ("wall", "rigid", "elastic", "grains") and name != phase]
        chosen = numpy.isin(frame["phase"], solid) if solid else numpy.zeros(len(frame), bool)
        column = numpy.floor((frame.x[chosen, 0] - low) / width).astype(int)
        order = numpy.lexsort((frame.x[chosen, axis], column))
        self._heights, self._from = frame.x[chosen, axis][order], numpy.searchsorted(column[order], numpy.arange(len(bottom) + 1))

    def reaches(self, c, height, slack=0.0, thick=False):
        """Whether (as the shape of `height`) the ground of column c is at most one and a half diameters and `slack` (m) below this height (m). Without walls there a `thick` bed counts as lying, and other grains
        near the lowest ones two columns to each side, from which the ground may rise by 45 degrees."""
        solid = numpy.append(-numpy.inf, self._heights[self._from[c]:self._from[c + 1]])
        highest = solid[numpy.searchsorted(solid, height + self._spacing, side="right") - 1]
        near = slice(max(c - 2, 0), c + 3)
        rise = self._width * abs(numpy.arange(near.start, near.start + len(self._bottom[near])) - c)
        lowest = (self._bottom[near] + rise).min()
        return numpy.where(highest > -numpy.inf, height - highest <= 1.5 * self._diameter + self._spacing + slack, thick | (height <= lowest + 1.5 * self._diameter + slack))


def _slow(grains, axis, diameter, known):
    """Which grains move up or down slower than after a fall of a quarter of a diameter: (n,) of bool; all where there is no gravity or no velocity."""
    pull = 9.81 if known.gravity is None else float(numpy.linalg.norm(known.gravity))
    if not pull or "velocity" not in grains:
        return numpy.ones(len(grains), bool)
    return abs(grains["velocity"][:, axis]) < (0.5 * pull * diameter) ** 0.5
