"""Elastic bodies in flows: the plate behind a cylinder of Turek & Hron (2006), tests FSI1, FSI2 and FSI3."""

import numpy

from harness import options, report, run, tell

# Turek & Hron, in Fluid-Structure Interaction (Springer 2006), p. 371, their finest grids: mean, amplitude and frequency (Hz) of the tip's motion
# (mm) and of the force on cylinder and plate (N/m).
FSI1 = {"u_x": .0227, "u_y": .8209, "drag": 14.295, "lift": .7638}
FSI2 = {"u_x": (-14.58, 12.44, 3.8), "u_y": (1.23, 80.6, 2.0), "drag": (208.83, 73.75, 3.8), "lift": (.88, 234.2, 2.0)}
FSI3 = {"u_x": (-2.69, 2.53, 10.9), "u_y": (1.48, 34.38, 5.3), "drag": (457.3, 22.66, 10.9), "lift": (2.22, 149.78, 5.3)}
# Constants of scenes/verification/turek_hron_fsi2.toml, its end and the start of what is measured (s). The plate gets a blow, so that it comes to its
# swings sooner than from rest; what it comes to does not depend on that.
SETS = {
    "FSI1": ({"U": .2, "rho": 1000, "E": 1.4e6, "ramp": 1, "kick": 0}, 9, 7),
    "FSI2": ({"U": 1, "rho": 10000, "E": 1.4e6, "ramp": 1, "kick": .5}, 9, 6),
    "FSI3": ({"U": 2, "rho": 1000, "E": 5.6e6, "ramp": 1, "kick": .5}, 5, 3.5),
}


def swings(t, y):
    """Mean, amplitude and frequency: of the extremes between the upward crossings of the mean, noise left aside."""
    z, half = y - y.mean(), .3 * (y.max() - y.min()) / 2
    up = numpy.flatnonzero((z[:-1] < 0) & (z[1:] >= 0))
    kept = list(up[:1])
    for u in up[1:]:
        between = z[kept[-1]:u]
        if between.min() < -half and between.max() > half:
            kept.append(u)
    if len(kept) < 2:
        return y.mean(), (y.max() - y.min()) / 2, 0.
    at = [t[u] - z[u] * (t[u + 1] - t[u]) / (z[u + 1] - z[u]) for u in kept]
    high = numpy.mean([y[a:b].max() for a, b in zip(kept, kept[1:])])
    low = numpy.mean([y[a:b].min() for a, b in zip(kept, kept[1:])])
    return (high + low) / 2, (high - low) / 2, (len(at) - 1) / (at[-1] - at[0])


def measured(name, n):
    """Time and, from the start of what is measured on, the tip's motion (mm) and the force on both (N/m, means of 25 ms); seconds."""
    constants, end, start = SETS[name]
    constants = {"dx": .1 / n, "dp": .05 / n, **constants}
    overrides = [f"constants.{k}={v!r}" for k, v in constants.items()] + [f"time.end={end}", "output.every=1"]
    (h,), seconds = run("turek_hron_fsi2", overrides, files=("history.csv",))
    t = h["time [s]"]
    late = t >= start
    values = {}
    for axis, place in (("x", .6), ("y", .2)):
        tip, before = h[f"tip_{axis} [m]"], h[f"before_{axis} [m]"]
        reach = (.6 - h["tip_x [m]"][0]) / (h["tip_x [m]"][0] - h["before_x [m]"][0])
        values[f"u_{axis}"] = 1e3 * (tip + reach * (tip - before) - place)[late]
        force = h[f"cylinder_force_{axis} [N]"] + h[f"plate_force_{axis} [N]"]
        values["drag" if axis == "x" else "lift"] = numpy.convolve(force, numpy.ones(5) / 5, "same")[late]
    return t[late], values, seconds


def steady(n):
    _, values, seconds = measured("FSI1", n)
    for what, known in FSI1.items():
        found = values[what]
        tell("FSI1", "consistent", n, f"{what}: mean of 7 to 9 s, rms of its changes; known {known}", f"{found.mean():.4g}, {found.std():.2g}", "", seconds)
        if what[0] == "u":
            report("FSI1", "consistent", n, f"{what} against {known}, relative", abs(found.mean() / known - 1), .03, seconds)


def swinging(name, known, n):
    t, values, seconds = measured(name, n)
    for what, (mean, amplitude, frequency) in known.items():
        found = swings(t, values[what])
        tell(name, "consistent", n, f"{what}: mean +- amplitude, Hz; known {mean} +- {amplitude}, {frequency}",
             f"{found[0]:.2f} +- {found[1]:.2f}, {found[2]:.2f}", "", seconds)
        if what[0] == "u":
            report(name, "consistent", n, f"amplitude of {what} against {amplitude}, relative", abs(found[1] / amplitude - 1), .03, seconds)
            report(name, "consistent", n, f"frequency of {what} against {frequency}, relative", abs(found[2] / frequency - 1), .015, seconds)


def spacings():
    return [n for n in (10, 20) if n <= options.largest]


def fsi1():
    for n in spacings():
        steady(n)


def fsi2():
    for n in spacings():
        swinging("FSI2", FSI2, n)


def fsi3():
    for n in spacings():
        swinging("FSI3", FSI3, n)


CASES = {
    "fsi1": (fsi1, "Plate behind a cylinder, at rest in the end (Turek and Hron, FSI1)"),
    "fsi2": (fsi2, "Plate behind a cylinder, swinging (Turek and Hron, FSI2)"),
    "fsi3": (fsi3, "Light plate behind a cylinder, swinging (Turek and Hron, FSI3)"),
}
