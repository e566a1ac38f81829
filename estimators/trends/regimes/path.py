"""The cheapest way along the series: which candidate line each reading follows, where a change costs.

Exact dynamic programming (Viterbi's) over lines, in time proportional to readings times lines: minimise
the sum of losses plus a price per change of line.
"""

from __future__ import annotations

import itertools

import numpy as np

from estimators.arrays import FloatArray, IntArray


def cheapest_path(loss: FloatArray, price: float) -> IntArray:
    """Choose a line per reading.

    Parameters
    ----------
    loss : ndarray of float64, shape (n, k)
        Loss of reading i under line j.
    price : float
        Of a change from one line to another.

    Returns
    -------
    ndarray of int64, shape (n,)
        Line of each reading; of equally cheap ones the first.

    Examples
    --------
    >>> cheapest_path(np.array([[0, 9.0], [0, 9], [9, 0], [0, 9], [0, 9], [9, 0], [9, 0], [9, 0]]), 10.0)
    array([0, 0, 0, 0, 0, 1, 1, 1])
    """
    n, lines = loss.shape
    total = loss[0].copy()
    stays = np.ones((n, lines), dtype=np.bool_)
    origin = np.zeros(n, dtype=np.int64)
    for row in range(1, n):
        cheapest = int(np.argmin(total))
        changed = total[cheapest] + price
        np.less_equal(total, changed, out=stays[row])
        origin[row] = cheapest
        np.minimum(total, changed, out=total)
        total += loss[row]
    path = np.empty(n, dtype=np.int64)
    line = int(np.argmin(total))
    for row in range(n - 1, -1, -1):
        path[row] = line
        if not stays[row, line]:
            line = int(origin[row])
    return path


def runs_of(path: IntArray) -> list[tuple[int, int]]:
    """Start and stop of the runs of equal lines.

    Examples
    --------
    >>> runs_of(np.array([4, 4, 1, 1, 1]))
    [(0, 2), (2, 5)]
    """
    edges = [0, *(np.flatnonzero(np.diff(path)) + 1).tolist(), int(path.size)]
    return list(itertools.pairwise(edges))
