"""Scores of a fitted series: what each point says about level and slope, on the original time grid.

A score is psi(u_i) times the column of a coefficient; points that the estimate rejected have the score 0
and keep their place in time, so that lags stay what they are (METHODS.md 12).
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import FloatArray
from estimators.kernels import kernel, ro
from estimators.regression.influence import influence
from estimators.regression.loss import Loss

_f8 = types.float64
_EMPTY = np.empty(0)


@kernel(types.void(ro(_f8), ro(_f8), _f8, types.int64, _f8, ro(_f8), types.Array(_f8, 1, "C")))
def fill_scores(
    residual: FloatArray,
    root_weight: FloatArray,
    sigma: float,
    kind: int,
    c: float,
    table: FloatArray,
    scores: FloatArray,
) -> None:
    """Fill ``scores`` with psi(u_i) times the root of the weight."""
    root = 1.0
    for i in range(residual.size):
        if root_weight.size > 0:
            root = root_weight[i]
        psi, _, _ = influence(kind, c, 0.0, table, residual[i] * root / sigma)
        scores[i] = psi * root


def point_scores(
    residual: FloatArray, root_weight: FloatArray | None, sigma: float, loss: Loss
) -> FloatArray:
    """Score of every point for the level; times a column of the design, for its coefficient.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
    root_weight : ndarray of float64, shape (n,), or None
        Square roots of the precisions.
    sigma : float
        Noise scale.
    loss : Loss

    Returns
    -------
    ndarray of float64, shape (n,)

    Examples
    --------
    >>> from estimators.regression.loss import LossKind
    >>> point_scores(np.array([0.5, -9.0]), None, 1.0, Loss(LossKind.truncated, tuning=3.0)).tolist()
    [0.5, 0.0]
    """
    scores = np.empty(residual.size)
    roots = _EMPTY if root_weight is None else root_weight
    table = _EMPTY if loss.table is None else loss.table
    fill_scores(residual, roots, sigma, int(loss.kind), loss.tuning, table, scores)
    return scores
