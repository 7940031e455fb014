#!/usr/bin/python3
"""Air against exact, converged and measured solutions: one function a case, one line a figure.

    /usr/bin/python3 bench/accuracy/cases.py build/barchan [all | CASE ...] [--write] [--largest N] [--set KEY=VALUE ...]

Runs each case (all of them without a name; --list names them) on one thread with disturbed particles, and prints case, scheme,
number of spacings, what was measured, its bound, the user CPU seconds and the particle-steps a user CPU second. Exits with 1 when a
figure misses its bound.

With --write the figures go to bench/accuracy/results/CASE.json, and docs/accuracy.md and docs/gallery/accuracy.png are written
again from all that is there; `cases.py none --write` only does the latter. --runs DIR keeps the runs in DIR and takes those that
are there already. A new case is one more line in CASES.
"""

import argparse
import hashlib
import json
import math
import pathlib
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

import numpy
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENES = ROOT / "scenes/verification"
RESULTS = pathlib.Path(__file__).resolve().parent / "results"
options = None
rows = []  # what the case in hand has reported


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
        names = data.GetFieldData().GetAbstractArray("phase_names")
        self.names = [names.GetValue(k) for k in range(names.GetNumberOfValues())]
        if phase is not None:
            keep = self.arrays["phase"] == self.names.index(phase)
            self.x = self.x[keep]
            self.arrays = {name: values[keep] for name, values in self.arrays.items()}

    def __getitem__(self, name):
        return self.arrays[name]


class Seconds(float):
    """User CPU seconds, and the particle-steps done in them."""
    work = 0.0

    def __add__(self, other):
        total = Seconds(float(self) + float(other))
        total.work = self.work + getattr(other, "work", 0.0)
        return total

    __radd__ = __add__


def run_into(out, scene, overrides):
    """Runs a scene (a file's name or its text) into `out`, unless it is there; returns the series' name and the user CPU seconds."""
    places = SCENES / f"{scene}.toml", ROOT / f"scenes/{scene}.toml"
    path = out / "case.toml" if "\n" in scene else next(p for p in places if p.exists())
    report_file = out / "run.json"
    if report_file.exists():
        user = json.loads(report_file.read_text())["cpu_seconds"]
    else:
        out.mkdir(parents=True, exist_ok=True)
        if "\n" in scene:
            path.write_text(scene)
        command = [options.program, "run", str(path), "--threads", "1", "--quiet", "--out", str(out)]
        for o in overrides:
            command += ["--set", o]
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(command, capture_output=True, text=True)
        user = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        if done.returncode != 0:
            print(done.stderr, file=sys.stderr)
            shutil.rmtree(out)
            raise RuntimeError(f"{path.name} ended with status {done.returncode}: {done.stderr.strip()[:300]}")
    summary = json.loads(report_file.read_text())
    seconds = Seconds(user)
    seconds.work = float(summary["steps"]) * sum(summary["particles"].values())
    return path.stem, seconds


def run(scene, overrides, phase=None, last=None, keep=lambda t: True, files=()):
    """Runs a scene; returns the frames that `keep` takes and the user CPU seconds. With `files`, tables of the run (dictionaries of
    columns) instead of frames."""
    overrides = list(overrides) + options.set
    with tempfile.TemporaryDirectory() as scratch:
        out = pathlib.Path(scratch) / "run"
        if options.runs:
            text = scene if "\n" in scene else scene + " " + " ".join(overrides)
            out = pathlib.Path(options.runs) / hashlib.sha1(text.encode()).hexdigest()[:12]
        name, seconds = run_into(out, scene, overrides)
        if files:
            return [table(out / file) for file in files], seconds
        entries = [(float(e.get("timestep")), e.get("file"))
                   for e in ElementTree.parse(out / f"{name}.pvd").getroot().iter("DataSet")]
        if last:
            entries = entries[-last:]
        return [Frame(out / file, t, phase) for t, file in entries if keep(t)], seconds


def table(path):
    names = path.open().readline().strip().split(",")
    return dict(zip(names, numpy.loadtxt(path, delimiter=",", skiprows=1, unpack=True, ndmin=2)))


HEAD = "| case | scheme | N | figure | measured | bound | | user CPU s | particle-steps/s |\n" + "| --- " * 9 + "|"


