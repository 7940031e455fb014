"""Periodic flows with an exact solution: Taylor-Green vortices and what they cost, waves, the ABC flow."""

import math

import numpy

from harness import options, report, run

# ---- Taylor-Green ----------------------------------------------------------------------------------------------------

def taylor_green(sizes=(50, 100, 200)):
    """L1 of the speed at t = 1 and the decay rate of the kinetic energy's root, mean of two seeds (one at 200 spacings).

    The exact solution is incompressible: at a fixed sound speed the error ends at the square of the Mach number, so the sound speed
    grows with the resolution, 10 U at 50 spacings, 20 U at 100, 40 U at 200."""
    errors = {}
    for n in [n for n in sizes if n <= options.largest]:
        e, rate, total = [], [], 0
        for seed in (1, 2) if n < 200 else (1,):
            frames, seconds = run("taylor_green", [f"spacing={1 / n!r}", f"fill.0.seed={seed}",
                                                   f"phases.fluid.sound-speed={10 * max(n, 50) / 50:g}"])
            f, total = frames[-1], total + seconds
            x = 2 * numpy.pi * f.x
            exact = math.exp(-.08 * math.pi**2) * numpy.hypot(numpy.cos(x[:, 0]) * numpy.sin(x[:, 1]),
                                                              numpy.sin(x[:, 0]) * numpy.cos(x[:, 1]))
            e.append(abs(numpy.hypot(f["velocity"][:, 0], f["velocity"][:, 1]) - exact).sum() / exact.sum())
            energy = [.5 * math.log((g["velocity"] ** 2).sum(axis=1).mean()) for g in frames]
            rate.append(numpy.polyfit([g.time for g in frames], energy, 1)[0] / (-.08 * math.pi**2) - 1)
        errors[n] = numpy.mean(e)
        report("Taylor-Green", "consistent", n, "L1(t=1)", errors[n], {50: .004, 100: .0015}.get(n, .0015), total)
        report("Taylor-Green", "consistent", n, "error of the decay rate", abs(numpy.mean(rate)), .005, total)
    if len(errors) > 1:
        a, b = min(errors), max(errors)
        report("Taylor-Green", "consistent", b, f"order from {a}", math.log(errors[a] / errors[b]) / math.log(b / a), 1.7, 0, True)


# ---- waves -----------------------------------------------------------------------------------------------------------

BOX = """dimensions = {dimensions}
spacing = {dx!r}
[domain]
size = {size}
periodic = {axes}
[phases.fluid]
kind = "fluid"
density = 1
viscosity = {viscosity!r}
sound-speed = {sound!r}
scheme = "consistent"
[interactions]
kernel = "wendland-c2"
fluid-fluid = 2.6
[[fill]]
phase = "fluid"
shape = "the-rest"
perturb = {perturb!r}
velocity = {velocity}
pressure = {pressure}
[time]
end = {end!r}
largest-speed = {speed!r}
{more}
[output]
every = {every!r}
"""


def lattice_operators(k, dx, radius=2.6):
    """What the sums make of grad and lap of exp(i k x) on the square lattice: (i G, -L)."""
    m = int(radius) + 1
    x, y = [a.ravel() * dx for a in numpy.meshgrid(numpy.arange(-m, m + 1), numpy.arange(-m, m + 1))]
    q = numpy.hypot(x, y) / (radius * dx)
    f = numpy.where((q > 0) & (q < 1), -(1 - q) ** 3, 0)  # Wendland C2: F, up to a constant that divides out
    trace = (f * (x**2 + y**2)).sum()
    return (f * x * numpy.sin(k * x)).sum() / (f * x**2).sum(), 4 * (f * (1 - numpy.cos(k * x))).sum() / trace


