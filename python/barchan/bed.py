"""The surface of a bed of grains along x, and how much lies there."""

import typing

import numpy


class Bed(typing.NamedTuple):
    """`x`: middles of the columns (m); `height`: of the surface (m), nan where no grains lie; `solid`: volume of the grains by area of ground (m), those in flight too; `width`: of a
    column (m); `volume`: of all grains (m3; in 2D by metre of depth)."""
    x: numpy.ndarray
    height: numpy.ndarray
    solid: numpy.ndarray
    width: float
    volume: float


def bed(frame, phase, width=None, up="y"):
    """The bed of the spheres of a phase (Bed). `width`: of a column along x, m (default 4 mean diameters); `up`: the axis of the heights, "y" or "z".

    The surface is where, coming from above, grains first fill half as much as in the bed: in slices one diameter high, over which each grain is spread by its own height."""
    grains = frame.of(phase)
    flat = not frame.x[:, 2].any()
    radius = grains["radius"] if "radius" in grains else grains["smoothing_length"]
    diameter = 2 * float(radius.mean()) if len(radius) else 0.0
    if not diameter > 0:
        raise ValueError(f'"{phase}" has no spheres in this frame')
    x, y = grains.x[:, 0], grains.x[:, {"y": 1, "z": 2}[up]]
    across = {"y": 2, "z": 1}[up]
    low, high = (frame.domain[0] if frame.domain is not None else (x.min() - diameter / 2, x.max() + diameter / 2))
    deep = diameter if flat else float(frame.domain[across, 1] - frame.domain[across, 0]) if frame.domain is not None else float(numpy.ptp(grains.x[:, across])) + diameter
    columns = max(int(round((high - low) / (width or 4 * diameter))), 1)
    width = (high - low) / columns
    volume = 4 / 3 * numpy.pi * radius ** 3
    if flat:   # of a slab one mean diameter thick, by metre of depth
        volume, deep = volume / deep, 1.0
    bottom = float((y - radius).min())
    slices = int(numpy.ceil((float((y + radius).max()) - bottom) / diameter)) + 1
    column = numpy.clip(((x - low) / width).astype(int), 0, columns - 1)
    filled = numpy.zeros((columns, slices))
    first = ((y - radius - bottom) / diameter).astype(int)
    for step in range(int(numpy.ceil(2 * radius.max() / diameter)) + 1):   # the slices over which a grain reaches
        k = numpy.clip(first + step, 0, slices - 1)
        share = numpy.clip(numpy.minimum(y + radius, bottom + (k + 1) * diameter) - numpy.maximum(y - radius, bottom + k * diameter), 0, None) / (2 * radius)
        numpy.add.at(filled, (column, k), numpy.where(first + step < slices, share, 0.0) * volume)
    filled /= width * diameter * deep
    half = 0.5 * float(numpy.percentile(filled[filled > 0], 80))
    height = numpy.full(columns, numpy.nan)
    for c, row in enumerate(filled):
        there = numpy.flatnonzero(row >= half)
        if len(there):
            k = there[-1]
            above = row[k + 1] if k + 1 < slices else 0.0
            height[c] = bottom + diameter * (k + 0.5 + (row[k] - half) / (row[k] - above))
    solid = numpy.bincount(column, volume, columns) / (width * deep)
    return Bed(low + (numpy.arange(columns) + 0.5) * width, height, solid, width, float(volume.sum()))
