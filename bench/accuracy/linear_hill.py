"""Linear theories of a turbulent wind over low, rough ground: the stress of the ground by place.

All stresses are over rho u*^2, all lengths in metres; the profile of the undisturbed wind is U = u*/kappa ln(1 + z/z0).
"""
import numpy
from scipy import sparse, special
import scipy.sparse.linalg

KAPPA = 0.4


def inner_layer(length, roughness):
    """The thickness l of the inner layer of Jackson & Hunt 1975, eq. (3.8): l ln(l/z0) = 2 kappa^2 L."""
    l = 0.1 * length
    for _ in range(200):
        l = 2.0 * KAPPA**2 * length / numpy.log(l / roughness)
    return l


def middle_layer(length, roughness):
    """The height h_m of the outer wind, h_m = L/sqrt(ln(h_m/z0)) (Hunt, Leibovich & Richards 1988)."""
    h = length
    for _ in range(200):
        h = length / numpy.sqrt(numpy.log(h / roughness))
    return h


def jackson_hunt(k, length, roughness, depth):
    """Stress over height of a wave e^(ikx) of the ground, as Weng et al. 1991 write the theory of Jackson & Hunt 1975; the
    pressure of the outer layer is that of potential flow under a lid at `depth`, k coth(k depth) in place of k. Written
    from memory of that form; the limit of ln(l/z0) large."""
    l, h = inner_layer(length, roughness), middle_layer(length, roughness)
    outer = (numpy.log(h / roughness) / numpy.log(l / roughness)) ** 2
    sigma = numpy.sqrt(1j * length * k * roughness / l)
    inner = -1.0 + (2.0 * numpy.log(l / roughness) + 1.0) * sigma * special.kv(1, 2 * sigma) / special.kv(0, 2 * sigma)
    return 2.0 * outer * k / numpy.tanh(k * depth) * inner


def mixing_length(k, roughness, depth):
    """The same from the linear equations of a wind with the mixing length kappa (z + z0) over the ground, between no slip
    on the ground and a lid at `depth` with the given stress: the equations of the particles' model, to first order in
    the height. (As Fourriere, Claudin & Andreotti 2010 do without a lid.)

    In the height over the ground, with a = ik (u - U') the stretching along x and nu = kappa (z + z0):
      u' = s/(2 nu) - ik w,  w' = -a,  s' = U a + w U' + ik p - 4 ik nu a,  p' = -ik U w + ik s
    with the stress s and the pressure p less the normal stress of z; u = w = 0 below, w = s = 0 on the lid."""
    n = 300
    xi = numpy.linspace(0.0, numpy.log1p(depth / roughness), n)  # ln(1 + z/z0)
    height = roughness * numpy.exp(xi)  # z + z0 = dz/dxi
    speed, shear, nu, i_k = xi / KAPPA, 1.0 / (KAPPA * height), KAPPA * height, 1j * k
    stretch = (speed - 4.0 * i_k * nu) * i_k
    of = numpy.zeros((n, 4, 4), complex)  # y' = of y + given, y = (u, w, s, p)
    of[:, 0, 1], of[:, 0, 2] = -i_k, 0.5 / nu
    of[:, 1, 0] = -i_k
    of[:, 2, 0], of[:, 2, 1], of[:, 2, 3] = stretch, shear, i_k
    of[:, 3, 1], of[:, 3, 2] = -i_k * speed, i_k
    given = numpy.zeros((n, 4), complex)
    given[:, 1], given[:, 2] = i_k * shear, -stretch * shear
    of, given = of * height[:, None, None], given * height[:, None]
    half, one = 0.5 * (xi[1] - xi[0]), numpy.eye(4)
    matrix, right = numpy.zeros((4 * n, 4 * n), complex), numpy.zeros(4 * n, complex)
    for j in range(n - 1):  # the trapezoidal rule from node to node
        rows = slice(4 * j + 2, 4 * j + 6)
        matrix[rows, 4 * j:4 * j + 4] = -one - half * of[j]
        matrix[rows, 4 * j + 4:4 * j + 8] = one - half * of[j + 1]
        right[rows] = half * (given[j] + given[j + 1])
    matrix[0, 0] = matrix[1, 1] = 1.0  # no slip on the ground
    matrix[-2, -3] = matrix[-1, -2] = 1.0  # w and s on the lid
    return sparse.linalg.spsolve(sparse.csc_matrix(matrix), right)[2]


def over_hill(x, period, height, transfer):
    """The stress of the ground over rho u*^2 at the places x: 1 and the sum over the waves of the periodic hill height(x);
    `transfer(k)`: stress over height of a wave."""
    n = 1024
    waves = numpy.fft.rfft(height(period * numpy.arange(n) / n)) / n
    stress = numpy.ones_like(x)
    for m in range(1, 48):
        k = 2.0 * numpy.pi * m / period
        if abs(waves[m]) > 1e-9:
            stress = stress + 2.0 * numpy.real(waves[m] * transfer(k) * numpy.exp(1j * k * x))
    return stress
