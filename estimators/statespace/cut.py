r"""The cheapest cut of a chain into two labels, exactly.

The energy is that of Graph-Cut RANSAC (Barath and Matas 2018, equations 3 to 5), with weights w on the edges
of the chain. Label 1 is an inlier, K from 0 to 1 how close a point is to the model:

    E = (1 - lambda) sum_i [ K_i if L_i = 0; 1 - K_i if L_i = 1 ]
      + lambda sum_i w_i [ 1 if L_i != L_{i+1}; (K_i + K_{i+1}) / 2 if both are 0; 1 less that if both are 1 ]

On a chain Viterbi's recursion finds the minimum in O(n) (METHODS.md 6.3); general graphs need a maximum flow.
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray
from estimators.kernels import kernel, ro


@kernel(types.void(ro(types.float64), ro(types.float64), types.float64, types.boolean[::1]))
def cut_chain(closeness: FloatArray, weight: FloatArray, coherence: float, inlier: BoolArray) -> None:
    """Labels of least energy; of labels that cost the same, an inlier goes before an outlier.

    Parameters
    ----------
    closeness : ndarray, shape (n,)
        K of each point, 0 to 1.
    weight : ndarray, shape (n - 1,)
        w of each edge, 0 to 1.
    coherence : float
        lambda, 0 to 1; with 0 a point is an inlier if K >= 1/2.
    inlier : ndarray of bool, shape (n,)
        Out.
    """
    n = closeness.size
    if n == 0:
        return
    cheaper_from = np.zeros((n, 2), np.int8)
    alone = 1.0 - coherence
    out, kept = alone * closeness[0], alone * (1.0 - closeness[0])
    for k in range(1, n):
        edge = coherence * weight[k - 1]
        mean = 0.5 * (closeness[k - 1] + closeness[k])
        out_from_out, out_from_kept = out + edge * mean, kept + edge
        kept_from_out, kept_from_kept = out + edge, kept + edge * (1.0 - mean)
        if out_from_kept <= out_from_out:
            cheaper_from[k, 0] = 1
        if kept_from_kept <= kept_from_out:
            cheaper_from[k, 1] = 1
        out = min(out_from_out, out_from_kept) + alone * closeness[k]
        kept = min(kept_from_out, kept_from_kept) + alone * (1.0 - closeness[k])
    state = 1 if kept <= out else 0
    for k in range(n - 1, -1, -1):
        inlier[k] = state == 1
        state = cheaper_from[k, state]
