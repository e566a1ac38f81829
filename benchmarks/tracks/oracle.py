"""A smoother that knows which fixes lie: what cleaning is held against.

Faulty fixes are dropped, the noise of the others is the true one, and the motion is of constant velocity
driven by white acceleration (Rauch, Tung and Striebel 1965) whose density is the best of a grid, chosen with
the truth. It can be beaten: fixes of a burst tell of velocity, and noise that lasts is not white.
"""

from __future__ import annotations

import numpy as np

from benchmarks.tracks.recording import Recording
from estimators.arrays import BoolArray, FloatArray

DENSITIES = np.logspace(-4.0, 3.0, 15)
"""Of the white acceleration, m^2/s^3."""
_UNKNOWN_MPS2 = 100.0**2


def smooth_knowing(recording: Recording) -> float:
    """Root mean square error in metres of the best smoother of the grid."""
    order = np.argsort(recording.t_s, kind="stable")
    used = ~recording.faulty[order]
    truth = recording.plane_m(recording.true_lat_deg, recording.true_lon_deg)[order]
    fixes = recording.plane_m(recording.lat_deg, recording.lon_deg)[order]
    smoothed = rts_smooth(recording.t_s[order], fixes, recording.sigma_m[order] ** 2, used, DENSITIES)
    square = np.sum((smoothed - truth[None]) ** 2, axis=2)
    return float(np.sqrt(np.min(np.mean(square, axis=1))))


def rts_smooth(
    t_s: FloatArray, fixes: FloatArray, variance: FloatArray, used: BoolArray, densities: FloatArray
) -> FloatArray:
    """Smooth for every density at once.

    Parameters
    ----------
    t_s : ndarray, shape (n,)
        Ascending.
    fixes : ndarray, shape (n, 2)
    variance : ndarray, shape (n,)
        Of a fix, per axis.
    used : ndarray of bool, shape (n,)
        The others are only foretold.
    densities : ndarray, shape (g,)

    Returns
    -------
    ndarray, shape (g, n, 2)
    """
    n, g = t_s.size, densities.size
    first = int(np.flatnonzero(used)[0])
    state = np.zeros((g, 2, 2))  # density, position or velocity, axis
    state[:, 0] = fixes[first]
    # Covariances are the same for both axes: pp, pv, vv.
    p = np.zeros((g, 3))
    p[:, 0], p[:, 2] = _UNKNOWN_MPS2 + 4.0 * variance[first], _UNKNOWN_MPS2
    foretold, before = np.empty((n, g, 2, 2)), np.empty((n, g, 3))
    states, after = np.empty((n, g, 2, 2)), np.empty((n, g, 3))
    steps = np.diff(t_s, prepend=t_s[0])
    for k in range(n):
        dt = steps[k]
        state = np.stack([state[:, 0] + dt * state[:, 1], state[:, 1]], axis=1)
        p = np.stack(
            [
                p[:, 0] + dt * (2.0 * p[:, 1] + dt * p[:, 2]) + densities * dt**3 / 3.0,
                p[:, 1] + dt * p[:, 2] + densities * dt**2 / 2.0,
                p[:, 2] + densities * dt,
            ],
            axis=1,
        )
        foretold[k], before[k] = state, p
        if used[k]:
            gain = p[:, :2] / (p[:, :1] + variance[k])
            state = state + gain[:, :, None] * (fixes[k] - state[:, 0])[:, None, :]
            p = np.stack(
                [
                    p[:, 0] * (1.0 - gain[:, 0]),
                    p[:, 1] * (1.0 - gain[:, 0]),
                    p[:, 2] - gain[:, 1] * p[:, 1],
                ],
                axis=1,
            )
        states[k], after[k] = state, p
    for k in range(n - 2, -1, -1):
        dt, filtered, ahead = steps[k + 1], after[k], before[k + 1]
        # C = P F' inv(P-), two by two, written out.
        left = np.stack([filtered[:, 0] + dt * filtered[:, 1], filtered[:, 1]], axis=1)
        right = np.stack([filtered[:, 1] + dt * filtered[:, 2], filtered[:, 2]], axis=1)
        determinant = ahead[:, 0] * ahead[:, 2] - ahead[:, 1] ** 2
        to_p = np.stack(
            [
                left[:, 0] * ahead[:, 2] - left[:, 1] * ahead[:, 1],
                left[:, 1] * ahead[:, 0] - left[:, 0] * ahead[:, 1],
            ],
            axis=1,
        )
        to_v = np.stack(
            [
                right[:, 0] * ahead[:, 2] - right[:, 1] * ahead[:, 1],
                right[:, 1] * ahead[:, 0] - right[:, 0] * ahead[:, 1],
            ],
            axis=1,
        )
        miss = states[k + 1] - foretold[k + 1]
        back = np.stack([to_p, to_v], axis=1) / determinant[:, None, None]
        states[k] = states[k] + np.einsum("gij,gja->gia", back, miss)
    return np.asarray(states[:, :, 0].transpose(1, 0, 2))
