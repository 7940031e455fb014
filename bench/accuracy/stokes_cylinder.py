#!/usr/bin/python3
"""Rate at which a free cylinder turns in a sheared channel, Stokes flow, over the shear rate.

    stokes_cylinder.py LENGTH WIDTH [DIAMETER]

LENGTH: distance of the cylinder from its periodic images along the channel; WIDTH: that of the plates, which slide apart at the shear rate times it. The
stream function is psi = Re[y F(z) + G(z)] + b y^2, z = x + i y, with periodic analytic F and G: derivatives of cot(pi z/L), which are singular in the
cylinder only, and sines and cosines of 2 pi m z/L. It is even in z. Nothing in it pulls or turns the cylinder (no logarithm). The coefficients, b and the
rate follow by least squares from the velocities on a plate and on the cylinder; the largest error there is printed too.
"""

import sys

import numpy


def pole(z, order, wave):
    """z^-order, periodic: a polynomial in cot(wave z/2), by d cot/dz = -(wave/2)(1 + cot^2)."""
    polynomial, sign = numpy.array([0.0, 0.5 * wave]), 1.0
    for k in range(1, order):
        polynomial = numpy.polynomial.polynomial.polymul(numpy.polynomial.polynomial.polyder(polynomial), [-0.5 * wave, 0, -0.5 * wave])
        sign *= -1.0 / k
    return sign * numpy.polynomial.polynomial.polyval(1.0 / numpy.tan(0.5 * wave * z), polynomial)


def rotation(length, width, radius, poles=8, waves=16, places=200):
    """(rate of rotation over the shear rate, largest error of the velocity on the borders over the shear rate)."""
    wave, step = 2.0 * numpy.pi / length, 1e-5
    odd = [lambda z, n=n: pole(z, n, wave) * radius**n for n in range(1, 2 * poles, 2)]
    odd += [lambda z, m=m: numpy.sin(m * wave * z) / numpy.cosh(0.5 * m * wave * width) for m in range(1, waves)]
    even = [lambda z, n=n: pole(z, n, wave) * radius**(n + 1) for n in range(2, 2 * poles + 1, 2)]
    even += [lambda z, m=m: numpy.cos(m * wave * z) / numpy.cosh(0.5 * m * wave * width) for m in range(1, waves)]
    share = (numpy.arange(places) + 0.5) / places
    x = numpy.r_[(share - 0.5) * length, radius * numpy.cos(2.0 * numpy.pi * share)]
    y = numpy.r_[numpy.full(places, 0.5 * width), radius * numpy.sin(2.0 * numpy.pi * share)]
    on_cylinder = numpy.arange(2 * places) >= places
    z, columns = x + 1j * y, []
    for functions, times_y in ((odd, True), (even, False)):
        for function in functions:
            value, slope = function(z), (function(z + step) - function(z - step)) / (2.0 * step)
            for part in (numpy.real, numpy.imag):
                u, v = part(1j * slope), -part(slope)  # psi_y, -psi_x
                columns.append(numpy.r_[part(value) + y * u, y * v] if times_y else numpy.r_[u, v])
    columns.append(numpy.r_[2.0 * y, 0.0 * y])
    columns.append(numpy.r_[on_cylinder * y, on_cylinder * -x])  # less the velocity of the cylinder for a rate of one
    wanted = numpy.r_[numpy.where(on_cylinder, 0.0, 0.5 * width), 0.0 * y]
    matrix = numpy.array(columns).T
    found = numpy.linalg.lstsq(matrix, wanted, rcond=1e-12)[0]
    return -found[-1], abs(matrix @ found - wanted).max()


def main(words):
    sizes = [float(word) for word in words]
    print("rate/shear %.6f, error on the borders %.1e" % rotation(sizes[0], sizes[1], 0.5 * (sizes[2] if len(sizes) > 2 else 1.0)))


if __name__ == "__main__":
    main(sys.argv[1:])
