#!/usr/bin/python3
"""Air against exact and converged solutions: one function a case, one line a figure.

    /usr/bin/python3 bench/accuracy/cases.py build/barchan [CASE ...] [--largest N] [--set KEY=VALUE ...]

Runs each case (all of them without a name; --list names them) on one thread with disturbed particles, and prints case, scheme,
number of spacings, what was measured, its bound and the user CPU seconds. Exits with 1 when a figure misses its bound.
"""

import argparse
import math
import pathlib
import resource
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes/verification"
options = None
missed = 0


class Frame:
    """One frame of a series: positions and arrays, of the phase with this name or of all."""

    def __init__(self, path, time, phase=None):
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(str(path))
        reader.Update()
        data = reader.GetOutput()
        arrays = data.GetPointData()
        self.time = time
        self.x = vtk_to_numpy(data.GetPoints().GetData())
        self.arrays = {arrays.GetArrayName(k): vtk_to_numpy(arrays.GetArray(k)) for k in range(arrays.GetNumberOfArrays())}
        if phase is not None:
            names = data.GetFieldData().GetAbstractArray("phase_names")
            number = [names.GetValue(k) for k in range(names.GetNumberOfValues())].index(phase)
            keep = self.arrays["phase"] == number
            self.x = self.x[keep]
            self.arrays = {name: values[keep] for name, values in self.arrays.items()}

    def __getitem__(self, name):
        return self.arrays[name]


def run(scene, overrides, phase=None, last=None, keep=lambda t: True):
    """Runs a scene (a file's name or its text); returns the frames that `keep` takes and the user CPU seconds."""
    with tempfile.TemporaryDirectory() as out:
        out = pathlib.Path(out)
        if "\n" in scene:
            path = out / "case.toml"
            path.write_text(scene)
        else:
            path = SCENES / f"{scene}.toml"
        command = [options.program, "run", str(path), "--threads", "1", "--quiet", "--out", str(out)]
        for o in list(overrides) + options.set:
            command += ["--set", o]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(command, capture_output=True, text=True)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        if done.returncode != 0:
            print(done.stderr, file=sys.stderr)
            raise RuntimeError(f"{path.name} ended with status {done.returncode}")
        entries = [(float(e.get("timestep")), e.get("file"))
                   for e in ElementTree.parse(out / f"{path.stem}.pvd").getroot().iter("DataSet")]
        if last:
            entries = entries[-last:]
        return [Frame(out / file, t, phase) for t, file in entries if keep(t)], seconds


def report(case, scheme, n, what, value, bound, seconds, at_least=False):
    global missed
    good = value >= bound if at_least else value <= bound
    missed += not good
    print(f"| {case} | {scheme} | {n} | {what} | {value:.3g} | {'>=' if at_least else '<='} {bound:g} | "
          f"{'' if good else 'MISSED'} | {seconds:.1f} |", flush=True)


def tell(case, scheme, n, what, value, beside, seconds):
    """A figure without a bound, with what others found."""
    print(f"| {case} | {scheme} | {n} | {what} | {value} | {beside} | | {seconds:.1f} |", flush=True)


def local_fit(x, values, at, radius):
    """Moving least squares, linear, Wendland C2 weights: the field at `at`."""
    d = x[:, :2] - numpy.asarray(at)
    q = numpy.hypot(d[:, 0], d[:, 1]) / radius
    near = q < 1
    d, q = d[near], q[near]
    w = (1 - q) ** 4 * (4 * q + 1)
    basis = numpy.column_stack([numpy.ones(len(d)), d])
    return numpy.linalg.solve((basis * w[:, None]).T @ basis, (basis * w[:, None]).T @ values[near])[0]


# ---- lid-driven cavity -----------------------------------------------------------------------------------------------

CAVITY_U = {.9766: .84347, .9688: .79159, .9609: .74069, .9531: .69117, .8516: .23643, .7344: .00415, .6172: -.13881, .5: -.20914,
            .4531: -.21397, .2813: -.15764, .1719: -.10172, .1016: -.06441, .0703: -.04662, .0625: -.04197, .0547: -.03722}