def waves(n):
    """A standing sound wave and a shear wave on the lattice against the scheme's own amplification matrix, to 1e-3."""
    amplitude, c, nu, dx = 1e-6, 1.0, 1e-3, 1 / n
    k, width = 2 * math.pi, round(max(8, n / 2))
    gradient, laplace = lattice_operators(k, dx)
    dt = .4 * dx / c
    steps = round(2.0 / dt)
    size = [1, width * dx]
    for name, velocity, pressure in (("sound wave", [0, 0], f'"{amplitude}*cos(2*pi*x)"'),
                                     ("shear wave", [0, f"{amplitude}*sin(2*pi*x)"], 0)):
        scene = BOX.format(dimensions=2, dx=dx, size=size, axes='["x", "y"]', viscosity=nu, sound=c, perturb=0., velocity=velocity,
                           pressure=pressure, end=steps * dt, speed=1e-5, more=f"step = {dt!r}", every=steps * dt)
        frames, seconds = run(scene, [], "fluid")
        f = frames[-1]
        # kick, drift, kick with rates from velocities half a step old: theta = 1.25, delta = 0.05 (docs/method.md)
        diffusion = 1.25 * c * c * dt + .05 * 1.3 * dx * c
        sound = name == "sound wave"
        r, v = (amplitude / c**2, 0.) if sound else (0., amplitude)
        v_old, acceleration = v, None
        for step in range(steps):
            # rho = r cos kx, u = v sin kx (sound); v sin kx along y (shear)
            acceleration = (c * c * gradient * r if sound else 0) - nu * laplace * v
            rate = -gradient * v - diffusion * laplace * r if sound else 0
            v += dt * acceleration * (.5 if step == 0 else 1)
            r += dt * rate
        acceleration = (c * c * gradient * r if sound else 0) - nu * laplace * v
        v += .5 * dt * acceleration
        x = f.x[:, 0]
        got_r = 2 * ((f["density"] - 1) * numpy.cos(k * x)).mean()
        got_v = 2 * (f["velocity"][:, 0 if sound else 1] * numpy.sin(k * x)).mean()
        worst = max(abs(got_r - r) * c**2 if sound else 0, abs(got_v - v)) / amplitude
        report(f"{name}, lambda = {n} dx", "consistent", n, "against the lattice's formula, of the amplitude", worst, .001, seconds)
        if not sound:
            exact = math.exp(-nu * k * k * steps * dt)
            report(f"{name}, lambda = {n} dx", "consistent", n, "against exp(-nu k2 t)", abs(got_v / amplitude - exact), .001, seconds)


# ---- ABC flow --------------------------------------------------------------------------------------------------------

def abc(n):
    """Arnold-Beltrami-Childress flow, A = B = C = 1/2: an exact solution in 3D that decays as exp(-nu k2 t). Re = 50, t = 1."""
    k, nu, u = 2 * math.pi, .02, .5
    vel = [f"{u}*(sin(2*pi*z) + cos(2*pi*y))", f"{u}*(sin(2*pi*x) + cos(2*pi*z))", f"{u}*(sin(2*pi*y) + cos(2*pi*x))"]
    # Beltrami: p = -rho v^2/2 and a constant; mean of v^2 is 3 u^2
    squares = " + ".join(f"({v})^2" for v in vel)
    scene = BOX.format(dimensions=3, dx=1 / n, size=[1, 1, 1], axes='["x", "y", "z"]', viscosity=nu, sound=15., perturb=.2,
                       velocity=vel, pressure=f'"-0.5*({squares} - {3 * u * u})"', end=1., speed=1.5, more="", every=.1)
    frames, seconds = run(scene, [], "fluid")
    f = frames[-1]
    x = k * f.x
    decay = u * math.exp(-nu * k * k)
    exact = decay * numpy.column_stack([numpy.sin(x[:, 2]) + numpy.cos(x[:, 1]), numpy.sin(x[:, 0]) + numpy.cos(x[:, 2]),
                                        numpy.sin(x[:, 1]) + numpy.cos(x[:, 0])])
    error = numpy.linalg.norm(f["velocity"] - exact, axis=1).sum() / numpy.linalg.norm(exact, axis=1).sum()
    energy = [.5 * math.log((g["velocity"] ** 2).sum(axis=1).mean()) for g in frames]
    rate = numpy.polyfit([g.time for g in frames], energy, 1)[0] / (-nu * k * k) - 1
    report("ABC flow", "consistent", n, "L1 of the vector at t = 1", error, 5 / n**2, seconds)
    report("ABC flow", "consistent", n, "error of the decay rate", abs(rate), 5 / n**2, seconds)
    return error, rate, seconds


# ---- Taylor-Green: cost, and a higher Reynolds number ----------------------------------------------------------------

