"""Which of very many points to draw: one per cell of a fine grid looks the same and costs a hundredth."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray, IntArray


def one_per_cell(x: FloatArray, y: FloatArray, columns: int, rows: int) -> IntArray:
    """Find the first point in every occupied cell of a grid laid over all points.

    Parameters
    ----------
    x, y : ndarray of float64, shape (n,)
        Finite.
    columns, rows : int
        Cells across and up, at least 1.

    Returns
    -------
    ndarray of int64, shape (m,)
        Ascending; m <= min(n, columns * rows).

    Examples
    --------
    >>> one_per_cell(np.array([0.0, 0.01, 1.0]), np.array([0.0, 0.01, 1.0]), 10, 10)
    array([0, 2])
    """
    if x.size == 0:
        return np.empty(0, dtype=np.int64)
    cell = _cells(x, columns) * rows + _cells(y, rows)
    first = np.full(columns * rows, -1, dtype=np.int64)
    # Written from the last point to the first, so that the first one stays.
    first[cell[::-1]] = np.arange(x.size - 1, -1, -1)
    return np.sort(first[first >= 0])


def _cells(values: FloatArray, count: int) -> IntArray:
    low, high = float(values.min()), float(values.max())
    # Halves, since the difference of two large numbers may overflow.
    span = high / 2 - low / 2
    if span <= 0.0:
        return np.zeros(values.size, dtype=np.int64)
    share = (values / 2 - low / 2) / span
    return np.minimum((share * count).astype(np.int64), count - 1)