CAVITY_V = {.9688: -.06229, .9609: -.07790, .9531: -.09334, .9453: -.10851, .9063: -.17715, .8594: -.23371, .8047: -.25353,
            .5: .05754, .2344: .17955, .2266: .17935, .1563: .16480, .0938: .12638, .0781: .11177, .0703: .10359, .0625: .09480}


def cavity(n):
    """Largest error of u on the vertical and v on the horizontal centre line, mean of the last ten frames (5 s)."""
    frames, seconds = run("cavity", [f"spacing={1 / n!r}"], "fluid", last=10)
    exact = lambda s: round(s * 128) / 128  # the table's points are multiples of 1/128
    errors = {}
    for name, table, place, component in (("u", CAVITY_U, lambda s: (0.5, s), 0), ("v", CAVITY_V, lambda s: (s, 0.5), 1)):
        for s, value in table.items():
            got = numpy.mean([local_fit(f.x, f["velocity"][:, component], place(exact(s)), 2.6 / n) for f in frames])
            errors[f"{name}({s})"] = got - value
    if options.verbose:
        print({k: round(float(e), 4) for k, e in errors.items()})
    worst = max(errors, key=lambda k: abs(errors[k]))
    report("cavity, Re 100", "consistent", n, f"largest error, {worst}", abs(errors[worst]), .01 if n < 100 else .004, seconds)


# ---- channels --------------------------------------------------------------------------------------------------------

MOMENTS = (.0225, .045, .1125, .225, .45, 1.0)


def poiseuille_series(s, t):
    u = 4 * s * (1 - s)
    for n in range(1, 400, 2):
        u -= 32 / (n * math.pi) ** 3 * numpy.sin(n * math.pi * s) * math.exp(-n * n * math.pi**2 * t)
    return u


def couette_series(s, t):
    u = s.copy()
    for n in range(1, 400):
        u += 2 / (n * math.pi) * (-1) ** n * numpy.sin(n * math.pi * s) * math.exp(-n * n * math.pi**2 * t)
    return u


def channel(name, fill, exact, n):
    frames, seconds = run(name, [f"spacing={1e-3 / n!r}", f"fill.{fill}.perturb=0.2", "output.every=0.0225",
                                 f"domain.size=[{16 * 1e-3 / n!r}, 1e-3]", "time.end=1.0125"], "water")
    worst = {}
    for t in MOMENTS:
        f = min(frames, key=lambda f: abs(f.time - t))
        s = f.x[:, 1] / 1e-3
        worst[t] = abs(f["velocity"][:, 0] / 1.25e-5 - exact(s, f.time)).max()
    t = max(worst, key=worst.get)
    report(name, "consistent", n, f"largest error/u_max, at t* = {t}", worst[t], .005 if n < 50 else .0015, seconds)


def poiseuille(n):
    channel("poiseuille", 1, poiseuille_series, n)


def couette(n):
    channel("couette", 2, couette_series, n)


# ---- Taylor-Green ----------------------------------------------------------------------------------------------------

def taylor_green(sizes=(50, 100, 200)):
    """L1 of the speed at t = 1 and the decay rate of the kinetic energy's root, mean of two seeds.

    The exact solution is incompressible: at a fixed sound speed the error ends at the square of the Mach number, so the sound speed
    grows with the resolution, 10 U at 50 spacings, 20 U at 100, 40 U at 200."""
    errors = {}
    for n in [n for n in sizes if n <= options.largest]:
        e, rate, total = [], [], 0
        for seed in (1, 2):
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


# ---- logarithmic layer -----------------------------------------------------------------------------------------------

