"""Flows that enter and leave through sides: a cylinder in a stream, a backward-facing step, a vortex that is carried out."""

import math

import numpy

from cases_walls import CYLINDER, STEP, beyond
from harness import options, report, run, tell

# ---- round cylinder --------------------------------------------------------------------------------------------------

# Least and largest of the literature without bounds; Re 200 of the two-dimensional flow (Posdziech & Grundmann 2007; Park et al. 1998).
OPEN_CYLINDER = {**CYLINDER, 200: ((1.32, 1.36), (.194, .198))}
WAKE = {20: 30, 100: 90, 200: 90}  # s, the end of a run


def cylinder(re, n, small=False):
    """Mean drag and frequency of the lift, brought to a stream without bounds (Allen & Vincenti 1944). `small`: a quarter of the area."""
    width, overrides = (8, ["domain.origin=[-3.5, -4]", "domain.size=[11, 8]"]) if small else (16, [])
    (h,), seconds = run("cylinder_open", [*overrides, f"spacing={1 / n!r}", f"phases.water.viscosity={1 / re!r}", f"time.end={WAKE[re]}"],
                        files=("history.csv",))
    t = h["time [s]"]
    late = t > (.6 if re > 50 else .8) * WAKE[re]
    t, drag, lift = t[late], 2 * h["cylinder_force_x [N]"][late], 2 * h["cylinder_force_y [N]"][late]
    true_drag, true_strouhal = OPEN_CYLINDER[re]
    name, bound = f"open cylinder, Re {re}, {'11 x 8' if small else '22 x 16'} D", .04 if small else .02
    if true_strouhal:
        smooth = numpy.convolve(lift - lift.mean(), numpy.ones(9) / 9, "same")
        up = numpy.flatnonzero((smooth[:-1] < 0) & (smooth[1:] >= 0))
        up = up[numpy.concatenate([[True], numpy.diff(t[up]) > 2])]  # noise crosses zero more than once
        crossings = t[up] - smooth[up] * (t[up + 1] - t[up]) / (smooth[up + 1] - smooth[up])
        whole = (t >= crossings[0]) & (t <= crossings[-1])
        drag = drag[whole]
        strouhal = (len(crossings) - 1) / (crossings[-1] - crossings[0])
    faster = 1 + drag.mean() / 4 / width + .82 / width**2
    corrected = drag.mean() / faster**2
    report(name, "consistent", n, "drag, corrected for blockage, beyond the literature's range", beyond(corrected, true_drag), bound, seconds)
    tell(name, "consistent", n, "Cd as measured, corrected, literature", f"{drag.mean():.3f}, {corrected:.3f}, {true_drag[0]} to {true_drag[1]}", "", seconds)
    if true_strouhal:
        report(name, "consistent", n, "Strouhal number, corrected, beyond the literature's range", beyond(strouhal / faster, true_strouhal), bound, seconds)
        tell(name, "consistent", n, "St as measured, corrected, literature",
             f"{strouhal:.4f}, {strouhal / faster:.4f}, {true_strouhal[0]} to {true_strouhal[1]}", "", seconds)


# ---- a vortex that leaves --------------------------------------------------------------------------------------------

VORTEX = """spacing = {spacing}
[domain]
size = [{length}, 1]
periodic = ["y"]
[phases.air]
kind = "fluid"
density = 1
viscosity = 0
sound-speed = 12
scheme = "{scheme}"
[interactions]
air-air = {radius}
[[fill]]
phase = "air"
shape = "the-rest"
perturb = 0.2
velocity = ["1 - 3*(y - 0.5)*exp(-((x - 0.5)^2 + (y - 0.5)^2)/0.02)", "3*(x - 0.5)*exp(-((x - 0.5)^2 + (y - 0.5)^2)/0.02)"]
pressure = "-0.045*exp(-((x - 0.5)^2 + (y - 0.5)^2)/0.01)"
[[inflow]]
phase = "air"
side = "left"
velocity = [1, 0]
[[outflow]]
phase = "air"
side = "right"
[time]
end = 1.2
largest-speed = 1.3
[output]
every = 0.1
"""


