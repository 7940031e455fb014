"""Free surfaces: standing wave, rotating square patch, dam break, still tank; nothing may gain energy."""

import math

import numpy

from harness import attempt, document, local_fit, options, report, run, tell

SCHEMES = {"consistent": [], "plain, radius 3.0": ["phases.{0}.scheme=plain", "interactions.{0}-{0}=3.0", "interactions.{0}-{1}=3.0"]}


def both(name, case, n, fluid="water", wall="tank", more=None):
    """Runs case(scheme, overrides) for each scheme: the scene as it is, the plain sums with a radius of 3, and those of `more`."""
    for scheme, overrides in (SCHEMES | (more or {})).items():
        overrides = [o.format(fluid, wall) for o in overrides if wall or "{1}" not in o]
        attempt(name, scheme, n, lambda: case(scheme, overrides))


class Energy:
    """Energy of a fluid from its frames: kinetic, in gravity (above the origin), and of compression, J per metre of depth in 2D.

    The latter is m c^2 (ln(rho/rho0) + rho0/rho - 1), the work of the linear equation of state p = c^2 (rho - rho0)."""

    def __init__(self, scene, phase, spacing=None):
        self.dimensions, self.gravity = scene["dimensions"], scene["domain"].get("gravity", [0, 0, 0])
        keys = scene["phases"][phase]
        self.density, self.sound = keys["density"], keys["sound-speed"]
        self.mass = self.density * (spacing or scene["spacing"]) ** self.dimensions

    def parts(self, frame):
        speed2, ratio = (frame["velocity"] ** 2).sum(axis=1), frame["density"] / self.density
        height = -frame.x[:, :self.dimensions] @ numpy.array(self.gravity[:self.dimensions])
        squeezed = self.sound**2 * (numpy.log(ratio) + 1 / ratio - 1)
        return self.mass * numpy.array([.5 * speed2.sum(), height.sum(), squeezed.sum()])

    def total(self, frames):
        return numpy.array([self.parts(f).sum() for f in frames])


def report_gain(name, scheme, n, total, seconds, whole=None):
    """The rule for every surface: the total energy is never above its start by more than 0.1 %."""
    report(name, scheme, n, "largest gain of the total energy/its start", (total.max() - total[0]) / (whole or total[0]), 1e-3, seconds)


# ---- standing wave ---------------------------------------------------------------------------------------------------

def damped_cosine(t, a):
    """omega and gamma of exp(-gamma t) (p cos(omega t) + q sin(omega t)) through the values a(t), least squares (Gauss-Newton)."""
    crossings = numpy.flatnonzero(a[:-1] * a[1:] < 0)
    zeros = t[crossings] - a[crossings] * (t[crossings + 1] - t[crossings]) / (a[crossings + 1] - a[crossings])
    x = numpy.array([math.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0]), 0.])

    def miss(x):
        envelope = numpy.exp(-x[1] * t)
        basis = numpy.column_stack([envelope * numpy.cos(x[0] * t), envelope * numpy.sin(x[0] * t)])
        return a - basis @ numpy.linalg.lstsq(basis, a, rcond=None)[0]
    for _ in range(20):
        step = 1e-5 * x[0]
        jacobian = numpy.column_stack([(miss(x + d) - miss(x - d)) / (2 * step) for d in step * numpy.eye(2)])
        x = x - numpy.linalg.lstsq(jacobian, miss(x), rcond=None)[0]
    return x


def wave_amplitude(frame, k):
    """Projection of the particles' velocity on the linear wave's, (-cosh ky sin kx, sinh ky cos kx)/sinh k."""
    x, y = frame.x[:, 0], frame.x[:, 1]
    mode = numpy.column_stack([-numpy.cosh(k * y) * numpy.sin(k * x), numpy.sinh(k * y) * numpy.cos(k * x)]) / math.sinh(k)
    return (frame["velocity"][:, :2] * mode).sum() / (mode**2).sum()