def vortices(n, overrides, re=100):
    """One run to t = 1: L1 of the speed, L1 of the vector, the last frame, user CPU seconds."""
    frames, seconds = run("taylor_green", [f"spacing={1 / n!r}", "output.every=1", f"phases.fluid.viscosity={1 / re!r}"] + overrides)
    f = frames[-1]
    x = 2 * numpy.pi * f.x
    decay = math.exp(-8 * math.pi**2 / re)
    exact = decay * numpy.column_stack([-numpy.cos(x[:, 0]) * numpy.sin(x[:, 1]), numpy.sin(x[:, 0]) * numpy.cos(x[:, 1])])
    speed, exact_speed = numpy.hypot(*f["velocity"][:, :2].T), numpy.hypot(*exact.T)
    vector = numpy.hypot(*(f["velocity"][:, :2] - exact).T)
    return abs(speed - exact_speed).sum() / exact_speed.sum(), vector.sum() / exact_speed.sum(), f, seconds


def rising(n):
    """A sound speed that grows with the resolution; see taylor_green."""
    return f"phases.fluid.sound-speed={10 * max(n, 50) / 50:g}"


def cost():
    """Error at equal user CPU time: the consistent scheme, its sound speed rising with the resolution, against the plain scheme."""
    schemes = {"plain, 3.0 dx": lambda n: ["phases.fluid.scheme=plain", "interactions.fluid-fluid=3.0"],
               "plain, 4.0 dx": lambda n: ["phases.fluid.scheme=plain", "interactions.fluid-fluid=4.0"],
               "consistent, 2.6 dx, c = 10": lambda n: ["interactions.fluid-fluid=2.6"],
               "consistent, 2.6 dx, c rising": lambda n: ["interactions.fluid-fluid=2.6", rising(n)],
               "consistent, 2.1 dx, c rising": lambda n: ["interactions.fluid-fluid=2.1", rising(n)],
               "consistent, 2.1 dx, c rising from 20": lambda n: ["interactions.fluid-fluid=2.1", f"phases.fluid.sound-speed={20 * max(n, 50) / 50:g}"]}
    points = {}
    for scheme, overrides in schemes.items():
        previous = None
        largest = min(options.largest, 100 if scheme.endswith("from 20") else 200)  # c = 80 at 200 takes minutes
        for n in [n for n in (25, 50, 100, 200) if n <= largest]:
            e, _, _, seconds = vortices(n, overrides(n))
            report("Taylor-Green, Re 100", scheme, n, "L1(t=1)", e, None, seconds)
            if previous:
                report("Taylor-Green, Re 100", scheme, n, f"order from {n // 2}", math.log2(previous / e), None, 0)
            previous = e
            points.setdefault(scheme, []).append((math.log(seconds), math.log(e)))
    plain, ours = (numpy.array(points[k]) for k in ("plain, 3.0 dx", "consistent, 2.1 dx, c rising"))
    low, high = max(plain[0, 0], ours[0, 0]), min(plain[-1, 0], ours[-1, 0])
    at = numpy.linspace(low, high, 50)
    factor = numpy.exp(numpy.interp(at, *plain.T) - numpy.interp(at, *ours.T))
    span = f"{math.exp(low):.2g} to {math.exp(high):.2g} s"
    report("Taylor-Green, Re 100", "plain 3.0/consistent", "", f"error at equal time, least over {span}", factor.min(), 5, 0, True)
    report("Taylor-Green, Re 100", "plain 3.0/consistent", "", f"error at equal time, mean over {span}",
           math.exp(numpy.log(factor).mean()), 5, 0, True)


def taylor_green_1000(n=100):
    """Ten times less friction: the error, and whether particles clump."""
    e, _, f, seconds = vortices(n, [rising(n)], re=1000)
    kernel = lambda r: 7 / math.pi / 2.6**2 * (1 - r / 2.6) ** 4 * (4 * r / 2.6 + 1)  # Wendland C2, lengths in spacings
    nearest, density = [], []
    for one in f.x[:, :2]:
        r = n * numpy.hypot(*((f.x[:, :2] - one + .5) % 1 - .5).T)
        r = r[r < 2.6]
        nearest.append(numpy.partition(r, 1)[1])  # the smallest is its own
        density.append(kernel(r).sum())
    nearest, density = numpy.array(nearest), numpy.array(density)
    name = "Taylor-Green, Re 1000"
    report(name, "consistent", n, "L1(t=1)", e, .01, seconds)
    report(name, "consistent", n, "least distance of neighbours/dx", nearest.min(), .5, seconds, True)
    report(name, "consistent", n, "spread of the number density", density.std() / density.mean(), .02, seconds)


# ---- without friction, and almost without -------------------------------------------------------------------------------

