"""Grains in air of their own spacing: one shot through it, a pile, a bed blown empty. Holes close; the energy is accounted for.

What is closed, from the frames:
  E = kinetic energy of grains and air + potential energy + compression of the air + what touching grains store.
  Friction, integrated over the frames (trapezoids): viscosity by pairs, 2 mu V_a V_b |F| v_ab^2 (air with air, grains and walls; into a
  wall the air's velocity goes on as 2 v - its mean, into a grain of a bed as the grain's own, into a grain alone as its mean), the form
  drag of grains, K V W |v|^3, and what their barrier takes (docs/method.md, Sand). What the diffusion of density and the shifting take
  or give is in neither: it is what the budget finds.
  The shot: E + friction within 1 % of the start at all times. The pile: the same, with contacts that take no energy (restitution 1).
  The blown bed: its contacts and its wind lose what cannot be seen in frames, so E less the work of the forcing that holds the wind may
  only not grow by more than 1 % of its start.
"""

import math

import numpy

from cases_surface import Energy
from harness import attempt, document, report, run, tell

SCHEMES = {"consistent": [], "plain": ["phases.air.scheme=plain"]}


def largest_hole(x, origin, size, spacing, periodic, fine=4, reach=2):
    """Radius of the largest circle without a particle, in spacings, and its middle; circles have their middles on a raster of dx/fine
    in the box, and a larger one than `reach` counts as that. A lattice has 0.71, one with a particle missing 1."""
    step = spacing / fine
    count = numpy.round(numpy.array(size) / step).astype(int)
    best = numpy.full(count, float(reach) ** 2)
    cell = numpy.floor((x[:, :2] - origin) / step).astype(int)
    for i in range(-reach * fine, reach * fine + 1):
        for j in range(-reach * fine, reach * fine + 1):
            at = cell + (i, j)
            square = (((numpy.array(origin) + (at + .5) * step - x[:, :2]) / spacing) ** 2).sum(axis=1)
            near = square < reach**2
            for d in (0, 1):
                if periodic[d]:
                    at[:, d] %= count[d]
                else:
                    near &= (at[:, d] >= 0) & (at[:, d] < count[d])
            numpy.minimum.at(best, tuple(at[near].T), square[near])
    k = numpy.unravel_index(best.argmax(), best.shape)
    return math.sqrt(best[k]), numpy.array(origin) + (numpy.array(k) + .5) * step


def wendland(q, support):
    """W and |F| = |W'|/r in 2D, support radius `support`; q = r/support."""
    inside = numpy.clip(1 - q, 0, None)
    return 7 / (math.pi * support**2) * inside**4 * (4 * q + 1), 140 / (math.pi * support**4) * inside**3


def pairs(a, b, reach, size, periodic):
    """Indices i, j and distances of pairs nearer than `reach` (cells; minimum image along periodic axes)."""
    cells = numpy.maximum((numpy.array(size) / reach).astype(int), 1)
    width = numpy.array(size) / cells
    key = lambda x: numpy.floor(x[:, :2] / width).astype(int)
    bins = {}
    for k, c in enumerate(key(b)):
        c = tuple(c[d] % cells[d] if periodic[d] else c[d] for d in (0, 1))
        bins.setdefault(c, []).append(k)
    first, second = [], []
    for k, c in enumerate(key(a)):
        near = {tuple((c[d] + o) % cells[d] if periodic[d] else c[d] + o for d, o in ((0, p), (1, q)))
                for p in (-1, 0, 1) for q in (-1, 0, 1)}
        found = [j for n in near for j in bins.get(n, ())]
        first += [k] * len(found)
        second += found
    i, j = numpy.array(first, int), numpy.array(second, int)
    d = a[i, :2] - b[j, :2]
    for axis in (0, 1):
        if periodic[axis]:
            d[:, axis] -= size[axis] * numpy.round(d[:, axis] / size[axis])
    r = numpy.hypot(*d.T)
    keep = (r < reach) & (r > 0)
    return i[keep], j[keep], r[keep]