def standing_wave(n):
    """Frequency and decay over six periods, from the projection of the velocity on the wave."""
    def case(scheme, overrides):
        frames, seconds = run("standing_wave", [f"spacing={1 / n!r}"] + overrides, "water")
        k, g = math.pi, 9.81
        exact = math.sqrt(g * k * math.tanh(k))
        omega, gamma = damped_cosine(numpy.array([f.time for f in frames]), numpy.array([wave_amplitude(f, k) for f in frames]))
        total = Energy(document("standing_wave"), "water", 1 / n).total(frames)
        report("standing wave", scheme, n, "frequency, error/sqrt(g k tanh kH)", abs(omega / exact - 1), .01, seconds)
        loss = 1 - math.exp(-gamma * 2 * math.pi / exact)
        report("standing wave", scheme, n, "amplitude that a period takes (below 0: gives)", loss, .01 if n >= 50 else None, seconds)
        report_gain("standing wave", scheme, n, total, seconds)
    both("standing wave", case, n, wall="floor", more={"plain, the scene's radius of 2.6": ["phases.{0}.scheme=plain"]})


# ---- rotating square patch -------------------------------------------------------------------------------------------

CENTRE = {.5: -.1330, 1.: -.1038}  # p/(rho omega^2 L^2) at the centre by omega t: square_patch_reference.py


def square_patch(n):
    """Corners in free flight to omega t = 2, energy, pressure at the centre.

    The tip of a corner flies freely; a particle half a spacing from both sides nearly so (at 50 a side 0.9895 of it at omega t = 1,
    square_patch_reference.py). A corner that is lost falls behind by tens of per cent."""
    def case(scheme, overrides):
        frames, seconds = run("square_patch", [f"spacing={1 / n!r}"] + overrides, "fluid")
        first, last = frames[0], frames[-1]
        corners = first["id"][numpy.argsort(numpy.abs(first.x[:, :2]).sum(axis=1))[-4:]]
        far = lambda f: numpy.linalg.norm(f.x[numpy.isin(f["id"], corners)], axis=1)
        flight = far(last) / (far(first).mean() * math.hypot(1, last.time))
        total = Energy(document("square_patch"), "fluid", 1 / n).total(frames)
        name = "square patch"
        report(name, scheme, n, "omega t at the end", last.time, 2, seconds, True)
        report(name, scheme, n, "corners: distance over free flight, largest error", abs(flight - 1).max(), .05, seconds)
        report(name, scheme, n, "total energy/its start, largest change", abs(total / total[0] - 1).max(), .01, seconds)
        report_gain(name, scheme, n, total, seconds)
        for t, exact in CENTRE.items():
            f = min(frames, key=lambda f: abs(f.time - t))
            p = local_fit(f.x, f["pressure"], (0, 0), 2.6 / n) / 1000
            tell(name, scheme, n, f"pressure at the centre/(rho omega2 L2), omega t = {t}", f"{p:.4f}", f"{exact}", seconds)
    both("square patch", case, n, "fluid", None)


# ---- dam break -------------------------------------------------------------------------------------------------------

# Martin & Moyce 1952, table 2: n^2 = 2, a = 2.25 in; T = n t sqrt(g/a), Z = z/a. The time counts from the rupture of the
# diaphragm, which is not instantaneous.
FRONT_T = (.41, .84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20, 2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33)
FRONT_Z = (1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00, 3.22, 3.44, 3.67, 3.89, 4.11)
COLUMN = .05715  # m, a
# The ideal fluid, by boundary elements of our own: where it is .05 a thick.
IDEAL_T, IDEAL_Z = (.922, 1.785, 2.307, 2.924), (1.44, 2.33, 3.0, 3.89)


def front(frame, spacing, fluid_neighbours=3):
    """x of the front: the farthest particle of the lowest rows that is no lone drop, and half a spacing."""
    low = frame.x[frame.x[:, 1] < 4 * spacing]
    order = low[numpy.argsort(-low[:, 0])]
    for one in order[:200]:
        if (numpy.linalg.norm(order - one, axis=1) < 1.6 * spacing).sum() > fluid_neighbours:
            return one[0] + .5 * spacing
    return order[0, 0] + .5 * spacing