def gresho_velocity(x):
    d = x[:, :2] - .5
    r = numpy.maximum(numpy.hypot(d[:, 0], d[:, 1]), 1e-12)
    turn = numpy.where(r < .2, 5, numpy.where(r < .4, 2 / r - 5, 0))
    return numpy.column_stack([-d[:, 1] * turn, d[:, 0] * turn])


def box_velocity(x):
    a, b = math.pi * x[:, 0], math.pi * x[:, 1]
    return numpy.column_stack([numpy.sin(a) * numpy.cos(b), -numpy.cos(a) * numpy.sin(b)])


def green_velocity(x):
    a, b = 2 * math.pi * x[:, 0], 2 * math.pi * x[:, 1]
    return math.exp(-8 * math.pi**2 * 1e-4) * numpy.column_stack([-numpy.cos(a) * numpy.sin(b), numpy.sin(a) * numpy.cos(b)])


def turning(f):
    """Angular momentum about the middle of the unit square, of particles of equal mass."""
    return ((f.x[:, 0] - .5) * f["velocity"][:, 1] - (f.x[:, 1] - .5) * f["velocity"][:, 0]).sum()


def steady(name, scene, exact, bounds, overrides=(), turns=True):
    """A flow that does not change, or hardly: L1 of the vector at the end, mean of two seeds (one at 200), and its angular momentum."""
    previous = None
    for n in [n for n in (25, 50, 100, 200) if n <= options.largest]:
        errors, gains, total = [], [], 0
        for seed in (1, 2) if n < 200 else (1,):
            frames, seconds = run(scene, [f"spacing={1 / n!r}", f"fill.{'1' if scene == 'vortex_box' else '0'}.seed={seed}", rising(n), *overrides], "fluid")
            f, truth, total = frames[-1], exact(frames[-1].x), total + seconds
            errors.append(numpy.linalg.norm(f["velocity"][:, :2] - truth, axis=1).sum() / numpy.linalg.norm(truth, axis=1).sum())
            gains.append(turning(f) / turning(frames[0]) - 1 if turns else 0)
        error = numpy.mean(errors)
        report(name, "consistent", n, "L1 of the vector at the end", error, bounds.get(n), total)
        if previous:
            report(name, "consistent", n, f"order from {n // 2}", math.log2(previous / error), None, 0)
        if turns:
            report(name, "consistent", n, "largest change of the angular momentum", max(map(abs, gains)), None, 0)
        previous = error


def whole_fluids():
    """Bounds: 1.02 times the errors of the consistent scheme before it had a treatment of surfaces and voids (commit 142972c)."""
    steady("Gresho's vortex", "gresho", gresho_velocity, {25: .0642, 50: .0179, 100: .00612, 200: .00223})
    steady("vortex in a box", "vortex_box", box_velocity, {25: .0134, 50: .00442, 100: .00179})
    steady("Taylor-Green, Re 10000", "taylor_green", green_velocity, {25: .0535, 50: .00833, 100: .00189},
           ["phases.fluid.viscosity=1e-4"], False)


# ---- 3D against 2D ---------------------------------------------------------------------------------------------------

def abc_against_taylor_green():
    """The ABC flow and the Taylor-Green vortices decay by the same factor to t = 1; the 3D error, vector L1, at the same spacing."""
    for n in [n for n in (16, 32, 48) if n <= options.largest]:
        error, rate, seconds = abc(n)
        flat = vortices(n, ["phases.fluid.sound-speed=10"])[1]
        report("ABC flow", "consistent", n, "L1 of the vector/that of Taylor-Green in 2D", error / flat, 1.5, seconds)


CASES = {
    "taylor-green": (taylor_green, "Taylor-Green vortices, Re 100, sound speed rising with the resolution (Taylor & Green 1937)"),
    "cost": (cost, "Run time against error: Taylor-Green vortices, Re 100, to t = 1 on one thread"),
    "taylor-green-1000": (taylor_green_1000, "Taylor-Green vortices, Re 1000"),
    "whole-fluids": (whole_fluids, "Enclosed flows without friction or almost: Gresho's vortex, a vortex in a box, Taylor-Green vortices at Re 10000"),
    "abc": (abc_against_taylor_green, "Arnold-Beltrami-Childress flow, 3D, Re 50"),
    "waves": (lambda: [waves(n) for n in (20, 40)], "Sound and shear waves against the lattice's own amplification"),
}
