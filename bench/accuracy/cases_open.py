"""Flows that enter and leave through sides: a cylinder in a stream, backward-facing steps, a vortex that is carried out."""

import math

import numpy

from harness import local_fit, options, report, run, tell

# ---- round cylinder --------------------------------------------------------------------------------------------------

# Cd and St without bounds: Dennis & Chang 1970; Williamson 1989 and Park et al. 1998; Posdziech & Grundmann 2007 (two-dimensional flow).
OPEN_CYLINDER = {20: (2.05, None), 100: (1.33, .165), 200: (1.34, .196)}
WAKE = {20: 30, 100: 60, 200: 60}  # s, the end of a run; the means are of its last two fifths (Re 20: of the last fifth)
NEAR = {20: (1.2, 20, 15), 100: (.75, 50, 28), 200: (.75, 50, 28)}  # m2/s, the wake's source; s, the end, the start of the means


def drag_and_frequency(h, start, periodic):
    """Mean drag coefficient and frequency of the lift from `start` on, over whole periods of the lift, and how many they are."""
    t = h["time [s]"]
    late = t > start
    t, drag, lift = t[late], 2 * h["cylinder_force_x"][late], 2 * h["cylinder_force_y"][late]
    if not periodic:
        return drag.mean(), None, 0
    smooth = numpy.convolve(lift - lift.mean(), numpy.ones(9) / 9, "same")
    up = numpy.flatnonzero((smooth[:-1] < 0) & (smooth[1:] >= 0))
    up = up[numpy.concatenate([[True], numpy.diff(t[up]) > 2])]  # noise crosses zero more than once
    crossings = t[up] - smooth[up] * (t[up + 1] - t[up]) / (smooth[up + 1] - smooth[up])
    whole = (t >= crossings[0]) & (t <= crossings[-1])
    return drag[whole].mean(), (len(crossings) - 1) / (crossings[-1] - crossings[0]), len(crossings) - 1


def cylinder(re, n):
    """Mean drag and frequency of the lift, brought to a stream without bounds (Allen & Vincenti 1944)."""
    (h,), seconds = run("cylinder_open", [f"spacing={1 / n!r}", f"phases.water.viscosity={1 / re!r}", f"time.end={WAKE[re]}"], files=("history.csv",))
    drag, strouhal, periods = drag_and_frequency(h, (.6 if re > 50 else .8) * WAKE[re], re > 50)
    faster = 1 + drag / 4 / 16 + .82 / 16**2
    tell_cylinder(f"open cylinder, Re {re}, 22 x 16 D", n, re, drag, strouhal, periods, faster, .02, seconds)


def tell_cylinder(name, n, re, drag, strouhal, periods, faster, bound, seconds):
    true_drag, true_strouhal = OPEN_CYLINDER[re]
    report(name, "consistent", n, f"Cd against {true_drag}, relative", abs(drag / faster**2 / true_drag - 1), bound, seconds)
    tell(name, "consistent", n, "Cd as measured, speed at the cylinder over U, Cd corrected", f"{drag:.3f}, {faster:.4f}, {drag / faster**2:.3f}", "", seconds)
    if strouhal:
        report(name, "consistent", n, f"St against {true_strouhal}, relative", abs(strouhal / faster / true_strouhal - 1), bound, seconds)
        tell(name, "consistent", n, f"St as measured, corrected, of {periods} periods", f"{strouhal:.4f}, {strouhal / faster:.4f}", "", seconds)


def streamline(source, doublet=.25, end=(7.5, 3.9), start=-3.5, corners=45):
    """Corners of the wall above: a streamline through `end` of a stream of speed 1 with a doublet and a source at the origin."""
    def psi(x, y):
        return y + source / (2 * numpy.pi) * numpy.arctan2(y, x) - doublet * y / (x * x + y * y)
    x = numpy.linspace(start, end[0], corners)
    low, high = numpy.full(corners, 2.), numpy.full(corners, 4.5)
    for _ in range(60):
        y = (low + high) / 2
        below = psi(x, y) < psi(*end)
        low, high = numpy.where(below, y, low), numpy.where(below, high, y)
    return list(zip(x.tolist(), low.tolist()))


