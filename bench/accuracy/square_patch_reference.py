#!/usr/bin/python3
"""The rotating square patch as a potential flow: pressure at its centre and distance of points near a corner, to omega t = 1.

    /usr/bin/python3 bench/accuracy/square_patch_reference.py

In a frame that turns with the patch at omega = 1 the fluid starts from rest and has no vorticity (a uniform vorticity stays uniform in
2D), so its velocity is the gradient of phi, and f = phi + i psi is analytic. With Coriolis and centrifugal force Bernoulli's equation is
d phi/dt + w^2/2 + p/rho + 2 psi - r^2/2 = 0, with p = 0 on the surface. Markers on one side of the square (L = 1, fourfold symmetry) carry
phi; f is a polynomial in z^4, fitted to them by least squares; fourth-order Runge-Kutta. With 6, 8 and 12 terms the printed figures
agree to four digits; after omega t = 1.2 the arms are too thin for a polynomial. cases_surface.py quotes what this prints.
"""

import numpy


def patch(end, near, terms=8, points=100, steps=150):
    """Times, pressure/(rho omega^2 L^2) at the centre and distances of the points `near` (complex) from it."""
    angle = numpy.linspace(-1, 1, points) * numpy.pi / 2
    y = numpy.concatenate([.5 + .5j * numpy.sin(angle), numpy.array(near, complex)])
    phi, weight, power = numpy.zeros(points), numpy.sqrt(numpy.cos(angle) + .02), 4 * numpy.arange(terms)

    def rates(y, phi):
        z = y[:points]
        size = abs(z).max()
        b = (z[:, None] / size) ** power
        columns = numpy.column_stack([b.real, -b.imag[:, 1:]]) * weight[:, None]  # the constant is real: psi = 0 at the centre
        scale = numpy.linalg.norm(columns, axis=0)
        c = numpy.linalg.lstsq(columns / scale, phi * weight, rcond=1e-12)[0] / scale
        a = c[:terms] + 1j * numpy.concatenate([[0], c[terms:]])
        w = (((y[:, None] / size) ** power)[:, 1:] * power[1:] @ a[1:] / y).conj()
        return w, .5 * abs(w[:points]) ** 2 + .5 * abs(z) ** 2 - 2 * (b @ a).imag, a[0].real

    dt, constant, distance = end / steps, [], []
    for _ in range(steps + 1):
        k1, p1, a0 = rates(y, phi)
        constant.append(a0)
        distance.append(abs(y[points:]))
        k2, p2, _ = rates(y + dt / 2 * k1, phi + dt / 2 * p1)
        k3, p3, _ = rates(y + dt / 2 * k2, phi + dt / 2 * p2)
        k4, p4, _ = rates(y + dt * k3, phi + dt * p3)
        y, phi = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4), phi + dt / 6 * (p1 + 2 * p2 + 2 * p3 + p4)
    return dt * numpy.arange(steps + 1), -numpy.gradient(constant, dt), numpy.array(distance)


def main():
    for terms in (6, 8, 12):
        t, pressure, distance = patch(1.05, [.49 + .49j], terms)
        for at in (.5, 1.):
            r = numpy.interp(at, t, distance[:, 0])
            print(f"{terms} terms, omega t = {at}: p(0) = {numpy.interp(at, t, pressure):.4f} rho omega^2 L^2, the point (0.49, 0.49) L at "
                  f"{r:.4f} L, {r / (.49 * numpy.sqrt(2 * (1 + at * at))):.4f} of free flight")


if __name__ == "__main__":
    main()