def line(r):
    rate = f"{r['rate'] / 1e6:.2f} M" if r["rate"] else ""
    bound = r["bound"] if r["bound"] is not None else ""
    if isinstance(bound, float | int):
        bound = f"{'>=' if r['at_least'] else '<='} {bound:g}"
    value = r["value"] if isinstance(r["value"], str) else f"{r['value']:.3g}"
    time = f"{r['seconds']:.1f}" if r["seconds"] else ""
    return (f"| {r['case']} | {r['scheme']} | {r['n']} | {r['what']} | {value} | {bound} | {'' if r['good'] else 'MISSED'} | "
            f"{time} | {rate} |")


def report(case, scheme, n, what, value, bound, seconds, at_least=False):
    """One figure. A bound of None: nothing is asked of it."""
    good = bound is None or bool(value >= bound if at_least else value <= bound)
    rate = seconds.work / seconds if isinstance(seconds, Seconds) and seconds > 0 else None
    rows.append({"case": case, "scheme": scheme, "n": n, "what": what, "value": float(value), "bound": bound, "at_least": at_least,
                 "good": good, "seconds": round(float(seconds), 2), "rate": rate})
    print(line(rows[-1]), flush=True)


def tell(case, scheme, n, what, value, beside, seconds):
    """A figure in words, without a bound, with what others found."""
    rows.append({"case": case, "scheme": scheme, "n": n, "what": what, "value": str(value), "bound": beside, "good": True,
                 "seconds": round(float(seconds), 2), "rate": None})
    print(line(rows[-1]), flush=True)


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
    frames, seconds = run(name, [f"spacing={1e-3 / n!r}", f"fill.{fill}.perturb=0.2", "output.every=0.0225", "time.end=1.0125"], "water")
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


# ---- backward-facing step --------------------------------------------------------------------------------------------

# x_r/S by Re at expansion ratio 2 (Erturk 2008); Armaly et al. 1983 measured 3 and 5 at Re 100 and 200 with a ratio of 1.94.
STEP = {100: 2.922, 200: 4.982, 300: 6.751}


def backward_step(re):
    """Reattachment against the literature at the Reynolds number that the flow has."""
    overrides = [] if re == 200 else [f"phases.fluid.viscosity={2 / re!r}", "forcing.0.acceleration=[0.138, 0]"]
    (narrow, floor), seconds = run("backward_step", overrides, files=("profile_narrow.csv", "wall_shear_floor.csv"))
    u, y = narrow["velocity_mean_x [m/s]"], narrow["y [m]"] - 1
    mean = ((u[1:] + u[:-1]) / 2 * numpy.diff(y)).sum()
    real = 2 * mean / (2 / re)
    x, tau = floor["x [m]"] - 12, floor["shear_stress_mean_x [Pa]"]
    x, tau = x[x > .3], tau[x > .3]  # behind the eddy in the corner
    k = numpy.flatnonzero((tau[:-1] < 0) & (tau[1:] >= 0))[0]
    reattachment = x[k] + (x[k + 1] - x[k]) * tau[k] / (tau[k] - tau[k + 1])
    literature = numpy.polyval(numpy.polyfit(list(STEP), list(STEP.values()), 2), real)
    name = f"backward step, Re {re}"
    report(name, "consistent", 16, "Re of the flow", real, None, seconds)
    report(name, "consistent", 16, "profile at the step, largest error/U", abs(u - 6 * mean * y * (1 - y)).max() / mean, None, seconds)
    report(name, "consistent", 16, "x_r/S", reattachment, None, seconds)
    report(name, "consistent", 16, f"against {literature:.2f} (Erturk 2008), relative", abs(reattachment / literature - 1), .08, seconds)


# ---- two fluids at rest ----------------------------------------------------------------------------------------------

def two_phase_column(ratio, perturb):
    """Air over water for ten crossings of sound: largest speed of any particle, largest error of the pressure."""
    g, height, air, c = 9.81, .1, 1.225, 20.
    water = ratio * air
    frames, seconds = run("two_phase_column", [f"phases.water.density={water!r}", f"fill.1.perturb={perturb}", f"fill.2.perturb={perturb}"])
    number = {name: k for k, name in enumerate(frames[0].names)}

    def pressure(depth, density, surface):
        return surface + (density * c * c + surface) * numpy.expm1(g * depth / (c * c))
    middle = pressure(height / 2, air, 0.)
    bottom = pressure(height / 2, water, middle)
    speed, errors = 0., {"water": 0., "air": 0.}
    for f in frames:
        y = f.x[:, 1]
        exact = {"water": pressure(height / 2 - y, water, middle), "air": pressure(height - y, air, 0.)}
        for name in errors:
            of = f["phase"] == number[name]
            speed = max(speed, numpy.linalg.norm(f["velocity"][of], axis=1).max() / math.sqrt(g * height))
            errors[name] = max(errors[name], abs(f["pressure"] - exact[name])[of].max())
    name = f"air over water 1:{ratio}, {'disturbed' if perturb else 'lattice'}"
    report(name, "consistent", 50, "largest speed/sqrt(gH)", speed, 1e-3, seconds)
    report(name, "consistent", 50, "pressure of the water/that at the bottom", errors["water"] / bottom, 5e-3, seconds)
    report(name, "consistent", 50, "pressure of the air/weight of the air", errors["air"] / middle, 5e-3, seconds)