class Budget:
    """Energy of grains and air, and the power of friction, from frames of a 2D scene."""

    def __init__(self, scene):
        self.scene, self.air = scene, Energy(scene, "air")
        self.dx, self.size = scene["spacing"], scene["domain"]["size"]
        self.periodic = ["x" in scene["domain"].get("periodic", []), "y" in scene["domain"].get("periodic", [])]
        self.gravity = -scene["domain"].get("gravity", [0, 0])[1]
        self.grain = scene["phases"]["sand"]["density"] * self.dx**2
        keys, entry = scene["phases"]["air"], scene["interactions"]["air-air"]
        smoothing = .5 * entry["radius"] * self.dx
        self.mu = keys["density"] * (keys["viscosity"] + keys["artificial-viscosity"] * smoothing * keys["sound-speed"] / 8)
        self.drag = .5 * scene["interactions"]["air-sand"].get("drag", 0) * keys["density"] * self.dx
        self.slow = .1 * keys["sound-speed"]  # of the barrier
        radius = scene["interactions"]["air-sand"]["radius"]
        row = numpy.arange(-math.ceil(radius), math.ceil(radius) + 1)
        about = numpy.hypot(*numpy.meshgrid(row, row)) / radius
        self.alone = wendland(about[about > 0], radius)[0].sum()  # sum V W about a grain that stands alone on the lattice
        self.stiffness = scene["phases"]["sand"]["density"] * scene["phases"]["sand"].get("contact-speed", 0) ** 2

    def split(self, f):
        return {name: f["phase"] == k for k, name in enumerate(f.names)}

    def energy(self, f):
        of = self.split(f)
        air = type(f).__new__(type(f))
        air.x, air.arrays = f.x[of["air"]], {k: f[k][of["air"]] for k in ("velocity", "density")}
        speed2 = (f["velocity"][of["sand"]] ** 2).sum()
        high = f.x[of["sand"], 1].sum()
        return self.air.parts(air).sum() + self.grain * (.5 * speed2 + self.gravity * high) + self.contacts(f, of)

    def contacts(self, f, of):
        """1/2 K g^2 of touching grains, g = max(W(r) - W(d), 0)/|W'(d)|, cubic spline; 0 if the scene leaves contact-speed to the plan."""
        if not self.stiffness:
            return 0.
        h = .5 * self.scene["interactions"]["sand-sand"] * self.dx
        w = lambda q: numpy.where(q < 1, 1 - 1.5 * q**2 + .75 * q**3, .25 * numpy.clip(2 - q, 0, None) ** 3)
        slope = .75 * (2 - self.dx / h) ** 2 / h
        solid = [of[name] for name in ("box", "floor", "lid") if name in of]
        total = 0.
        for other, share in ((of["sand"], .5), (sum(solid) > 0 if solid else None, 1.)):
            if other is None or not other.any():
                continue
            _, _, r = pairs(f.x[of["sand"]], f.x[other], self.dx, self.size, self.periodic)
            total += share * (.5 * self.stiffness * ((w(r / h) - w(self.dx / h)) / slope) ** 2).sum()
        return total

    def friction(self, f):
        """Power, W/m: viscosity by pairs, and form drag."""
        of = self.split(f)
        x, v, air = f.x, f["velocity"][:, :2], of["air"]
        solid = ~air
        if solid.any() and "lid" in of:
            solid &= ~of["lid"]  # slips
        power, volume = 0., self.dx**2
        radius = self.scene["interactions"]["air-air"]["radius"] * self.dx
        i, j, r = pairs(x[air], x[air], radius, self.size, self.periodic)
        dv2 = ((v[air][i] - v[air][j]) ** 2).sum(axis=1)
        power += (self.mu * volume**2 * wendland(r / radius, radius)[1] * dv2).sum()  # each pair stands twice
        radius = self.scene["interactions"]["air-sand"]["radius"] * self.dx
        i, j, r = pairs(x[air], x[solid], radius, self.size, self.periodic)
        w, slope = wendland(r / radius, radius)
        weight, mean = numpy.zeros(solid.sum()), numpy.zeros((solid.sum(), 2))
        numpy.add.at(weight, j, volume * w)
        numpy.add.at(mean, j, (volume * w)[:, None] * v[air][i])
        mean /= numpy.where(weight > 0, weight, 1)[:, None]
        lone = numpy.clip((weight / self.alone - .65) / .25, 0, 1) if self.drag else 0 * weight
        lone = (lone**2 * (3 - 2 * lone))[:, None]
        beyond = numpy.where(of["sand"][solid][:, None], v[solid] + lone * (mean - v[solid]), 2 * v[solid] - mean)
        relative = v[air][i] - v[solid][j]
        power += (2 * self.mu * volume**2 * slope * ((v[air][i] - beyond[j]) * relative).sum(axis=1)).sum()
        if self.drag:
            sand = of["sand"][solid][j]
            power += (self.drag * volume * w[sand] * numpy.linalg.norm(relative[sand], axis=1) ** 3).sum()
            power += self.barrier(x[air][i[sand]], x[solid][j[sand]], relative[sand])
        return power

    def barrier(self, air, sand, relative):
        """Power that the barrier of grains takes: its dashpot's, and its spring's, which gives back later."""
        r = air[:, :2] - sand[:, :2]
        for axis in (0, 1):
            if self.periodic[axis]:
                r[:, axis] -= self.size[axis] * numpy.round(r[:, axis] / self.size[axis])
        distance, reach = numpy.linalg.norm(r, axis=1), .6 * self.dx
        approach = (relative * r).sum(axis=1) / distance
        factor = numpy.clip(1 - (2 / self.slow) ** 2 * (relative**2).sum(axis=1), 0, None) * (distance < reach)
        rate = self.slow / reach
        force = self.air.mass * factor * rate * (rate * (reach - distance) - numpy.minimum(approach, 0))
        return -(force * approach).sum()

    def series(self, frames):
        """Energy and friction's work up to each frame."""
        t = numpy.array([f.time for f in frames])
        power = numpy.array([self.friction(f) for f in frames])
        work = numpy.concatenate([[0], numpy.cumsum(numpy.diff(t) * (power[1:] + power[:-1]) / 2)])
        return numpy.array([self.energy(f) for f in frames]), work


