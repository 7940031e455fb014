"""Waves and sloshing: what takes energy from a surface that moves a little, beside linear theory."""

import math

import numpy

import viscous_wave_reference
from cases_surface import SCHEMES, damped_cosine, wave_amplitude
from harness import attempt, options, report, run, tell

GRAVITY = 9.81
PLAIN = {name: SCHEMES[name] for name in ("consistent", "plain, radius 3.0")}


def both(name, n, case, wall):
    for scheme, overrides in PLAIN.items():
        attempt(name, scheme, n, lambda: case(scheme, [o.format("water", wall) for o in overrides]))


# ---- standing wave in viscous water ----------------------------------------------------------------------------------

PERIODS = {50: 2, 250: 4, 2500: 6}


def viscous_wave(re, n):
    """Frequency and decay of the standing wave in viscous water, fitted as those of linear theory are, and the kinetic energy."""
    name = f"viscous standing wave, Re = {re}"
    end = PERIODS[re] * 1.134

    def case(scheme, overrides):
        frames, seconds = run("standing_wave", [f"spacing={1 / n!r}", f"phases.water.viscosity={math.sqrt(GRAVITY) / re!r}", f"time.end={end!r}",
                                                "output.every=0.0567"] + overrides, "water")
        t = numpy.array([f.time for f in frames])
        amplitude = numpy.array([wave_amplitude(f, math.pi) for f in frames])
        kinetic = numpy.array([(f["velocity"] ** 2).sum() for f in frames])
        exact, energy = viscous_wave_reference.wave(re)(t * math.sqrt(GRAVITY))
        omega, gamma = damped_cosine(t, amplitude / amplitude[0])
        true_omega, true_gamma = damped_cosine(t, exact)
        report(name, scheme, n, f"rate of decay/linear theory {gamma / true_gamma:.3f}, error", abs(gamma / true_gamma - 1), .02, seconds)
        other = damped_cosine(t, viscous_wave_reference.wave(re, stress=False)(t * math.sqrt(GRAVITY))[0])[1]
        tell(name, scheme, n, "the same over a theory whose surface has no gradient across it, not no stress", f"{gamma / other:.3f}", "", seconds)
        report(name, scheme, n, "frequency/linear theory, error", abs(omega / true_omega - 1), .01, seconds)
        report(name, scheme, n, "amplitude beside linear theory, rms of the difference/start",
               math.sqrt(((amplitude / amplitude[0] - exact) ** 2).mean()), None, seconds)
        report(name, scheme, n, "kinetic energy beside linear theory, rms of the difference/start",
               math.sqrt(((kinetic / kinetic[0] - energy) ** 2).mean()), None, seconds)
    both(name, n, case, "floor")


# ---- flows down a slope: a surface bears no stress -------------------------------------------------------------------

def film(n):
    """A laminar film after 10 s: its profile over the speed of its surface. A top row that nothing holds back would be 100 % too fast."""
    def case(scheme, overrides):
        frames, seconds = run("falling_film", [f"spacing={1 / n!r}"] + overrides, "water")
        y, u = frames[-1].x[:, 1], frames[-1]["velocity"][:, 0]
        report("film down a slope", scheme, n, "speed/that of the surface, largest error", abs(u / .5 - (2 * y - y * y)).max(), .01, seconds)
        report("film down a slope", scheme, n, "flow, error/g_x H^3/(3 nu)", abs(u.mean() * 3 - 1), .01, seconds)
    both("film down a slope", n, case, "floor")


def river(n):
    """Turbulent water down a slope after 0.5 s: its profile over u*, and its flow."""
    def case():
        frames, seconds = run("river", [f"spacing={.1 / n!r}", f"domain.size=[{20 * .1 / n!r}, 0.15]", f"fill.1.shape.box.max=[{20 * .1 / n!r}, 0.1]"], "water")
        first, last = frames[0], frames[-1]
        s = numpy.sqrt(numpy.clip(1 - last.x[:, 1] / .1, 0, 1))
        exact = 2 * s + numpy.log((1 - s) / (1 + s)) + math.log(4000) - 2
        report("river", "consistent", n, "speed, largest error/u*", abs(last["velocity"][:, 0] - exact).max() / .4, .05, seconds)
        report("river", "consistent", n, "flow, change/start", abs(last["velocity"][:, 0].mean() / first["velocity"][:, 0].mean() - 1), .01, seconds)
    attempt("river", "consistent", n, case)