# ---- a bed without wind ----------------------------------------------------------------------------------------------

def bed_at_rest(turbulence):
    """The farthest way of a grain of scenes/flat_bed.toml in 0.2 s without wind."""
    overrides = ["fill.3.velocity.log-profile.friction-velocity=0", "time.end=0.2", "output.every=0.001"]
    if turbulence != "none":
        overrides.append(f"phases.air.turbulence={turbulence}")
    frames, seconds = run("flat_bed", overrides, "sand")
    order = [numpy.argsort(f["id"]) for f in frames]
    start, farthest = frames[0].x[order[0]], 0
    for f, k in zip(frames, order):
        way = f.x[k] - start
        way[:, 0] -= .06 * numpy.round(way[:, 0] / .06)
        farthest = max(farthest, numpy.linalg.norm(way, axis=1).max() / 5e-4)
    name = f"bed at rest, {'laminar' if turbulence == 'none' else turbulence} air"
    report(name, "consistent", 120, "farthest way of a grain/d in 0.2 s, every ms", farthest, 1e-3, seconds)
    report(name, "consistent", 120, "fastest grain at the end, m/s", numpy.linalg.norm(frames[-1]["velocity"], axis=1).max(), None, seconds)


# ---- 3D against 2D ---------------------------------------------------------------------------------------------------

def abc_against_taylor_green():
    """The ABC flow and the Taylor-Green vortices decay by the same factor to t = 1; the 3D error, vector L1, at the same spacing."""
    for n in [n for n in (16, 32, 48) if n <= options.largest]:
        error, rate, seconds = abc(n)
        flat = vortices(n, ["phases.fluid.sound-speed=10"])[1]
        report("ABC flow", "consistent", n, "L1 of the vector/that of Taylor-Green in 2D", error / flat, 1.5, seconds)


# name: (function, heading of its table)
CASES = {
    "taylor-green": (taylor_green, "Taylor-Green vortices, Re 100, sound speed rising with the resolution (Taylor & Green 1937)"),
    "cost": (cost, "Run time against error: Taylor-Green vortices, Re 100, to t = 1 on one thread"),
    "taylor-green-1000": (taylor_green_1000, "Taylor-Green vortices, Re 1000"),
    "abc": (abc_against_taylor_green, "Arnold-Beltrami-Childress flow, 3D, Re 50"),
    "waves": (lambda: [waves(n) for n in (20, 40)], "Sound and shear waves against the lattice's own amplification"),
    "poiseuille": (lambda: [poiseuille(n) for n in (25, 50)], "Plane Poiseuille flow from rest (Morris et al. 1997)"),
    "couette": (lambda: [couette(n) for n in (25, 50)], "Plane Couette flow from rest (Morris et al. 1997)"),
    "cavity": (lambda: [cavity(n) for n in (50, 100) if n <= options.largest], "Lid-driven cavity, Re 100 (Ghia et al. 1982)"),
    "backward-step": (lambda: [backward_step(re) for re in (100, 200)],
                      "Backward-facing step, expansion ratio 2 (Armaly et al. 1983; Erturk 2008)"),
    "logarithmic-layer": (lambda: [logarithmic_layer(us) for us in (.2, .4, .8)], "Logarithmic layer over rough ground"),
    "low-hill": (lambda: [low_hill(n) for n in (10, 20)], "Potential flow over a low hill, H/L = 0.1 (Witch of Agnesi)"),
    "rushil": (lambda: [*(rushil(ratio) for ratio in RUSHIL), rushil_fine()], "Turbulent air over the hills of RUSHIL"),
    "two-phase-column": (lambda: [two_phase_column(ratio, p) for ratio in (1000, 2000) for p in (0, .2)],
                         "Air over water at rest, ten crossings of sound"),
    "bed-at-rest": (lambda: [bed_at_rest(t) for t in ("none", "mixing-length")], "A bed of grains without wind"),
}
CASES = {name: case if isinstance(case, tuple) else (case, name.replace("-", " ")) for name, case in CASES.items()}

