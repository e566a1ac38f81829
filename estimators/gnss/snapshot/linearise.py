"""Pseudoranges about a position: directions, whitened residuals, and Gauss-Newton from the Earth's centre.

The state is the Cartesian position and one receiver clock per constellation, all in metres. A satellite
position that is given in the frame of its transmission is turned to that of reception by the angle through
which the Earth moves while the signal travels (the Sagnac effect; IS-GPS-200, 20.3.3.4.3.3.2).
"""

from __future__ import annotations

import math

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.kernels import device

SPEED_OF_LIGHT = 299792458.0
"""Metres per second."""
EARTH_RATE = 7.2921151467e-5
"""Rotation of the Earth in radians per second (WGS 84, IS-GPS-200)."""
_MOST_STEPS = 20
_CONVERGED_M = 1e-5
_SINGULAR = 1e-13
"""Least squared pivot, relative to the diagonal, of geometry that determines all unknowns."""


@device
def linearise(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    rotated: bool,
    state: FloatArray,
    A: FloatArray,
    z: FloatArray,
) -> None:
    """Write the whitened design, shape (n, p), and the whitened residuals at a state."""
    p = state.size
    for i in range(ranges.size):
        sx, sy, sz = satellites[i, 0], satellites[i, 1], satellites[i, 2]
        if not rotated:
            travelled = math.sqrt((sx - state[0]) ** 2 + (sy - state[1]) ** 2 + (sz - state[2]) ** 2)
            angle = EARTH_RATE * travelled / SPEED_OF_LIGHT
            sine, cosine = math.sin(angle), math.cos(angle)
            sx, sy = cosine * sx + sine * sy, cosine * sy - sine * sx
        dx, dy, dz = sx - state[0], sy - state[1], sz - state[2]
        rho = math.sqrt(dx * dx + dy * dy + dz * dz)
        for j in range(3, p):
            A[i, j] = 0.0
        A[i, 0] = -dx / (rho * sigma[i])
        A[i, 1] = -dy / (rho * sigma[i])
        A[i, 2] = -dz / (rho * sigma[i])
        A[i, 3 + clock[i]] = 1.0 / sigma[i]
        z[i] = (ranges[i] - rho - state[3 + clock[i]]) / sigma[i]


@device
def fill_normal(A: FloatArray, z: FloatArray, used: BoolArray, normal: FloatArray, right: FloatArray) -> None:
    """Write A'A and A'z over the used rows."""
    n, p = A.shape
    for j in range(p):
        right[j] = 0.0
        for k in range(j + 1):
            normal[j, k] = 0.0
    for i in range(n):
        if used[i]:
            for j in range(p):
                a = A[i, j]
                if a != 0.0:
                    right[j] += a * z[i]
                    for k in range(j + 1):
                        normal[j, k] += a * A[i, k]


@device
def factorise(normal: FloatArray) -> bool:
    """Replace the lower triangle by its Cholesky factor; False where unknowns are not determined."""
    p = normal.shape[0]
    for j in range(p):
        diagonal = normal[j, j]
        pivot = diagonal
        for k in range(j):
            pivot -= normal[j, k] * normal[j, k]
        if not pivot > _SINGULAR * diagonal:
            return False
        root = math.sqrt(pivot)
        normal[j, j] = root
        for i in range(j + 1, p):
            held = normal[i, j]
            for k in range(j):
                held -= normal[i, k] * normal[j, k]
            normal[i, j] = held / root
    return True


@device
def solve_factorised(factor: FloatArray, right: FloatArray) -> None:
    """Replace the right side by the solution."""
    p = right.size
    for j in range(p):
        held = right[j]
        for k in range(j):
            held -= factor[j, k] * right[k]
        right[j] = held / factor[j, j]
    for j in range(p - 1, -1, -1):
        held = right[j]
        for k in range(j + 1, p):
            held -= factor[k, j] * right[k]
        right[j] = held / factor[j, j]


@device
def iterate(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    rotated: bool,
    used: BoolArray,
    state: FloatArray,
    A: FloatArray,
    z: FloatArray,
    factor: FloatArray,
    step: FloatArray,
) -> bool:
    """Gauss-Newton from ``state`` over the used rows; leaves design, residuals and factor at the solution.

    Returns
    -------
    bool
        False where the geometry does not determine the unknowns or the iteration does not settle.
    """
    for _ in range(_MOST_STEPS):
        linearise(satellites, ranges, sigma, clock, rotated, state, A, z)
        fill_normal(A, z, used, factor, step)
        if not factorise(factor):
            return False
        solve_factorised(factor, step)
        moved = 0.0
        for j in range(state.size):
            state[j] += step[j]
            if j < 3:
                moved = max(moved, abs(step[j]))
        if not math.isfinite(moved):
            return False
        if moved < _CONVERGED_M:
            linearise(satellites, ranges, sigma, clock, rotated, state, A, z)
            return True
    return False
