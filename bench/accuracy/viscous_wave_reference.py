#!/usr/bin/python3
"""A standing gravity wave of small amplitude in viscous water of finite depth over a floor without friction, linear theory.

The problem of Prosperetti 1981 (Phys. Fluids 24, 1217) at the depth and with the floor of Antuono & Colagrossi 2013 (Wave Motion 50, 197): at
first the surface is flat and the velocity that of the wave without friction. Lengths in depths H, times in sqrt(H/g); Re = H sqrt(gH)/nu.

Velocity (-V' sin kx, k V cos kx)/k and surface eta cos kx; V(0) = 0. The equations are solved in their weak form, with polynomials over the
depth: the stress that the surface has not, and the slip of the floor, are natural conditions there. `root` is the normal mode of the same
problem, from the dispersion relation: a way of its own to the same number.
"""
import numpy


def wave(re, k=numpy.pi, degree=40, stress=True):
    """Times t -> (amplitude of the wave's velocity in units of the start, kinetic energy over its start): a function.

    The amplitude is the projection of the velocity on that of the wave without friction, (-cosh ky sin kx, sinh ky cos kx). With stress = False
    the friction is int nu |grad v|^2: the surface has no gradient of the velocity across it in place of no stress, as the sums of a Laplacian
    that end at the surface have it. That is another problem: slow waves decay at half of the true rate.
    """
    y, weight = numpy.polynomial.legendre.leggauss(2 * degree)
    y, weight = .5 * (y + 1), .5 * weight
    one = numpy.eye(degree + 1)[1:]
    legendre = [numpy.polynomial.legendre.Legendre(c, domain=[0, 1]) for c in one]
    at = lambda order: numpy.array([p.deriv(order)(y) if order else p(y) - p(0.) for p in legendre])
    v, d, dd = at(0), at(1), at(2)
    top = numpy.array([p(1.) - p(0.) for p in legendre])
    shear = dd / k + k * v
    mass = (d * weight) @ d.T / k**2 + (v * weight) @ v.T
    if stress:
        friction = ((2 * d * weight) @ d.T + .5 * (shear * weight) @ shear.T) * 2 / re
    else:
        friction = ((2 * d * weight) @ d.T + (dd * weight) @ dd.T / k**2 + k**2 * (v * weight) @ v.T) / re
    n = degree
    # d/dt of (V, eta): the surface rises by V, its weight acts on V
    rate = numpy.zeros((n + 1, n + 1))
    scale = numpy.linalg.cholesky(mass)  # V = scale^-T w: the mass is one
    to = numpy.linalg.inv(scale)
    rate[:n, :n] = -to @ friction @ to.T
    rate[:n, n] = -to @ top
    rate[n, :n] = to @ top
    start = numpy.sinh(k * y) / numpy.sinh(k)
    mode = numpy.append(to @ ((d * weight) @ (k * numpy.cosh(k * y) / numpy.sinh(k)) / k**2 + (v * weight) @ start), 0)
    values, vectors = numpy.linalg.eig(rate)
    parts = numpy.linalg.solve(vectors, mode.astype(complex))

    def series(t):
        state = (vectors * parts) @ numpy.exp(numpy.outer(values, numpy.atleast_1d(t)))
        return (mode @ state).real / (mode @ mode), (state[:n].real ** 2).sum(axis=0) / (mode @ mode)
    return series


def root(re, k=numpy.pi, steps=60):
    """s = -gamma + i omega of the normal mode exp(s t), Newton from the wave without friction.

    s^2 + 2 nu k^2 s + g k T (1 - 2 k^2/(m^2 + k^2)) - 4 nu k^3 s m T coth(m H)/(m^2 + k^2) = 0,   m^2 = k^2 + s/nu,   T = tanh kH;
    for deep water Lamb 1932, section 349.
    """
    nu, t = 1 / re, numpy.tanh(k)

    def miss(s):
        m = numpy.sqrt(k**2 + s / nu + 0j)
        both = m**2 + k**2
        return s**2 + 2 * nu * k**2 * s + k * t * (1 - 2 * k**2 / both) - 4 * nu * k**3 * s * m * t / numpy.tanh(m) / both
    s = 1j * numpy.sqrt(k * t) - 2 * nu * k**2
    for _ in range(steps):
        h = 1e-6
        s = s - miss(s) * h / (miss(s + .5 * h) - miss(s - .5 * h))
    return s


def main():
    for re in (50, 250, 2500):
        s = root(re)
        t = numpy.linspace(0, 12, 4)
        series = wave(re)(t)
        again = wave(re, degree=30)(t)
        print(f"Re = {re}: omega {s.imag:.5f}, gamma {-s.real:.5f} (2 nu k^2 = {2 * numpy.pi**2 / re:.5f}); amplitude at t = "
              + ", ".join(f"{x:.0f}: {a:+.5f}" for x, a in zip(t, series[0])) + f"; with 30 polynomials {abs(series[0] - again[0]).max():.1e} else")


if __name__ == "__main__":
    main()