# L1(t=1) by particles a side: PySPH runs at the settings (h/dx, sound speed) of the schemes' papers, without run times
PEERS = {"EDAC-TVF": {30: .0122, 50: .0090, 70: .0096, 100: .0078}, "TVF": {30: .1182, 50: .0674, 70: .0519, 100: .0393},
         "delta+": {30: .0267, 50: .0266, 70: .0243, 100: .0207}}


# ---- the page --------------------------------------------------------------------------------------------------------

def processor():
    try:
        return next(l.split(":")[1].strip() for l in open("/proc/cpuinfo") if l.startswith("model name"))
    except (OSError, StopIteration):
        return platform.machine()


def plot(points):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as pyplot
    figure, axes = pyplot.subplots(figsize=(8, 5))
    for r in points:
        if r["what"] == "L1(t=1)":
            axes.annotate(str(r["n"]), (r["seconds"], r["value"]), textcoords="offset points", xytext=(4, 4), fontsize=7)
    points = [r for r in points if r["what"] == "L1(t=1)"]
    for scheme in dict.fromkeys(r["scheme"] for r in points):
        axes.loglog(*zip(*[(r["seconds"], r["value"]) for r in points if r["scheme"] == scheme]), "o-", label=scheme)
    for style, (name, values) in zip((":", "--", "-."), PEERS.items()):
        axes.axhline(values[100], color="0.6", linestyle=style, label=f"{name} at 100 x 100 (no time published)")
    axes.set(xlabel="user CPU seconds to t = 1, one thread", ylabel="L1(t = 1)",
             title="Taylor-Green, Re 100, disturbed: run time against error")
    axes.legend(fontsize=8)
    axes.grid(True, which="both", alpha=0.3)
    figure.tight_layout()
    figure.savefig(ROOT / "docs/gallery/accuracy.png", dpi=120)


def write_page():
    """docs/accuracy.md between its markers, and the plot, from all results that are there."""
    tables = []
    for name, (_, heading) in CASES.items():
        tables.append(f"\n## {heading}\n\n`cases.py build/barchan {name}`\n")
        file = RESULTS / f"{name}.json"
        if not file.exists():
            tables.append("Not measured yet.\n")
            continue
        result = json.loads(file.read_text())
        tables.append(HEAD + "\n" + "\n".join(line(r) for r in result["rows"]) + f"\n\nMeasured on {result['processor']}.\n")
        if name == "cost":
            plot(result["rows"])
            tables.append("![run time against error](gallery/accuracy.png)\n")
            tables.append("Peers at the same settings (PySPH runs; L1(t=1) by particles a side):\n")
            tables.append("| peer | 30 | 50 | 70 | 100 |\n| --- | --- | --- | --- | --- |")
            tables += [f"| {peer} | " + " | ".join(f"{e:.4f}" for e in values.values()) + " |" for peer, values in PEERS.items()]
    page = ROOT / "docs/accuracy.md"
    before, begin, rest = page.read_text().partition("<!-- figures: begin -->\n")
    _, end, after = rest.partition("<!-- figures: end -->\n")
    if not begin or not end:
        raise RuntimeError(f"{page} has lost its markers <!-- figures: begin --> and <!-- figures: end -->")
    page.write_text(before + begin + "\n".join(tables) + "\n" + end + after)


def main():
    global options
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("cases", nargs="*", metavar="CASE")
    parser.add_argument("--largest", type=int, default=200)
    parser.add_argument("--set", action="append", default=[])
    parser.add_argument("--runs", metavar="DIR")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if options.list:
        print("\n".join(CASES))
        return 0
    if options.program == "none":
        options.cases = ["none"]
    names = list(CASES) if not options.cases or "all" in options.cases else [c for c in options.cases if c != "none"]
    unknown = [name for name in names if name not in CASES]
    if unknown or not options.program:
        parser.error(f"no case {', '.join(unknown)}; cases are {', '.join(CASES)}" if unknown else "which program?")
    good = True
    print(HEAD)
    for name in names:
        rows.clear()
        CASES[name][0]()
        good = good and all(r["good"] for r in rows)
        if options.write:
            RESULTS.mkdir(exist_ok=True)
            (RESULTS / f"{name}.json").write_text(json.dumps({"processor": processor(), "rows": rows}, indent=1) + "\n")
    if options.write:
        write_page()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