def logarithmic_layer(friction_velocity, n=40):
    """Profile by rows of one spacing, wall stress and pressure noise over the second half of the run."""
    height, z0, rho, kappa = .1, 1e-4, 1.225, .4
    dx, us = height / n, friction_velocity
    law = lambda y: us / kappa * numpy.log(y / z0)
    top = law(height)
    frames, seconds = run("logarithmic_layer", [
        f"spacing={dx!r}", f"domain.size=[{20 * dx!r}, {height}]", f"phases.air.sound-speed={10 * top!r}",
        f"time.largest-speed={top!r}", f"phases.lid.shear-stress=[{rho * us**2!r}, 0]",
        f"fill.2.velocity.log-profile.friction-velocity={us}"], "air", keep=lambda t: t > 1)
    error, weight, stress, noise, first = numpy.zeros(n), numpy.zeros(n), [], [], None
    for f in frames:
        y, u = f.x[:, 1], f["velocity"][:, 0]
        row = numpy.clip((y / dx).astype(int), 0, n - 1)
        numpy.add.at(error, row, u / law(y) - 1)
        numpy.add.at(weight, row, 1)
        near = y < dx
        stress.append((rho * (kappa * u[near] / numpy.log(y[near] / z0)) ** 2).mean())
        noise.append((f["pressure"] ** 2).mean() - f["pressure"].mean() ** 2)
    error /= weight
    # the momentum of the air per area of ground (mass per metre of depth over length) changes by what the walls leave
    def momentum(f):
        return rho * height * f["velocity"][:, 0].mean()
    loss = (momentum(frames[0]) - momentum(frames[-1])) / (frames[-1].time - frames[0].time)
    name = f"logarithmic layer, u* = {us}"
    if options.verbose:
        print(numpy.round(100 * error, 2))
    report(name, "consistent", n, "profile above row 2", abs(error[2:]).max(), .01, seconds)
    report(name, "consistent", n, "profile in rows 1, 2", abs(error[:2]).max(), .05, seconds)
    report(name, "consistent", n, "wall stress of the law/rho u*2 - 1", abs(numpy.mean(stress) / (rho * us**2) - 1), .02, seconds)
    report(name, "consistent", n, "stress from the momentum budget", abs(loss / (rho * us**2)), .02, seconds)
    report(name, "consistent", n, "pressure noise/rho U2", math.sqrt(numpy.mean(noise)) / (rho * top**2), .003, seconds)


# ---- hills -----------------------------------------------------------------------------------------------------------

def potential_flow(length, height, h, slope, modes):
    """Ideal flow of mean velocity 1 along a flat lid at y = height over a periodic hill y = h(x), even about length/2: (u, v) of x, y.

    Harmonic functions that satisfy lid and period, sin k(x - length/2) cosh k(height - y), collocated on the ground, least squares."""
    k = 2 * math.pi * numpy.arange(1, modes + 1) / length
    def basis(x, y):
        x, y = numpy.atleast_1d(x) - length / 2, numpy.atleast_1d(y)
        down, up = numpy.exp(-numpy.outer(y, k)), numpy.exp(-numpy.outer(2 * height - y, k))
        return numpy.cos(numpy.outer(x, k)) * (down + up), -numpy.sin(numpy.outer(x, k)) * (down - up)
    x = numpy.linspace(0, length, 8 * modes + 1)[1:-1]
    (u, v), s = basis(x, h(x)), slope(x)
    c, _, _, _ = numpy.linalg.lstsq(v - s[:, None] * u, s, rcond=None)
    return lambda x, y: numpy.array([1 + basis(x, y)[0] @ c, basis(x, y)[1] @ c])


def low_hill(n):
    """Speed-up at the crest and slow-down at the foot (mean of both sides) against potential flow, means of the last 1.5 s."""
    length, height, middle, foot = 20., 5., 10., 1.7
    h = lambda x: .1 / (1 + (x - middle) ** 2)
    exact = potential_flow(length, height, h, lambda x: -.2 * (x - middle) / (1 + (x - middle) ** 2) ** 2, 300)
    frames, seconds = run("low_hill", [f"spacing={1 / n!r}"], "air", keep=lambda t: t > 6.5)
    for over in (0, .1):
        def relative(u):
            return {name: numpy.mean([u(middle + s) for s in places]) / u(1e-3) - 1
                    for name, places in (("speed-up at the crest", [0]), ("slow-down at the foot", [-foot, foot]))}
        true = relative(lambda x: exact(x, h(x) + over)[0, 0])
        got = relative(lambda x: numpy.mean([local_fit(f.x, f["velocity"][:, 0], (x, h(x) + over), 2.6 / n) for f in frames]))
        for name in true:
            if options.verbose:
                print(name, over, true[name], got[name])
            where = "on the ground" if over == 0 else f"{over} L above it"
            report("low hill, H/L = 0.1", "consistent", n, f"{name}, {where}, error/itself", abs(got[name] / true[name] - 1), .05, seconds)
    f = frames[-1]
    error = f["velocity"][:, :2].T - exact(f.x[:, 0], f.x[:, 1])
    report("low hill, H/L = 0.1", "consistent", n, "rms error of the velocity/U", math.sqrt((error**2).sum(axis=0).mean()), .001, seconds)