def speed_at_the_cylinder(tables, wake=2.2):
    """Speed at the origin over that of the stream, without what cylinder and wake do themselves: Cauchy's integral of the mean velocity on the
    rectangle (Ashill & Weeks 1982). Inside the wake, |y| < `wake` on the right, the velocity beside it counts."""
    induced = 0
    for side, table in tables.items():
        x, y, u, v = (table[k] for k in ("x [m]", "y [m]", "velocity_mean_x [m/s]", "velocity_mean_y [m/s]"))
        u = u - 1
        if side == "right":
            inside = abs(y) < wake
            u, v = numpy.where(inside, u[~inside].mean(), u), numpy.where(inside, 0, v)
        z = x + 1j * y
        induced += numpy.trapz((u - 1j * v) / z, z) / (2j * numpy.pi) * (1 if side in ("bottom", "right") else -1)
    return 1 + induced.real


def near_cylinder(re, n):
    """The same in a quarter of the area, between walls that follow streamlines."""
    source, end, start = NEAR[re]
    wall = streamline(source)
    overrides = [f"spacing={1 / n!r}", f"phases.water.viscosity={1 / re!r}", f"constants.Q={source}", f"constants.kick={1 if re > 50 else 0}", f"time.end={end}"]
    for fill, sign in ((2, 1), (3, -1)):
        corners = ", ".join(f"[{x:g}, {sign * y:.4f}]" for x, y in [*wall, (7.5, 4), (-3.5, 4)])
        overrides.append(f"fill.{fill}.shape={{ polygon = [{corners}] }}")
    overrides += [f"profile.{k}.start={start}" for k in range(4)]
    sides = ("bottom", "right", "top", "left")
    (h, *tables), seconds = run("cylinder_open_near", overrides, files=("history.csv", *(f"profile_{s}.csv" for s in sides)))
    drag, strouhal, periods = drag_and_frequency(h, start, re > 50)
    tell_cylinder(f"open cylinder, Re {re}, 11 x 8 D", n, re, drag, strouhal, periods, speed_at_the_cylinder(dict(zip(sides, tables))), .04, seconds)


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
STEP_END = {100: 50, 200: 70, 400: 110}  # s, the end of a run


def step(re, rows=31):
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


# ---- backward-facing step, turbulent ---------------------------------------------------------------------------------

STEP_MEASURED = 7.4  # x_r/H; Fessler & Eaton 1999, as later papers quote it
STEP_H, STEP_AT, STEP_BEGINS = .0267, .267, .15  # m, m, s: height and place of the step; the means begin
# Measured y/H: u/U by x/H, points of the profiles of Fessler & Eaton 1999 as read off by github.com/tbellosta/CFD2021, BFS/SU2/RESULTS/EXPERIMENTAL.
STEP_PROFILES = {
    2: {.085: -.102, .285: -.127, .399: -.102, .556: -.048, .674: .036, .787: .178, .895: .332, .978: .486, 1.06: .639, 1.167: .793, 1.306: .894,
        1.484: .954, 1.746: .975, 2.005: .945, 2.103: .915},
    5: {.03: -.137, .183: -.091, .26: -.046, .343: -.011, .472: .067, .572: .169, .64: .232, .767: .364, .908: .5, .977: .57, 1.126: .699, 1.263: .81,
        1.43: .902, 1.63: .931, 1.796: .917, 1.957: .879, 2.133: .82},
    7: {.16: .009, .282: .089, .431: .176, .586: .262, .732: .353, .881: .464, 1.029: .59, 1.177: .687, 1.332: .774, 1.497: .822, 1.681: .855,
        1.89: .829, 2.052: .781, 2.13: .745},
    9: {.134: .168, .24: .208, .358: .248, .556: .335, .727: .415, .871: .502, 1.022: .599, 1.187: .69, 1.344: .752, 1.507: .779, 1.691: .785,
        1.86: .752, 2.017: .711, 2.118: .677},
    12: {.12: .302, .212: .331, .347: .375, .47: .409, .588: .444, .697: .485, .806: .527, .918: .575, 1.118: .627, 1.348: .71, 1.46: .728,
         1.643: .742, 1.746: .726, 1.935: .683, 2.101: .636}}