def vortex(scheme, n):
    """A vortex of a radius of 0.1 m is carried out of a domain of one metre: L1 of its velocity in that metre, over that in a domain of three."""
    def errors(length):
        text = VORTEX.format(spacing=1 / n, length=length, scheme=scheme, radius=2.1 if scheme == "consistent" else 2.6)
        frames, seconds = run(text, [], "air")
        found = {}
        for f in frames:
            x, y, c = f.x[:, 0], f.x[:, 1] - .5, .5 + f.time
            inside = x < 1
            bump = 3 * numpy.exp(-((x - c) ** 2 + y**2) / .02)
            exact = numpy.column_stack([1 - y * bump, (x - c) * bump])
            found[round(f.time, 3)] = abs(f["velocity"][:, :2] - exact)[inside].sum(1).mean()
        return found, seconds
    (short, one), (long, two) = errors(1), errors(3)
    passage = [t for t in short if .2 < t < .9]  # its centre passes the side at 0.5 s
    mean = lambda e: sum(e[t] for t in passage) / len(passage)
    report("vortex through an outflow", scheme, n, "L1 in one metre over that of a domain of three, mean of its passage", mean(short) / mean(long), 1.3, one + two)
    tell("vortex through an outflow", scheme, n, "L1/U, mean of its passage, in both", f"{mean(short):.2e}, {mean(long):.2e}", "", one + two)
    tell("vortex through an outflow", scheme, n, "L1/U in one metre when it is gone, t = 1.2 s, in both", f"{short[1.2]:.2e}, {long[1.2]:.2e}", "", one + two)


# ---- backward-facing step --------------------------------------------------------------------------------------------

STEP_SCENE = """spacing = {spacing}
[domain]
size = [{length}, 1.9423]
[phases.fluid]
kind = "fluid"
density = 1
viscosity = {viscosity}
sound-speed = 15
[phases.wall]
kind = "wall"
[phases.block]
kind = "wall"
[interactions]
fluid-fluid = 2.6
fluid-wall = 2.1
fluid-block = 2.1
[[fill]]
phase = "wall"
shape = {{ sides = ["bottom", "top"] }}
[[fill]]
phase = "block"
shape = {{ box = {{ min = [0, 0], max = [3, 0.9423] }} }}
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = 0.2
velocity = ["(y > 0.9423) ? 6*(y - 0.9423)*(1.9423 - y) : 0", 0]
[[inflow]]
phase = "fluid"
side = "left"
velocity = ["(y > 0.9423) ? 6*(y - 0.9423)*(1.9423 - y) : 0", 0]
[[outflow]]
phase = "fluid"
side = "right"
[[wall-shear]]
name = "floor"
phase = "fluid"
wall = "wall"
start = {start}
[time]
end = {end}
largest-speed = 1.5
[output]
every = {end}
"""


# x_r/S of expansion 1.9423 by a second method (step_reference.py: differences for stream function and vorticity).
STEP_OPEN = {100: 2.861, 200: 4.891, 400: 8.187}
STEP_END = {100: 60, 200: 80, 400: 120}  # s, the end of a run


def step(re, rows=35):
    """Reattachment behind a step of expansion 1.94 with open ends; `rows` of particles in the wide part, of them the narrow part and the step have a
    whole number, nearly (31: 16 and 15; 35: 18 and 17)."""
    n, end = round(rows / 1.9423), STEP_END[re]
    text = STEP_SCENE.format(spacing=1.9423 / rows, length=20, viscosity=2 / re, start=.7 * end, end=end)
    (floor,), seconds = run(text, [], files=("wall_shear_floor.csv",))
    x, tau = floor["x [m]"] - 3, floor["shear_stress_mean_x [Pa]"]
    x, tau = x[x > .3], tau[x > .3]
    k = numpy.flatnonzero((tau[:-1] < 0) & (tau[1:] >= 0))[0]
    reattachment = (x[k] + (x[k + 1] - x[k]) * tau[k] / (tau[k] - tau[k + 1])) / .9423
    report(f"open step, Re {re}", "consistent", n, "x_r/S", reattachment, None, seconds)
    report(f"open step, Re {re}", "consistent", n, f"against {STEP_OPEN[re]} (step_reference.py), relative", abs(reattachment / STEP_OPEN[re] - 1), .04, seconds)


CASES = {
    "open-cylinder": (lambda: [cylinder(re, n, small) for n in (12.5, 20) if n <= options.largest for re in (20, 100, 200) for small in (False, True)],
                      "Round cylinder in a stream that enters and leaves"),
    "open-vortex": (lambda: [vortex(s, n) for s in ("consistent", "plain") for n in (50, 100) if n <= options.largest],
                    "A vortex that is carried out of the domain"),
    "open-step": (lambda: [step(re) for re in (100, 200, 400)], "Backward-facing step with open ends, expansion ratio 1.94"),
}
