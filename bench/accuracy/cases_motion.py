"""What moves in water: a wave maker, a sphere that sinks in a tube, a cylinder that floats."""

import math
import pathlib

import numpy

import heave_reference
from harness import attempt, options, report, run, tell

# ---- wave maker ------------------------------------------------------------------------------------------------------

# kh: (where the absorbing layer begins, the end of the tank: in depths; first and last period of the measurement)
TANKS = {1: (6, 10.5, 4.5, 6.5), 2: (5, 8, 6, 8), 3: (4.5, 7, 8, 10)}
FROM = 2  # depths; from here on less than 0.4 % of the local waves is left in the velocity of any row
DEPTH, GRAVITY = 1., 9.81


def height_over_stroke(kh):
    """Of a piston, linear theory (Havelock 1929; Dean & Dalrymple 1984, chapter 6)."""
    return 2 * (math.cosh(2 * kh) - 1) / (math.sinh(2 * kh) + 2 * kh)


def two_waves(x, t, parts, k, omega):
    """Two waves, one to the right and one to the left, through values at the places x and times t: least squares in space and time.

    `parts`: (values, factor of the wave to the right, factor of the wave to the left, both complex), all arrays over x. The waves are
    Re(a f exp(i(omega t - K x))) and Re(b g exp(i(omega t + K x))) with K = k + dk - i gamma, a wave that dies along its way. Returns
    a, b (complex, at x = 0), dk, gamma and the root mean square of what is left over that of the values."""
    y = numpy.concatenate([values for values, _, _ in parts])

    def solve(p):
        wave = k + p[0] - 1j * p[1]
        right, left = numpy.exp(1j * (omega * t - wave * x)), numpy.exp(1j * (omega * t + wave * x))
        r, l = (numpy.concatenate([part[n] * side for part in parts]) for n, side in ((1, right), (2, left)))
        basis = numpy.column_stack([r.real, -r.imag, l.real, -l.imag])
        normal = numpy.linalg.solve(basis.T @ basis, basis.T @ y)
        return normal, y - basis @ normal

    p = numpy.zeros(2)
    for _ in range(8):
        step = 1e-4 * k
        left = solve(p)[1]
        jacobian = numpy.column_stack([(solve(p + d)[1] - left) / step for d in step * numpy.eye(2)])
        p = p - numpy.linalg.lstsq(jacobian, left, rcond=None)[0]
    c, left = solve(p)
    return c[0] + 1j * c[1], c[2] + 1j * c[3], p[0], p[1], math.sqrt((left**2).mean() / (y**2).mean())


def water_waves(frames, kh, start, end):
    """`two_waves` of the velocity of all the water from x = start to end: a and b are amplitudes of the surface."""
    k, omega = kh / DEPTH, math.sqrt(GRAVITY * kh / DEPTH * math.tanh(kh))
    places, times, us, vs = [], [], [], []
    for f in frames:
        inside = (f.x[:, 0] > start) & (f.x[:, 0] < end)
        places.append(f.x[inside])
        times.append(numpy.full(inside.sum(), f.time))
        us.append(f["velocity"][inside, 0])
        vs.append(f["velocity"][inside, 1])
    place, t, u, v = (numpy.concatenate(each) for each in (places, times, us, vs))
    x, y = place[:, 0], place[:, 1]
    along, up = omega * numpy.cosh(k * y) / math.sinh(kh), 1j * omega * numpy.sinh(k * y) / math.sinh(kh)
    return two_waves(x, t, [(u - u.mean(), along, -along), (v - v.mean(), up, up)], k, omega)


def surface_waves(frames, kh, start, end, dx):
    """`two_waves` of the height of the particles that were the top row at the start, brought from their place to the surface."""
    k, omega = kh / DEPTH, math.sqrt(GRAVITY * kh / DEPTH * math.tanh(kh))
    top = numpy.sort(frames[0]["id"][frames[0].x[:, 1] > DEPTH - .9 * dx])
    rows = []
    for f in frames[1:]:
        order = numpy.argsort(f["id"])
        rows.append((f.time, f.x[order[numpy.searchsorted(f["id"][order], top)]]))
    mean = numpy.mean([x[:, 1] for _, x in rows], axis=0)
    x, t, y = [], [], []
    for time, place in rows:
        inside = (place[:, 0] > start) & (place[:, 0] < end)
        x.append(place[inside, 0])
        t.append(numpy.full(inside.sum(), time))
        y.append((place[:, 1] - mean)[inside])
    x, t, y = (numpy.concatenate(each) for each in (x, t, y))
    share = math.sinh(k * (DEPTH - .5 * dx)) / math.sinh(kh) * numpy.ones_like(x)
    return two_waves(x, t, [(y, share, share)], k, omega)


