"""Hypotheses of whole stretches of a series: what outliers that come in runs leave clean.

Where contamination lasts, neighbours are clean together (Myatt et al. 2002, for neighbours in space), so that
a few stretches are clean far more often than as many points as they hold. Least squares on all their points
is the better for having more of them than coefficients.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.bases.weighing import normal_step
from estimators.consensus.samplers.draws import bind_sampler
from estimators.consensus.samplers.far_apart import FarApart
from estimators.kernels import kernel, ro

STRETCHES = {2: 200, 3: 400}
"""Draws by number of stretches: the more stretches, the rarer are draws all of which are clean."""

POINTS_PER_COEFFICIENT = 2.0
LEAST_SHARE = 0.06
"""Least length of a stretch, as a share of the series."""

_NO_ORDER: IntArray = np.empty(0, dtype=np.int64)
_f8 = types.float64


def stretch_hypotheses(columns: FloatArray, y: FloatArray, t: FloatArray, weights: FloatArray) -> FloatArray:
    """Least-squares fits of stretches far from one another.

    Parameters
    ----------
    columns : ndarray of float64, shape (p, n), C-contiguous
    y : ndarray of float64, shape (n,)
    t : ndarray of float64, shape (n,)
        Ascending.
    weights : ndarray of float64, shape (n,)
        Precisions.

    Returns
    -------
    ndarray of float64, shape (k, p)
        Without those whose points do not determine the coefficients.
    """
    p, n = columns.shape
    found = []
    for count, draws in STRETCHES.items():
        length = max(math.ceil(POINTS_PER_COEFFICIENT * p / count), math.ceil(LEAST_SHARE * n))
        if count * length > n // 2:
            continue
        middles = bind_sampler(FarApart.code, t, count, _NO_ORDER, 0, draws, 0).block(0, draws)
        starts = np.clip(middles - length // 2, 0, n - length)
        thetas = np.empty((draws, p))
        made = _fit_stretches(columns, y, weights, np.ascontiguousarray(starts), length, thetas)
        found.append(thetas[:made])
    return np.vstack([np.empty((0, p)), *found])


@kernel(types.int64(ro(_f8, 2), ro(_f8), ro(_f8), ro(types.int64, 2), types.int64, _f8[:, ::1]))
def _fit_stretches(
    columns: FloatArray, y: FloatArray, weights: FloatArray, starts: IntArray, length: int, thetas: FloatArray
) -> int:
    """Write the fits that are determined, in order; return how many. Overlaps count twice."""
    p = columns.shape[0]
    draws, count = starts.shape
    some = np.empty((p, count * length))
    value = np.empty(count * length)
    weight = np.empty(count * length)
    gram = np.empty((p, p))
    step = np.empty(p)
    made = 0
    for d in range(draws):
        place = 0
        for s in range(count):
            for i in range(starts[d, s], starts[d, s] + length):
                for j in range(p):
                    some[j, place] = columns[j, i]
                value[place] = y[i]
                weight[place] = weights[i]
                place += 1
        if not math.isnan(normal_step(some, value, weight, gram, step)):
            thetas[made] = step
            made += 1
    return made
