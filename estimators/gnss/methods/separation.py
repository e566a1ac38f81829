"""Solution separation: how far the position moves when each fault mode is left out, and how far it may.

For each fault mode k: the solution without its satellites, x_k, with coefficients S_k on the whitened ranges.
x_k - x_0 has, without a fault, the variance |S_k - S_0|^2 per axis; beyond K sigma_ss it accuses the mode.
The protection level L of an axis bounds the risk that is left (Blanch et al. 2012, "Advanced RAIM user
algorithm description", ION GNSS; 2015, "Baseline advanced RAIM user algorithm and possible improvements",
IEEE Transactions on Aerospace and Electronic Systems 51):

    2 Q((L - b_0) / sigma_0) + sum_k p_k Q((L - T_k - b_k) / sigma_k) = PHMI (1 - P_unmonitored / PHMI_all).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from estimators.arrays import BoolArray, FloatArray
from estimators.gnss.methods.fault_modes import FaultModes
from estimators.gnss.snapshot.problem import Problem

_DETERMINED = 1e-10
"""Least eigenvalue of a scaled normal matrix that determines all unknowns."""
_MOVED = 1e-6
"""Metres that rounding may move a solution."""
_BISECTIONS = 60


@dataclass(frozen=True, slots=True)
class Separation:
    """Fault modes at east, north and up; those that leave no position are not among them.

    Attributes
    ----------
    modes : FaultModes
        Their unmonitored probability includes the modes that leave no position.
    distance, threshold : ndarray, shape (m, 3)
        |x_k - x_0| and what it may be without a fault, metres.
    sigma, bias : ndarray, shape (m + 1, 3)
        Of x_k, the solution of all that take part first, metres.
    """

    modes: FaultModes
    distance: FloatArray
    threshold: FloatArray
    sigma: FloatArray
    bias: FloatArray


def separate(
    problem: Problem,
    axes: FloatArray,
    present: BoolArray,
    modes: FaultModes,
    bias_m: float,
    false_alarm: float,
) -> Separation | None:
    """Solve the epoch without each fault mode.

    Parameters
    ----------
    problem : Problem
    axes : ndarray, shape (3, 3)
        East, north and up as rows.
    present : ndarray of bool, shape (n,)
        Satellites that take part.
    modes : FaultModes
    bias_m : float
        Largest bias of a healthy range.
    false_alarm : float
        Half of it for the height, a quarter for each horizontal axis.

    Returns
    -------
    Separation or None
        None where those that take part determine no position.
    """
    A, p = problem.A, problem.state.size
    kept = np.vstack([present, present & ~modes.faulty])
    normal = np.einsum("mi,ij,ik->mjk", kept.astype(np.float64), A, A)
    # A constellation that is gone leaves its clock without equations: any value does.
    diagonal = np.einsum("mjj->mj", normal)
    diagonal[:, 3:] += diagonal[:, 3:] == 0.0
    scale = 1.0 / np.sqrt(diagonal) if np.all(diagonal > 0.0) else np.ones_like(diagonal)
    determined = np.linalg.eigvalsh(normal * scale[:, :, None] * scale[:, None, :])[:, 0] > _DETERMINED
    if not determined[0]:
        return None
    normal[~determined] = np.eye(p)
    rows = axes @ np.linalg.inv(normal)[:, :3, :]
    coefficients = np.einsum("mqj,ij,mi->mqi", rows, A, kept.astype(np.float64))[determined]
    sigma = np.sqrt(np.sum(coefficients**2, axis=2))
    bias = np.abs(coefficients) @ (bias_m / problem.table.sigma_m)
    moved = coefficients[1:] - coefficients[0]
    spread = np.sqrt(np.sum(moved**2, axis=2))
    watched = determined[1:]
    count = max(1, int(watched.sum()))
    limit = -ndtri(np.array([0.25, 0.25, 0.5]) * false_alarm / (2 * count))
    return Separation(
        modes=FaultModes(
            modes.faulty[watched],
            modes.probability[watched],
            modes.unmonitored + float(modes.probability[~watched].sum()),
        ),
        distance=np.abs(moved @ problem.z),
        threshold=np.maximum(limit * spread, _MOVED),
        sigma=sigma,
        bias=bias,
    )


def protection_levels(separation: Separation, risk: float) -> tuple[float, float]:
    """Horizontal and vertical protection level.

    Parameters
    ----------
    separation : Separation
    risk : float
        Half of it for the height, a quarter for each horizontal axis.

    Returns
    -------
    tuple of float
        Metres; infinite where the unmonitored faults alone are likelier than the risk.
    """
    share = 1.0 - separation.modes.unmonitored / risk
    if share <= 0.0:
        return np.inf, np.inf
    wanted = np.array([0.25, 0.25, 0.5]) * risk * share
    low, high = np.zeros(3), separation.bias[0] + separation.sigma[0]
    while np.any(_risk(high, separation) > wanted):
        high = np.where(_risk(high, separation) > wanted, 2.0 * high, high)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        above = _risk(middle, separation) > wanted
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return float(np.hypot(high[0], high[1])), float(high[2])


def _risk(level: FloatArray, separation: Separation) -> FloatArray:
    """Probability, per axis, that an error beyond the level goes unnoticed."""
    healthy = 2.0 * ndtr((separation.bias[0] - level) / separation.sigma[0])
    over = (separation.threshold + separation.bias[1:] - level) / separation.sigma[1:]
    return np.asarray(healthy + separation.modes.probability @ ndtr(over))
