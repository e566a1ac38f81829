"""Heights along a track: a robust smoother of their own, since they err apart from the horizontal position.

Height and its rate follow the same two-state model as each horizontal axis, with noise and manoeuvre from
differences; fixes count by the weights of Student's t with 4 degrees of freedom (Lange, Little and Taylor
1989, "Robust statistical modeling using the t distribution"), so that a wrong height moves nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray
from estimators.kernels import kernel, ro
from estimators.trajectories.labelling.modes import LONGEST_S
from estimators.trajectories.spans import start_from_spans

_DOF = 4.0
_STEPS = 8
_FRESH = 1e10
_RATE_SPREAD_MPS = 5.0
_UNMEASURED = np.inf
HALO = 1 << 13
"""Known heights beyond a piece, on either side, that are smoothed along; farther ones do not matter."""
_SAMPLE = 1 << 17


@kernel(
    types.void(
        ro(types.float64),
        ro(types.float64),
        ro(types.float64),
        types.float64,
        types.float64[::1],
        types.float64[::1],
    )
)
def smooth_line(
    t: FloatArray, y: FloatArray, variance: FloatArray, manoeuvre: float, out: FloatArray, spread: FloatArray
) -> None:
    """Smooth one coordinate by the filter and smoother of Rauch, Tung and Striebel.

    Parameters
    ----------
    t, y, variance : ndarray, shape (n,)
        Times, values and their variances; an infinite variance says that nothing was measured.
    manoeuvre : float
        Spectral density of the acceleration.
    out, spread : ndarray, shape (n,)
        Out: values and their variances.
    """
    n = t.size
    held = np.zeros((n, 5))
    ahead = np.zeros((n, 5))
    x, v, a, b, c = 0.0, 0.0, _FRESH, 0.0, _RATE_SPREAD_MPS**2
    for k in range(n):
        if k > 0:
            dt = min(t[k] - t[k - 1], LONGEST_S)
            x += dt * v
            a += 2.0 * dt * b + dt * dt * c + manoeuvre * dt * dt * dt / 3.0
            b += dt * c + manoeuvre * dt * dt / 2.0
            c += manoeuvre * dt
        ahead[k, 0], ahead[k, 1], ahead[k, 2], ahead[k, 3], ahead[k, 4] = x, v, a, b, c
        if variance[k] < np.inf:
            total = a + variance[k]
            gain, gain_rate = a / total, b / total
            off = y[k] - x
            x += gain * off
            v += gain_rate * off
            c -= gain_rate * b
            b *= 1.0 - gain
            a *= 1.0 - gain
        held[k, 0], held[k, 1], held[k, 2], held[k, 3], held[k, 4] = x, v, a, b, c
    x, v, a, b, c = held[n - 1]
    out[n - 1], spread[n - 1] = x, a
    for k in range(n - 2, -1, -1):
        dt = min(t[k + 1] - t[k], LONGEST_S)
        fx, fv, fa, fb, fc = held[k]
        px, pv, pa, pb, pc = ahead[k + 1]
        determinant = pa * pc - pb * pb
        if not determinant > 1e-14 * pa * pc:
            x, v, a, b, c = fx, fv, fa, fb, fc
        else:
            # gain = P F' (F P F' + Q)^-1
            m00, m01, m10, m11 = fa + dt * fb, fb, fb + dt * fc, fc
            g00, g01 = (m00 * pc - m01 * pb) / determinant, (m01 * pa - m00 * pb) / determinant
            g10, g11 = (m10 * pc - m11 * pb) / determinant, (m11 * pa - m10 * pb) / determinant
            dx, dv = x - px, v - pv
            da, db, dc = a - pa, b - pb, c - pc
            x, v = fx + g00 * dx + g01 * dv, fv + g10 * dx + g11 * dv
            a = fa + g00 * g00 * da + 2.0 * g00 * g01 * db + g01 * g01 * dc
            b = fb + g00 * g10 * da + (g00 * g11 + g01 * g10) * db + g01 * g11 * dc
            c = fc + g10 * g10 * da + 2.0 * g10 * g11 * db + g11 * g11 * dc
        out[k], spread[k] = x, a


@dataclass(frozen=True, slots=True)
class HeightModel:
    """What the heights of a track are made of.

    Attributes
    ----------
    level_m : float
    variance, coloured : float
        Of all noise, and of the part that lasts, m^2.
    manoeuvre : float
        Spectral density of the acceleration.
    """

    level_m: float
    variance: float
    coloured: float
    manoeuvre: float


def trusted_heights(height: FloatArray, trusted: BoolArray) -> BoolArray:
    """Rows whose heights count: those of good rows; those of others if there are no others."""
    known = np.isfinite(height)
    both = known & trusted
    return both if both.any() else known


def estimate_heights(t: FloatArray, height: FloatArray, used: BoolArray) -> HeightModel:
    """Find level, noise and motion of heights, of a long track by some of them.

    Parameters
    ----------
    t, height : ndarray, shape (m,)
    used : ndarray of bool, shape (m,)
    """
    rows = np.flatnonzero(used)
    if rows.size > _SAMPLE:
        rows = np.concatenate([part[: _SAMPLE // 16] for part in np.array_split(rows, 16)])
    level = float(np.median(height[rows]))
    noise, colour, manoeuvre = np.exp(start_from_spans(t[rows], height[rows, None] - level)).tolist()
    return HeightModel(level, noise * noise + colour * colour, colour * colour, manoeuvre)


def smooth_height(
    t: FloatArray, height: FloatArray, used: BoolArray, model: HeightModel, part: slice
) -> tuple[FloatArray, FloatArray]:
    """Heights along a part of the track and their variances.

    Parameters
    ----------
    t : ndarray, shape (m,)
        Seconds, ascending.
    height : ndarray, shape (m,)
        Metres; NaN where there is none.
    used : ndarray of bool, shape (m,)
        Rows whose heights count.
    model : HeightModel
    part : slice

    Returns
    -------
    height, variance : ndarray, shape (rows of the part,)
    """
    first, stop = part.start, part.stop
    while first > 0 and np.count_nonzero(used[first : part.start]) < HALO:
        first = max(0, first - HALO)
    while stop < t.size and np.count_nonzero(used[part.stop : stop]) < HALO:
        stop = min(t.size, stop + HALO)
    around = slice(first, stop)
    t, used = t[around], used[around]
    measured = np.where(used, height[around] - model.level_m, 0.0)
    variance = np.where(used, model.variance, _UNMEASURED)
    out, spread = np.zeros(t.size), np.zeros(t.size)
    for _ in range(_STEPS):
        smooth_line(t, measured, variance, model.manoeuvre, out, spread)
        off = (measured - out) ** 2 + spread
        weight = (_DOF + 1.0) / (_DOF + off / model.variance)
        variance = np.where(used, model.variance / weight, _UNMEASURED)
    own = slice(part.start - first, part.stop - first)
    # White noise averages out, coloured noise does not.
    return out[own] + model.level_m, np.maximum(spread[own] + model.coloured, 1e-6)