def wave_maker(kh, n):
    """Height of the waves over the stroke, at the piston and two depths from it; what dies on the way; what the far end sends back."""
    quiet, far, first, last = TANKS[kh]
    omega = math.sqrt(GRAVITY * kh / DEPTH * math.tanh(kh))
    period = 2 * math.pi / omega
    overrides = [f"constants.rows={n}", f"constants.k={kh}", f"constants.quiet={quiet}", f"constants.far={far}",
                 f"time.end={last * period!r}", f"output.every={period / 20!r}", "output.walls=false"]
    name = f"wave maker, kh = {kh}"

    def measure():
        frames, seconds = run("wave_maker", overrides, "water", keep=lambda t: t == 0 or t > (first + .025) * period)
        amplitude = .02 * DEPTH
        start, end = FROM * DEPTH, quiet * DEPTH
        a, b, dk, gamma, rest = water_waves(frames[1:], kh, start, end)
        at = lambda x: abs(a) * math.exp(-gamma * x) / amplitude - 1
        tell(name, "consistent", n, "H/S of linear theory", f"{height_over_stroke(kh):.3f}", "", seconds)
        report(name, "consistent", n, f"H/S at the piston, without the local waves, {at(0):+.3f}: error", abs(at(0)), .05, seconds)
        report(name, "consistent", n, f"H/S two depths from the piston, {at(start):+.3f}: error", abs(at(start)), .05, seconds)
        report(name, "consistent", n, f"H/S at {quiet:g} depths, {at(end):+.3f}: error", abs(at(end)), None, seconds)
        report(name, "consistent", n, "amplitude that a depth of way takes", 1 - math.exp(-gamma * DEPTH), None, seconds)
        report(name, "consistent", n, "amplitude that a wave length takes", 1 - math.exp(-gamma * 2 * math.pi * DEPTH / kh), None, seconds)
        tell(name, "consistent", n, "wave number over that of linear theory", f"{1 + dk * DEPTH / kh:.4f}", "1", seconds)
        report(name, "consistent", n, "wave that comes back over the wave, two depths from the piston",
               abs(b) / abs(a) * math.exp(2 * gamma * start), .05, seconds)
        tell(name, "consistent", n, "velocity that is neither of the waves, rms over rms", f"{rest:.3f}", "", seconds)
        a, b, _, gamma, _ = surface_waves(frames, kh, start, end, DEPTH / n)
        surface = [abs(a) * math.exp(-gamma * x) / amplitude - 1 for x in (0, start)]
        tell(name, "consistent", n, "the same from the height of the top row: at the piston, two depths from it",
             f"{surface[0]:+.3f}, {surface[1]:+.3f}", "", seconds)
    attempt(name, "consistent", n, measure)


# ---- a sphere that sinks in a tube -----------------------------------------------------------------------------------

SPHERE, WATER, QUARTZ, NU, SHARE = 50e-6, 1000., 2650., 1e-6, .25  # m; kg/m3; kg/m3; m2/s; the diameter over that of the tube


def sinking_sphere(n):
    """Speed over that of Stokes flow in a tube (Faxen's series in Happel & Brenner 1983, section 7-3), from 3 ms on."""
    q = SHARE
    slower = 1 - 2.10444 * q + 2.08877 * q**3 - .94813 * q**5 - 1.372 * q**6 + 3.87 * q**8 - 4.19 * q**10
    speed = (QUARTZ - WATER) * GRAVITY * SPHERE**2 / (18 * WATER * NU) * slower
    scene = str(pathlib.Path(__file__).resolve().parent / "sinking_sphere.toml")
    (h,), seconds = run(scene, [f"constants.points={n}"], files=("history.csv",))
    late = h["time [s]"] > 3e-3
    excess = -h["sphere_velocity_z [m/s]"][late].mean() / speed - 1
    report("sphere sinks in a tube, Re 0.06", "consistent", n, f"speed over Faxen's, {excess:+.3f}: error", abs(excess), .05 if n > 8 else None, seconds)


# ---- a floating cylinder ---------------------------------------------------------------------------------------------

RADIUS = .0762  # m


def turns(t, y):
    """Where y turns: times and values, by the parabola through three samples."""
    found = []
    for k in range(1, len(y) - 1):
        if (y[k] - y[k - 1]) * (y[k + 1] - y[k]) < 0:
            bend = y[k + 1] - 2 * y[k] + y[k - 1]
            at = .5 * (y[k - 1] - y[k + 1]) / bend
            found.append((t[k] + at * (t[k + 1] - t[k]), y[k] - .25 * (y[k - 1] - y[k + 1]) * at))
    return found


def heaving_cylinder(n, lift=1 / 3):
    """Place of a floating cylinder that was lifted, over the lift, against linear theory (heave_reference.py)."""
    name = f"floating cylinder heaves, lifted by {lift:.2g} radii"

    def measure():
        (h,), seconds = run("heaving_cylinder", [f"constants.across={n}", f"constants.lift={lift!r}*a"], files=("history.csv",))
        t = h["time [s]"] * math.sqrt(GRAVITY / RADIUS)
        y = (h["cylinder_y [m]"] - 10 * RADIUS) / (lift * RADIUS)
        exact_t, exact_y, _ = heave_reference.free_heave(around=32, step=.02, end=12.5, reach=50)
        off = numpy.abs(y - numpy.interp(t, exact_t, exact_y))
        for number, ((at, value), (exact_at, exact_value)) in enumerate(zip(turns(t, y), turns(exact_t, exact_y)), 1):
            report(name, "consistent", n, f"time of turn {number}, {at:.2f} of {exact_at:.2f}: error", abs(at / exact_at - 1), .05, seconds)
            report(name, "consistent", n, f"turn {number}, {value:+.3f} of {exact_value:+.3f}: error over the lift", abs(value - exact_value), .05,
                   seconds)
        report(name, "consistent", n, "place over the lift, rms of the difference", math.sqrt((off**2).mean()), .05, seconds)
    attempt(name, "consistent", n, measure)


CASES = {
    "heaving-cylinder": (lambda: [heaving_cylinder(n) for n in (10, 20)],
                         "A floating cylinder that was lifted (Ito 1977; Maskell & Ursell 1970)"),
    "wave-maker": (lambda: [wave_maker(kh, n) for kh in TANKS for n in (25, 40)],
                   "Wave maker: a piston, height of the waves over the stroke (Havelock 1929)"),
    "sinking-sphere": (lambda: [sinking_sphere(n) for n in (8, 14)], "A sphere that sinks in a tube of water, in three dimensions (Faxen)"),
}