RUSHIL = {3: (1.17, "separates, back at 6.5 H"), 5: (.684, "about to separate"), 8: (.421, "attached")}  # 2 H/L; Khurshudyan et al. 1981


def rushil(ratio, n=8, overrides=(), crest=2.106):
    """Speed-up at the crest and the flow behind it, means from 0.5 s on; a table without bounds."""
    height, dx = .117, .117 / n
    a = ratio * height
    m = height / a + math.hypot(height / a, 1)
    t = numpy.linspace(0, a, 20001)
    share = a * a / (t * t + m * m * (a * a - t * t))
    profile = .5 * t * (1 + share), .5 * m * numpy.sqrt(a * a - t * t) * (1 - share)
    ground = lambda s: numpy.interp(abs(s), *profile, right=0.)
    frames, seconds = run("rushil", [f"fill.0.shape.dune.length={2 * a!r}", f"spacing={dx!r}", *overrides], "air", keep=lambda t: t > .5)
    def speed(s, z):
        near = [abs(f.x[:, 0] - crest - s) < 2.6 * dx for f in frames]
        return numpy.mean([local_fit(f.x[k], f["velocity"][k, 0], (crest + s, ground(s) + z), 2.6 * dx) for f, k in zip(frames, near)])
    name, rule, seen = f"RUSHIL, a/H = {ratio}", *RUSHIL[ratio]
    far = -a - 6 * height
    for z in (height / 6, height / 2, height):
        tell(name, "mixing length", n, f"speed-up at the crest, z = {z / height:.2g} H", f"{speed(0, z) / speed(far, z) - 1:.3f}",
             f"2 H/L = {rule}", seconds)
    s = numpy.arange(0, 12, .25) * height
    u = numpy.array([speed(x, .5 * dx) for x in s])
    if options.verbose:
        print(numpy.column_stack([s / height, u]).round(2).tolist())
    back = s[u < 0] / height
    tell(name, "mixing length", n, "reversed flow behind the crest, z = dx/2", f"{back[0]:.2f} to {back[-1]:.2f} H" if len(back) else "none", seen, seconds)
    tell(name, "mixing length", n, "least speed behind the crest, z = dx/2, over upstream",
         f"{u.min() / speed(far, .5 * dx):.2f} at {s[u.argmin()] / height:.2f} H", "", seconds)


def rushil_fine():
    """The steepest hill with twelve spacings in its height, in a shorter and lower domain."""
    rushil(3, 12, ["domain.size=[3.9, 0.702]", "fill.0.shape.dune.at=1.3", "time.end=0.7"], 1.3)


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


CASES = {"cavity": lambda: [cavity(n) for n in (50, 100) if n <= options.largest],
         "poiseuille": lambda: [poiseuille(n) for n in (25, 50)],
         "couette": lambda: [couette(n) for n in (25, 50)],
         "taylor-green": taylor_green,
         "waves": lambda: [waves(n) for n in (20, 40)],
         "abc": lambda: [abc(n) for n in (16, 32)],
         "low-hill": lambda: [low_hill(n) for n in (10, 20)],
         "rushil": lambda: [*(rushil(ratio) for ratio in RUSHIL), rushil_fine()],
         "logarithmic-layer": lambda: [logarithmic_layer(us) for us in (.2, .4, .8)]}


def main():
    global options
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("cases", nargs="*", metavar="CASE")
    parser.add_argument("--largest", type=int, default=200)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    if options.list:
        print("\n".join(CASES))
        return 0
    print("| case | scheme | N | figure | measured | bound | | user CPU s |\n| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name in options.cases or CASES:
        CASES[name]()
    return missed > 0


if __name__ == "__main__":
    sys.exit(main())