def comes_back(places, u):
    """The last place at which u changes its sign from below, between two places by a straight line."""
    k = numpy.flatnonzero((u[:-1] < 0) & (u[1:] >= 0))
    if not len(k):
        return numpy.nan
    k = k[-1]
    return places[k] + (places[k + 1] - places[k]) * u[k] / (u[k] - u[k + 1])


def turbulent_step(n, turbulence):
    """Where the flow comes back to the floor: sign of the mean velocity half a spacing over it, of the second half of the run and of its quarters."""
    dx, h = STEP_H / n, STEP_H
    frames, seconds = run("backward_step_turbulent", [f"spacing={dx!r}", f"phases.air.turbulence={turbulence}"], "air", keep=lambda t: t > STEP_BEGINS)
    places = numpy.arange(.25, 15, .25)

    def speed(f, x, y):
        near = abs(f.x[:, 0] - x) < 2.6 * dx
        return local_fit(f.x[near], f["velocity"][near, 0], (x, y), 2.6 * dx)
    u = numpy.array([[speed(f, STEP_AT + s * h, .5 * dx) for s in places] for f in frames])
    back = comes_back(places, u.mean(0))
    quarters = [comes_back(places, part.mean(0)) for part in numpy.array_split(u, 4)]
    name, scheme = "turbulent step, Re 18,400", turbulence.replace("mixing-l", "mixing l")
    report(name, scheme, n, "x_r/H", back, None, seconds)
    report(name, scheme, n, f"against {STEP_MEASURED} (Fessler & Eaton 1999), relative", abs(back / STEP_MEASURED - 1), .1, seconds)
    tell(name, scheme, n, "x_r/H of the quarters of the means", ", ".join(f"{q:.2f}" for q in quarters), "", seconds)
    k = u.mean(0).argmin()
    tell(name, scheme, n, "fastest reversed flow, z = dx/2, over U", f"{u.mean(0)[k] / 10.5:.2f} at {places[k]:.2f} H", "", seconds)
    off = [numpy.mean([speed(f, STEP_AT + x * h, y * h) for f in frames]) / 10.5 - m for x, table in STEP_PROFILES.items() for y, m in table.items()]
    tell(name, scheme, n, "mean u - measured u, rms of 75 places at 2, 5, 7, 9, 12 H, over U", f"{math.sqrt(numpy.mean(numpy.square(off))):.3f}", "", seconds)
    axis = numpy.mean([speed(f, STEP_AT - .25 * h, 1.75 * h) for f in frames])
    tell(name, scheme, n, "speed on the axis H/4 ahead of the step, m/s", f"{axis:.2f}", "10.5 measured", seconds)


CASES = {
    "open-cylinder": (lambda: [case(re, 20) for case in (near_cylinder, cylinder) for re in (20, 100, 200)],
                      "Round cylinder in a stream that enters and leaves"),
    "open-vortex": (lambda: [vortex(s, n) for s in ("consistent", "plain") for n in (50, 100) if n <= options.largest],
                    "A vortex that is carried out of the domain"),
    "open-step": (lambda: [step(re) for re in (100, 200, 400)], "Backward-facing step with open ends, expansion ratio 1.94"),
    "backward-step-turbulent": (lambda: [*(turbulent_step(n, "k-omega") for n in (8, 12) if n <= options.largest), turbulent_step(8, "mixing-length")],
                                "Turbulent air behind a backward-facing step in a channel, expansion 5 to 3 (Fessler & Eaton 1999)"),
}
