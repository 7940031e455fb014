"""Numbers for axes, colour bars and ranges: round ones, and statistics that one particle does not decide."""

import math

import numpy as np

NICE = (1, 1.2, 1.6, 2, 2.4, 3, 3.6, 4, 5, 6, 7, 8, 9, 10, 12)


def nice_ceiling(value):
    """The next of 1, 1.2, 1.6, 2, 2.4, 3, 3.6, 4, 5, ... 10 times a power of ten."""
    if not (value > 0 and math.isfinite(value)):
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(m * power for m in NICE if m * power >= value * (1 - 1e-6))


def round_floor(value):
    """The next of 1, 2, 5 times a power of ten below a value."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(m * power for m in (1, 2, 5) if m * power <= value * (1 + 1e-9))


def ticks(low, high, count=6):
    """Round numbers from low to high, about `count` of them."""
    step = (high - low) / max(count, 1)
    if step <= 0:
        return [low]
    power = 10.0 ** math.floor(math.log10(step))
    step = min((m * power for m in (1, 2, 2.5, 5, 10)), key=lambda s: abs(math.log(s / step)))
    first = math.ceil(low / step - 1e-9)
    return [k * step for k in range(first, int(math.floor(high / step + 1e-9)) + 1)]


def spaced_ticks(low, high, room, upright=False):
    """Round numbers from low to high, up to eight and so few that each has its place along an axis that is `room` letters long."""
    for count in range(8, 0, -1):
        places = ticks(low, high, count)
        needed = 1.7 if upright else 0.62 * max((len(f"{p:g}") for p in places), default=0) + 1.4
        if len(places) < 2 or room * (places[1] - places[0]) / (high - low) >= needed:
            break
    return places if len(places) < 2 or room * (places[1] - places[0]) / (high - low) >= needed else places[:1]


def bar_ticks(low, high):
    """As ticks(), but with one at each end where a round step allows it."""
    for count in (5, 4, 6, 3, 7, 8):
        step = (high - low) / count
        digits = step / 10.0 ** math.floor(math.log10(step)) if step > 0 else 0
        if any(abs(digits - m) < 1e-6 for m in (1, 2, 2.5, 3, 4, 5)) and abs(low / step - round(low / step)) < 1e-6:
            return [min(low + k * step, high) for k in range(count + 1)]   # ParaView drops a tick beyond the end by round-off
    return ticks(low, high, 5)


def percentile(values, share):
    """The finite value that `share` per cent do not exceed. Of 20 values or more it is never the largest (or, for a
    share below 50, the smallest) one: a single particle decides nothing."""
    values = np.asarray(values)[np.isfinite(values)]
    if not len(values):
        return 0.0
    if len(values) < 20:
        return float(values.max() if share >= 50 else values.min())
    return float(np.percentile(values, share, method="lower" if share >= 50 else "higher"))


def within_reach(points, spacing):
    """Which points belong to the scene when no file says how large it is: those not farther from the middle 99 % of them
    than half its size and ten spacings. All, if they are fewer than 50."""
    if len(points) < 50:
        return np.ones(len(points), dtype=bool)
    low, high = np.percentile(points, [0.5, 99.5], axis=0)
    reach = 0.5 * (high - low) + 10 * spacing
    return ((points >= low - reach) & (points <= high + reach)).all(axis=1)


def stress_unit(values):
    """The unit for a colour bar of stresses in Pa, and how many Pa it is."""
    top = percentile(np.abs(values), 99.5)
    return next(((unit, factor) for unit, factor in (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)) if top >= factor), ("Pa", 1.0))
