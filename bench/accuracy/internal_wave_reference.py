"""The wave of an interface of two ideal fluids between flat walls, of any height: what a wave that begins flat takes to turn.

    /usr/bin/python3 bench/accuracy/internal_wave_reference.py [MODES]

Layers of 0.5 m, waves 1 m long, g = 9.81 m/s2; at the start the potential flow of a wave that will be 0.5 to 5 spacings (1/50 m) high,
as in tests/physics/two_fluids_weight.cpp. Prints for each density above 1000 kg/m3 and each height the frequency, from the first
quarter of a period, over that of a small wave (Lamb 1932, article 231). Eight modes and twelve agree within 2e-5.

The potentials are sums of modes that fit the walls: phi_1 = sum a_n cosh k_n (y+h) cos k_n x below, phi_2 = sum b_n cosh k_n (h-y) cos k_n x
above. At each time they follow from rho_1 phi_1 - rho_2 phi_2 and from equal speeds across the interface (least squares); the interface
moves with them, and the difference of the potentials follows from Bernoulli's equation on both sides.
"""
import sys

import numpy

G, LENGTH, DEPTH, PLACES = 9.81, 1.0, 0.5, 48
K = 2 * numpy.pi / LENGTH


class Layers:
    def __init__(self, below, above, modes):
        self.below, self.above, n = below, above, numpy.arange(modes + 1)
        self.x = (numpy.arange(PLACES) + .5) / PLACES * LENGTH / 2
        self.k, self.cos, self.sin = n * K, numpy.cos(numpy.outer(self.x, n * K)), numpy.sin(numpy.outer(self.x, n * K))
        self.smooth = numpy.exp(-36 * (n / modes) ** 12.)  # what the modes cannot show must not grow
        self.omega = numpy.sqrt(abs(below - above) / (below + above) * G * K * numpy.tanh(K * DEPTH))

    def modes_of(self, values):
        return numpy.linalg.lstsq(self.cos, values, rcond=None)[0] * self.smooth

    def flow(self, height, potential):
        """Height and slope of the interface, the potentials' modes and the velocities (u, v) on both of its sides."""
        eta, slope = self.cos @ height, -(self.sin * self.k) @ height
        sides, norm = [], numpy.cosh(self.k * DEPTH)
        for sign in (1, -1):
            z = numpy.outer(DEPTH + sign * eta, self.k)
            phi = numpy.cosh(z) / norm * self.cos
            sides.append((phi, -numpy.cosh(z) / norm * self.k * self.sin, sign * numpy.sinh(z) / norm * self.k * self.cos))
        (f1, u1, v1), (f2, u2, v2) = sides
        across = [v - slope[:, None] * u for u, v in ((u1, v1), (u2, v2))]
        matrix = numpy.block([[self.below * f1, -self.above * f2], [across[0] * self.below / K, -across[1] * self.below / K]])
        matrix[:, len(self.k)] = 0  # a constant above changes nothing
        modes = numpy.linalg.lstsq(matrix, numpy.concatenate([self.cos @ potential, 0 * eta]), rcond=1e-13)[0]
        a, b = modes[:len(self.k)], modes[len(self.k):]
        return eta, slope, a, b, u1 @ a, v1 @ a, u2 @ b, v2 @ b

    def rates(self, height, potential):
        eta, slope, _, _, u1, v1, u2, v2 = self.flow(height, potential)
        rise = v1 - slope * u1
        below, above = (density * (rise * v - .5 * (u * u + v * v)) for density, u, v in ((self.below, u1, v1), (self.above, u2, v2)))
        return numpy.array([self.modes_of(rise), self.modes_of(below - above - (self.below - self.above) * G * eta)])

    def speed(self, height, potential):
        """The vertical velocity that goes with exp(-k|y|) cos kx, over all fluid, as the test takes it."""
        eta, _, a, b, *_ = self.flow(height, potential)
        total, norm, share = 0., numpy.cosh(self.k * DEPTH), (numpy.arange(200) + .5) / 200
        for i, x in enumerate(self.x):
            for sign, modes, thick in ((1, a, DEPTH + eta[i]), (-1, b, DEPTH - eta[i])):
                z = share * thick  # from the wall
                v = sign * (numpy.sinh(numpy.outer(z, self.k)) / norm * self.k * self.cos[i]) @ modes
                total += (numpy.exp(-K * abs(z - DEPTH)) * v).mean() * thick * numpy.cos(K * x)
        return total

    def frequency(self, amplitude, step=4e-3):
        """Over that of a small wave; amplitude: m."""
        state = numpy.zeros((2, len(self.k)))
        state[1, 1] = (self.below + self.above) * amplitude * self.omega / K / numpy.tanh(K * DEPTH)
        time, last, before = 0., self.speed(*state), 0.
        while time < 5:
            for _ in range(5):
                k1 = self.rates(*state)
                k2 = self.rates(*(state + step / 2 * k1))
                k3 = self.rates(*(state + step / 2 * k2))
                state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + self.rates(*(state + step * k3)))
                time += step
            now = self.speed(*state)
            if now <= 0:
                return .5 * numpy.pi / (before + (time - before) * last / (last - now)) / self.omega
            last, before = now, time
        return numpy.nan


def main():
    modes = int(sys.argv[1]) if len(sys.argv) > 1 else 10
    print("above, kg/m3; height, spacings; frequency/that of a small wave")
    for above in (900., 500., 1.2):
        for height in (.5, 1, 1.5, 3, 4, 5):
            print(f"{above:g}  {height:g}  {Layers(1000., above, modes).frequency(height / 50):.4f}", flush=True)


main()