# ---- sloshing --------------------------------------------------------------------------------------------------------

K, DEPTH = math.pi, .5  # of sloshing_tank.toml
OMEGA = math.sqrt(GRAVITY * K * math.tanh(K * DEPTH))


def mode(frame):
    """Projection of the particles' velocity on the first mode's: the rate of its rise."""
    x, y = frame.x[:, 0], frame.x[:, 1]
    both = numpy.column_stack([-numpy.cosh(K * y) * numpy.sin(K * x), numpy.sinh(K * y) * numpy.cos(K * x)]) / math.sinh(K * DEPTH)
    return (frame["velocity"][:, :2] * both).sum() / (both**2).sum()


def growing(t, a):
    """omega, p and q of t (p sin(omega t) + q cos(omega t)) through the values a(t), least squares."""
    def fit(omega):
        basis = numpy.column_stack([t * numpy.sin(omega * t), t * numpy.cos(omega * t)])
        c = numpy.linalg.lstsq(basis, a, rcond=None)[0]
        return ((a - basis @ c) ** 2).sum(), c
    low, high = .9 * OMEGA, 1.1 * OMEGA
    for _ in range(4):
        trial = numpy.linspace(low, high, 81)
        best = trial[numpy.argmin([fit(omega)[0] for omega in trial])]
        low, high = best - (high - low) / 40, best + (high - low) / 40
    return best, *fit(best)[1]


def sloshing(n):
    """A small wave between walls over ten periods: frequency and loss. The shaken tank: period and growth of its first mode."""
    def case(scheme, overrides):
        name = "small sloshing"
        frames, seconds = run("sloshing_tank", [f"constants.rows={n}", "constants.start=0.0159", "constants.shake=0"] + overrides, "water")
        omega, gamma = damped_cosine(numpy.array([f.time for f in frames]), numpy.array([mode(f) for f in frames]))
        report(name, scheme, n, "frequency, error/sqrt(g k tanh kH)", abs(omega / OMEGA - 1), .003, seconds)
        loss = 1 - math.exp(-gamma * 2 * math.pi / OMEGA)
        report(name, scheme, n, f"amplitude that a period takes {loss:+.4f}, size", abs(loss), .003, seconds)
        name = "sloshing at resonance"
        frames, seconds = run("sloshing_tank", [f"constants.rows={n}"] + overrides, "water")
        t, a = numpy.array([f.time for f in frames]), numpy.array([mode(f) for f in frames])
        omega, p, q = growing(t, a)
        theory = -2 * OMEGA**2 / (math.pi**2 * GRAVITY) * 5e-4 * OMEGA**2
        report(name, scheme, n, "period of the response/that of the shaking, error", abs(OMEGA / omega - 1), .01, seconds)
        report(name, scheme, n, f"growth/linear theory {math.hypot(p, q) / abs(theory) * numpy.sign(p * theory):.4f}, error",
               abs(math.hypot(p, q) / abs(theory) * numpy.sign(p * theory) - 1), .02, seconds)
        tell(name, scheme, n, "velocity of the mode less t sin(omega t), rms over rms",
             f"{math.sqrt(((a - theory * t * numpy.sin(OMEGA * t)) ** 2).mean() / (a**2).mean()):.4f}", "0", seconds)
    both("sloshing", n, case, "tank")


CASES = {
    "viscous-wave": (lambda: [viscous_wave(re, n) for re in (50, 250, 2500) for n in (12, 25, 50, 100) if n <= options.largest],
                     "Standing wave in viscous water, Re = H sqrt(gH)/nu"),
    "falling-film": (lambda: [film(n) for n in (10, 20, 40) if n <= options.largest] + [river(n) for n in (20, 40, 80) if n <= options.largest],
                     "Laminar and turbulent water down a slope"),
    "sloshing": (lambda: [sloshing(n) for n in (12, 25, 50, 100) if n <= options.largest], "Sloshing in a tank, and at resonance"),
}
