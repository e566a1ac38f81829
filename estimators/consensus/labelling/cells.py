"""The cells in which residuals are counted: what is known of them once the model and its scale are fixed.

Near the model cells are half a noise scale wide, on either side. Farther out they are octaves, so that the
tail of a law of inliers, which thins out with a power of the distance, can be told from errors, which do not.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.kernels import device

REACH = 8  # scales that are looked at closely; farther out the background is taken as level
CELLS = 2 * REACH  # of half a scale
OCTAVES = 40  # beyond; the last holds all that is farther
SLOTS = CELLS + OCTAVES
EDGES = np.concatenate((np.arange(CELLS + 1) / 2.0, REACH * 2.0 ** np.arange(1, OCTAVES), [np.inf]))
"""Distances in scales between which the cells of one side lie, shape (SLOTS + 1,)."""

_FARTHEST = REACH * 2.0 ** (OCTAVES - 1)
_FRACTION_BITS, _EXPONENT_OF_1 = 52, 1023
_LONG = 65536  # points beyond which a part of them is counted


@device
def count_residuals(
    residual: FloatArray, root_weight: FloatArray, sigma: float, counts: FloatArray
) -> tuple[float, float, float]:
    """Count whitened residuals per side and cell.

    Parameters
    ----------
    residual : ndarray of float64, shape (n,)
    root_weight : ndarray of float64, shape (n,) or (0,)
        Square roots of the precisions; none where empty.
    sigma : float
        Scale, positive.
    counts : ndarray of float64, shape (2, SLOTS)
        Counted into: below the model, above it.

    Returns
    -------
    tuple of float
        How many were counted, and in scales their range and the largest of their distances.
    """
    n = residual.size
    weighted = root_weight.size > 0
    stride = 1 + n // _LONG
    low = np.inf
    high = -np.inf
    total = 0.0
    inverse = 1.0 / sigma
    root = 1.0
    for i in range(0, n, stride):
        if weighted:
            root = root_weight[i]
        u = residual[i] * root * inverse
        low = min(low, u)
        high = max(high, u)
        away = abs(u) if abs(u) < _FARTHEST else _FARTHEST
        # The exponent of a float says its octave, quicker than a logarithm does.
        octave = (np.float64(away / REACH).view(np.int64) >> _FRACTION_BITS) - _EXPONENT_OF_1
        counts[1 if u > 0.0 else 0, CELLS + octave if octave >= 0 else int(2.0 * away)] += 1.0
        total += 1.0
    return total, high - low, max(high, -low)


@device
def octave_width(slot: int, farthest: float) -> float:
    """Width in scales of an octave of one side, as far as the residuals go but at least 1 scale."""
    return float(max(min(EDGES[slot + 1], farthest) - EDGES[slot], 1.0))