def thick_front(frame, spacing, thickness=.05 * COLUMN):
    """x of the farthest particle whose upper side is so high, and half a spacing."""
    return frame.x[frame.x[:, 1] + .5 * spacing > thickness * (1 - 1e-6), 0].max() + .5 * spacing


def surface(frame, dx):
    """Mean over columns two spacings wide of the highest particle and half a spacing; a wave takes from one what it gives another."""
    column = (frame.x[:, 0] / (2 * dx)).astype(int)
    top = numpy.zeros(round(5 * COLUMN / (2 * dx)))
    numpy.maximum.at(top, numpy.clip(column, 0, len(top) - 1), frame.x[:, 1] + .5 * dx)
    return top.mean()


def report_front(name, scheme, n, frames, spacing, seconds):
    """Largest error of Z at the measured times; how late the experiment's clock would be for the best fit, and what is left then."""
    t = numpy.array([f.time for f in frames]) * math.sqrt(2 * 9.81 / COLUMN)
    z = numpy.array([front(f, spacing) for f in frames]) / COLUMN
    measured_t, measured = numpy.array(FRONT_T), numpy.array(FRONT_Z)
    wall = 5 - .5 * spacing / COLUMN
    until = t[numpy.argmax(z > wall)] if (z > wall).any() else t[-1]
    seen = measured_t <= until
    error = lambda shift: abs(numpy.interp(measured_t[seen] - shift, t, z) / measured[seen] - 1)
    report(name, scheme, n, f"front against {seen.sum()} measured places, largest error", error(0).max(), .05, seconds)
    report(name, scheme, n, "measured places that the run saw", int(seen.sum()), len(measured), seconds, True)
    shifts = numpy.linspace(-.2, .6, 161)
    best = min(shifts, key=lambda s: error(s).max())
    report(name, scheme, n, f"the same with the measured clock {best:.3f} late (Lethe: 0.175)", error(best).max(), .05, seconds)
    speed = lambda times, places: numpy.polyfit(times, places, 1)[0]
    free = seen & (measured > 2) & (measured < 4)
    report(name, scheme, n, "speed of the front from Z = 2.1 to 3.9/measured, error",
           abs(speed(numpy.interp(measured[free], z, t), measured[free]) / speed(measured_t[free], measured[free]) - 1), .05, seconds)
    thick = numpy.maximum.accumulate([thick_front(f, spacing) for f in frames]) / COLUMN
    late = [numpy.interp(z, thick, t) / ideal - 1 for ideal, z in zip(IDEAL_T, IDEAL_Z)]
    report(name, scheme, n, f"T at which it is .05 a thick at Z = {', '.join(map(str, IDEAL_Z))} beside the ideal fluid's: " + ", ".join(f"{x:+.4f}" for x in late) + "; largest",
           max(map(abs, late)), .02, seconds)