def report_holes(name, scheme, budget, frames, seconds):
    radii = []
    seen = frames[1::max(len(frames) // 25, 1)] + frames[-1:]
    for f in seen:
        inside = numpy.array([.5, .5]) * budget.dx
        origin = [0 if p else inside[d] for d, p in enumerate(budget.periodic)]
        size = [s if p else s - budget.dx for s, p in zip(budget.size, budget.periodic)]
        radii.append(largest_hole(f.x, origin, size, budget.dx, budget.periodic)[0])
    report(name, scheme, "", "radius of the largest hole at the end/dx (one particle missing: 1)", radii[-1], 1., seconds)
    tell(name, scheme, "", "radius of the largest hole at any time/dx (2: or more)", f"{max(radii):.2f} at {seen[int(numpy.argmax(radii))].time:.2g} s",
         "", seconds)


def shot(fraction):
    """A grain that flies 40 diameters: energy, momentum, hole, drag."""
    scene = document("grain_shot")
    speed = fraction * scene["phases"]["air"]["sound-speed"]
    end = 40 * scene["spacing"] / speed
    name = f"grain shot at {fraction} c"
    budget = Budget(scene)

    def case(scheme, overrides):
        frames, (history,), seconds = run("grain_shot", [f"fill.0.velocity=[{speed!r}, 0]", f"time.end={end!r}",
                                                         f"output.every={end / 50!r}", f"output.history-every={end / 50!r}"] + overrides,
                                          also=("history.csv",))
        energy, friction = budget.series(frames)
        closed = (energy + friction) / energy[0] - 1
        report(name, scheme, "", "energy + friction over the start, largest error", abs(closed).max(), .01, seconds)
        kinetic = history["sand_kinetic_energy"]
        lost = kinetic[0] - kinetic[-1]
        tell(name, scheme, "", "energy that the grain lost/its own; of it in the air; by friction; not accounted for",
             f"{lost / kinetic[0]:.4f}; {(energy[-1] - kinetic[-1]) / lost:.2f}; {friction[-1] / lost:.2f}; {-closed[-1] * energy[0] / lost:+.2f}",
             "", seconds)
        momentum = history["momentum_x"]
        tell(name, scheme, "", "momentum at the end/at the start - 1", f"{momentum[-1] / momentum[0] - 1:.1e}", "0", seconds)
        # dv/dt = -1/2 C rho v^2/(rho_s d): 1/v grows with t
        v = history["sand_mean_vx [m/s]"]
        half = len(v) // 2
        slope = (1 / v[-1] - 1 / v[half]) / (history["time [s]"][-1] - history["time [s]"][half])
        tell(name, scheme, "", "drag coefficient of the grain, second half", f"{2 * slope * 2650 * budget.dx / 1.225:.2f}", "", seconds)
        report_holes(name, scheme, budget, frames, seconds)
    for scheme, overrides in SCHEMES.items():
        attempt(name, scheme, "", lambda: case(scheme, overrides))


def pile():
    """Thirty grains fall: with restitution 0.7 they come to rest, with restitution 1 the budget closes."""
    scene = document("pile")
    scene["phases"]["sand"]["contact-speed"] = 12
    budget = Budget(scene)

    def case(scheme, overrides):
        frames, seconds = run("pile", overrides)
        report_holes("pile", scheme, budget, frames, seconds)
        sand = frames[-1]["phase"] == frames[-1].names.index("sand")
        fastest = numpy.linalg.norm(frames[-1]["velocity"][sand], axis=1).max()
        tell("pile", scheme, "", "fastest grain at the end, m/s; highest grain, diameters over the floor",
             f"{fastest:.2g}; {frames[-1].x[sand, 1].max() / budget.dx:.1f}", "", seconds)
        frames, seconds = run("pile", ["phases.sand.restitution=1", "phases.sand.contact-speed=12", "output.every=2.5e-4"] + overrides)
        energy, friction = budget.series(frames)
        closed = (energy + friction) / energy[0] - 1
        report("pile, restitution 1", scheme, "", "energy + friction over the start, largest error", abs(closed).max(), .01, seconds)
        tell("pile, restitution 1", scheme, "", "taken by friction/start; at the end not accounted for",
             f"{friction[-1] / energy[0]:.3f}; {-closed[-1]:+.4f}", "", seconds)
    for scheme, overrides in SCHEMES.items():
        attempt("pile", scheme, "", lambda: case(scheme, overrides))


def blown_bed():
    """A loose bed in a storm: holes, and no energy from nowhere."""
    budget = Budget(document("blown_bed"))

    def case(scheme, overrides):
        frames, (history,), seconds = run("blown_bed", overrides, also=("history.csv",))
        t, push = history["time [s]"], history["air_held_acceleration_x [m/s2]"]
        air = (frames[0]["phase"] == frames[0].names.index("air")).sum() * budget.air.mass
        power = air * push * history["air_mean_vx [m/s]"]
        work = numpy.concatenate([[0], numpy.cumsum(numpy.diff(t) * power[1:])])  # the row at t = 0 has no step before it
        energy = numpy.array([budget.energy(f) - numpy.interp(f.time, t, work) for f in frames])
        report("blown bed", scheme, "", "largest gain of the energy less the forcing's work/its start", energy.max() / energy[0] - 1, .01, seconds)
        report_holes("blown bed", scheme, budget, frames, seconds)
        sand = frames[-1]["phase"] == frames[-1].names.index("sand")
        tell("blown bed", scheme, "", "grains that left the floor by a diameter, at the end; fastest, m/s",
             f"{(frames[-1].x[sand, 1] > frames[0].x[frames[0]['phase'] == frames[0].names.index('sand'), 1].max() + budget.dx).sum()} of "
             f"{sand.sum()}; {numpy.linalg.norm(frames[-1]['velocity'][sand], axis=1).max():.2f}", "", seconds)
    for scheme, overrides in SCHEMES.items():
        attempt("blown bed", scheme, "", lambda: case(scheme, overrides))


CASES = {
    "grains-in-air": (lambda: [shot(.05), shot(.2), pile(), blown_bed()], "Grains in air of their own spacing"),
}
