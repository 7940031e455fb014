#!/usr/bin/python3
"""Reattachment behind a backward-facing step by a second method: the figures of the literature are of an expansion of 2, the scene's is 1.9423.

    /usr/bin/python3 bench/accuracy/step_reference.py            needs scipy

Steady flow as stream function psi (u = dpsi/dy) and vorticity omega (-lap psi), central differences of second order on a square grid, Newton's
method. The channel is that of the scene: a narrow part 3 h long, which a parabola enters (mean speed 1), and a wide part 17 h long, at whose end
nothing changes along x. Walls by Thom's formula. The corner of the step has one vorticity as a point of the floor ahead and another as a point of
the wall below it. Two grids, and the value that they point to for an error of second order.
As a check the same for an expansion of 2, where Erturk 2008 has 2.922, 4.982, 6.751 and 8.237 at Re 100, 200, 300 and 400.

It gives 2.861, 4.891, 6.660 and 8.187 for the scene's expansion, and 2.903, 4.972, 6.752 and 8.246 for that of 2: within 0.7, 0.2, 0.1 and 0.2 % of
Erturk. One minute of processor time.
"""

import numpy
import scipy.sparse
import scipy.sparse.linalg

BEFORE, BEHIND = 3., 17.  # h, lengths of the narrow and of the wide part
REYNOLDS = (100, 200, 300, 400)  # U 2h/nu
GRIDS = {2.: (16, 32), 1.9423: (16, 33)}  # spacings in S; of them h has a whole number, nearly


def reattachment(re, expansion, across, start=None):
    """x_r/S, and the solution, for a start at a larger Re."""
    d = (expansion - 1) / across  # h = 1
    s, before = across, round(BEFORE / d)
    nx, ny = before + round(BEHIND / d) + 1, s + round(1 / d) + 1
    top, h, nu = ny - 1, (ny - 1 - s) * d, 2 / re  # h as the grid has it
    nu *= h
    i, j = numpy.meshgrid(numpy.arange(nx), numpy.arange(ny), indexing="ij")
    solid = (j <= s) & (i <= before) | (j == 0) | (j == top)
    y = numpy.clip((j - s) * d / h, 0, 1)
    inlet_psi, inlet_omega = h * (3 * y**2 - 2 * y**3), numpy.where(j >= s, -(6 - 12 * y) / h, 0)
    psi, omega = (inlet_psi.copy(), inlet_omega.copy()) if start is None else (start[0].copy(), start[1].copy())
    number = i * ny + j
    half = nx * ny
    for _ in range(30):
        rows, cols, values, r = [], [], [], numpy.zeros(2 * half)

        def put(row, col, value):
            rows.append(row), cols.append(col), values.append(numpy.broadcast_to(value, row.shape))
        inner = ~solid & (i > 0) & (i < nx - 1)
        a, b = i[inner], j[inner]
        n = number[inner]
        corner = (a == before + 1) & (b == s)
        left = numpy.where(corner, -2 * psi[a, b] / d**2, omega[a - 1, b])
        centre, right, low, high = omega[a, b], omega[a + 1, b], omega[a, b - 1], omega[a, b + 1]
        u, v = (psi[a, b + 1] - psi[a, b - 1]) / (2 * d), -(psi[a + 1, b] - psi[a - 1, b]) / (2 * d)
        ox, oy = (right - left) / (2 * d), (high - low) / (2 * d)
        r[n] = (psi[a - 1, b] + psi[a + 1, b] + psi[a, b - 1] + psi[a, b + 1] - 4 * psi[a, b]) / d**2 + centre
        for step, of in ((-ny, 1), (ny, 1), (-1, 1), (1, 1), (0, -4)):
            put(n, n + step, of / d**2)
        put(n, n + half, 1.)
        r[n + half] = u * ox + v * oy - nu * (left + right + low + high - 4 * centre) / d**2
        put(n + half, n + 1, ox / (2 * d))
        put(n + half, n - 1, -ox / (2 * d))
        put(n + half, n + ny, -oy / (2 * d))
        put(n + half, n - ny, oy / (2 * d))
        put(n + half, n + half + ny, u / (2 * d) - nu / d**2)
        west = -u / (2 * d) - nu / d**2
        put((n + half)[~corner], (n + half - ny)[~corner], west[~corner])
        put((n + half)[corner], n[corner], west[corner] * -2 / d**2)
        put(n + half, n + half + 1, v / (2 * d) - nu / d**2)
        put(n + half, n + half - 1, -v / (2 * d) - nu / d**2)
        put(n + half, n + half, 4 * nu / d**2)
        # walls, and what lies within the step: psi given; omega by Thom, zero within
        n = number[solid | (i == 0)]
        r[n] = (psi - numpy.where(j == top, h, numpy.where(i == 0, inlet_psi, 0)))[solid | (i == 0)]
        put(n, n, 1.)
        put(n + half, n + half, 1.)
        r[n + half] = omega[solid | (i == 0)]
        n = number[0]
        r[n + half] = omega[0] - inlet_omega[0]
        for where, beside in (((j == s) & (i > 0) & (i <= before) | (j == 0) & (i > before), 1), ((j == top) & (i > 0), -1),
                              ((i == before) & (j > 0) & (j < s), ny)):
            n = number[where]
            near = psi.ravel()[n + beside] - (h if beside == -1 else 0)
            put(n + half, n + beside, 2 / d**2)
            put(n + half, n, 0. if beside != -1 else -2 / d**2)
            r[n + half] = omega[where] + 2 * (psi.ravel()[n + beside] - psi.ravel()[n] if beside == -1 else near) / d**2
        end = ~solid & (i == nx - 1)
        n = number[end]
        for shift, f in ((0, psi), (half, omega)):
            put(n + shift, n + shift, 1.)
            put(n + shift, n + shift - ny, -1.)
            r[n + shift] = f.ravel()[n] - f.ravel()[n - ny]
        matrix = scipy.sparse.csc_matrix((numpy.concatenate(values), (numpy.concatenate(rows), numpy.concatenate(cols))), shape=(2 * half, 2 * half))
        change = scipy.sparse.linalg.splu(matrix).solve(-r)
        psi += change[:half].reshape(nx, ny)
        omega += change[half:].reshape(nx, ny)
        if abs(change[:half]).max() < 1e-9:
            break
    else:
        raise RuntimeError("Newton's method does not converge")
    shear, x = -omega[before:, 0], numpy.arange(nx - before) * d  # du/dy at the floor
    at = numpy.flatnonzero((x[:-1] > .3) & (shear[:-1] < 0) & (shear[1:] >= 0))[0]
    return (x[at] + d * shear[at] / (shear[at] - shear[at + 1])) / (across * d), (psi, omega)


def main():
    for expansion, grids in GRIDS.items():
        found = []
        for across in grids:
            solution, lengths = None, []
            for re in REYNOLDS:
                length, solution = reattachment(re, expansion, across, solution)
                lengths.append(length)
            found.append(lengths)
            print(f"expansion {expansion}, S/{across}: " + ", ".join(f"{v:.3f}" for v in lengths), flush=True)
        ratio = (grids[1] / grids[0]) ** 2
        print(f"expansion {expansion}, to no spacing: " + ", ".join(f"{w + (w - v) / (ratio - 1):.3f}" for v, w in zip(*found)), flush=True)


if __name__ == "__main__":
    main()
