#!/usr/bin/python3
"""Free heave of a half-immersed circular cylinder in deep water, linear theory: place over the start, by t sqrt(g/a).

The problem of Maskell & Ursell (1970) and Yeung (1982): Laplace's equation about the half disc, the linear conditions at
the surface (eta' = dphi/dn, phi' = -g eta), and (m + m_inf) V + L(phi_surface) = momentum of body and fluid, whose rate
is -2 rho g a y. Bilinear finite elements in r and theta, Runge and Kutta's fourth order in time. Lengths in radii a,
g = 1, rho = 1; half of the fluid, by symmetry.
"""
import numpy
import scipy.sparse
import scipy.sparse.linalg


def free_heave(reach=60.0, around=48, end=20.0, step=0.01, mass=0.25 * numpy.pi):
    """Times t sqrt(g/a), y/y0, and the added mass at high frequencies over the body's (exact: 1).

    `reach`: of the water, radii. `around`: cells from the lowest place to the surface. `mass`: of half of the body, that of half of
    the water it displaces.
    """
    r = [1.0]
    width = numpy.pi / 2 / around
    while r[-1] < reach:
        r.append(r[-1] + width)
        width = min(width * 1.03, 0.2)
    r = numpy.array(r)
    t = numpy.pi / 2 * (1 - (1 - numpy.linspace(0, 1, around + 1)) ** 2)  # from the downward vertical to the surface, finest there
    nr, nt = len(r), len(t)

    def one_d(x, weight):
        """Stiffness and mass matrices with a weight of the middle of each cell."""
        h = numpy.diff(x)
        w = weight(0.5 * (x[1:] + x[:-1]))
        k = scipy.sparse.lil_matrix((len(x), len(x)))
        m = scipy.sparse.lil_matrix((len(x), len(x)))
        for e, (size, factor) in enumerate(zip(h, w)):
            k[e:e + 2, e:e + 2] += factor / size * numpy.array([[1, -1], [-1, 1]])
            m[e:e + 2, e:e + 2] += factor * size / 6 * numpy.array([[2, 1], [1, 2]])
        return k.tocsr(), m.tocsr()

    k_r, _ = one_d(r, lambda x: x)
    _, m_inv = one_d(r, lambda x: 1 / x)
    k_t, m_t = one_d(t, numpy.ones_like)
    _, m_surface = one_d(r, numpy.ones_like)
    stiff = (scipy.sparse.kron(k_r, m_t) + scipy.sparse.kron(m_inv, k_t)).tocsr()  # unknown i*nt + j
    surface = numpy.arange(nr) * nt + nt - 1
    inner = numpy.setdiff1d(numpy.arange(nr * nt), surface)
    # Flux into the fluid at the body for V = 1 upwards: the fluid's outward normal is -r; u.n_out = -V * (r.up) = V cos t.
    flux = numpy.zeros(nr * nt)
    flux[:nt] = m_t @ numpy.cos(t)  # r.up = -cos t
    solve = scipy.sparse.linalg.factorized(stiff[inner][:, inner].tocsc())
    coupling = stiff[inner][:, surface]
    mass_surface = scipy.sparse.linalg.factorized(m_surface.tocsc())
    outer = nr - 1

    def field(phi_s, speed):
        phi = numpy.zeros(nr * nt)
        phi[surface] = phi_s
        phi[inner] = solve(speed * flux[inner] - coupling @ phi_s)
        return phi

    one = field(numpy.zeros(nr), 1.0)
    added = flux @ one  # m_inf of the half

    def rates(phi_s, eta, momentum, y):
        still = field(phi_s, 0.0)
        speed = (momentum - flux @ still) / (mass + added)
        phi = still + speed * one
        rise = (stiff @ phi - speed * flux)[surface]
        eta_rate = mass_surface(rise)
        eta_rate[outer] = 0.0
        return -eta, eta_rate, -y, speed  # phi' = -g eta; momentum' = -g rho a y (half)

    state = [numpy.zeros(nr), numpy.zeros(nr), 0.0, 1.0]
    times, places = [0.0], [1.0]
    steps = int(round(end / step))
    for k in range(steps):
        def at(slope, part):
            return [s + part * step * q for s, q in zip(state, slope)]
        a = rates(*state)
        b = rates(*at(a, 0.5))
        c = rates(*at(b, 0.5))
        d = rates(*at(c, 1.0))
        state = [s + step / 6 * (p + 2 * q + 2 * u + v) for s, p, q, u, v in zip(state, a, b, c, d)]
        times.append((k + 1) * step)
        places.append(state[3])
    return numpy.array(times), numpy.array(places), added / mass


def main():
    for around in (24, 48):
        t, y, added = free_heave(around=around, step=0.02, end=16)
        turns = [k for k in range(1, len(t) - 1) if (y[k] - y[k - 1]) * (y[k + 1] - y[k]) < 0]
        print(f"{around} cells: added mass {added:.4f}; turns " + ", ".join(f"{y[k]:+.4f} at {t[k]:.2f}" for k in turns))


if __name__ == "__main__":
    main()