def dam_break(n):
    """Front, pressure on the far wall, energy, and the volume of the water when it has come to rest."""
    dx = 2 * COLUMN / n

    def case(scheme, overrides):
        # the second run of the pair has the frames that the front needs; the first goes on until the water rests
        frames, (wall,), seconds = run("dam_break", [f"spacing={dx!r}"] + overrides, "water", also=("probe_far_wall.csv",))
        early, more = run("dam_break", [f"spacing={dx!r}", "time.end=0.25", "output.every=0.0025"] + overrides, "water")
        head = 1000 * 9.81 * 2 * COLUMN
        name = "dam break"
        report_front(name, scheme, n, early, dx, more)
        total = Energy(document("dam_break"), "water", dx).total(early + [f for f in frames if f.time > .25])
        report_gain(name, scheme, n, total, seconds)
        t, p = wall["time [s]"], wall["pressure [Pa]"]
        known = numpy.isfinite(p)
        hit, p = t[known][0] if known.any() else math.nan, numpy.where(known, p, 0)
        tell(name, scheme, n, "far wall, y = 0.1 a: largest pressure/(rho g 2 a), mean over 5 ms",
             f"{numpy.convolve(p, numpy.ones(10) / 10, 'same').max() / head:.2f}; wet from T = {hit * math.sqrt(2 * 9.81 / COLUMN):.2f}",
             "", seconds)
        late = [f for f in frames if f.time > .8 * frames[-1].time]
        depth = numpy.mean([surface(f, dx) for f in late]) / (.4 * COLUMN)
        report(name, scheme, n, "volume at rest (mean height of the surface)/its own, error", abs(depth - 1), .03, seconds)
        centre = numpy.mean([2 * f.x[:, 1].mean() for f in late]) / (.4 * COLUMN)
        tell(name, scheme, n, "the same from the centre of mass, which the last waves raise", f"{centre - 1:+.3f}", "", seconds)
        rest = p[t > .8 * t[-1]].mean() / (1000 * 9.81 * (.4 * COLUMN - .0057))
        tell(name, scheme, n, "far wall, y = 0.1 a: pressure at rest/hydrostatic", f"{rest:.3f}", "1", seconds)
        kinetic = Energy(document("dam_break"), "water", dx).parts(frames[-1])[0]
        tell(name, scheme, n, "kinetic energy at the end/total at the start", f"{kinetic / total[0]:.1e}", "", seconds)
    both("dam break", case, n)


def dam_break_3d(n):
    """The front of 2D, and the energy, in 3D."""
    dx = 2 * COLUMN / n

    def case(scheme, overrides):
        frames, seconds = run("dam_break_3d", [f"spacing={dx!r}"] + overrides, "water")
        report_front("dam break 3D", scheme, n, frames, dx, seconds)
        report_gain("dam break 3D", scheme, n, Energy(document("dam_break_3d"), "water", dx).total(frames), seconds)
    both("dam break 3D", case, n)


# ---- still tank ------------------------------------------------------------------------------------------------------

def still_tank(n):
    """Largest speed of any particle in 100 crossings; the surface."""
    def case(scheme, overrides):
        frames, (history,), seconds = run("still_tank", [f"spacing={1 / n!r}"] + overrides, "water", also=("history.csv",))
        speed = history["water_largest_speed [m/s]"].max() / math.sqrt(9.81)
        total = Energy(document("still_tank"), "water", 1 / n).total(frames)
        name = "still tank"
        report(name, scheme, n, "largest speed/sqrt(gH) in 100 crossings", speed, 1e-3, seconds)
        report_gain(name, scheme, n, total, seconds)
        f = frames[-1]
        exact = 1000 * 62.6**2 * numpy.expm1(9.81 * numpy.clip(1 - f.x[:, 1], 0, None) / 62.6**2)
        tell(name, scheme, n, "largest error of the pressure/(rho g H)", f"{abs(f['pressure'] - exact).max() / 9810:.1e}", "", seconds)
        tell(name, scheme, n, "highest particle's way/dx", f"{(f.x[:, 1].max() - frames[0].x[:, 1].max()) * n:.3f}", "0", seconds)
    both("still tank", case, n)


CASES = {
    "standing-wave": (lambda: [standing_wave(n) for n in (25, 50)], "Standing gravity wave, no friction, depth of half a wavelength"),
    "square-patch": (lambda: [square_patch(n) for n in (50, 100) if n <= options.largest],
                     "Rotating square patch (Colagrossi 2005; Le Touze et al. 2013)"),
    "dam-break": (lambda: [dam_break(n) for n in (40, 80) if n <= options.largest], "Dam break (Martin & Moyce 1952, n^2 = 2)"),
    "dam-break-3d": (lambda: dam_break_3d(20), "Dam break in 3D"),
    "still-tank": (lambda: still_tank(50), "Water at rest in an open tank, 100 crossings of sound"),
}
