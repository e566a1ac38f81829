"""Blocks of neighbours, drawn anew: how resampling keeps the serial correlation of a series.

Every draw is a hash of seed, replicate and place (:mod:`estimators.consensus.randomness`), so that replicate
17 is the same whatever else is drawn.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.randomness import as_counter, random_block

_BOOTSTRAP, _SHUFFLE = 16, 17
_LEAST_BLOCKS = 6
"""A series is cut into no fewer blocks; orders of fewer are too few for a 1 % level (6! = 720)."""


def block_length(n: int, lag1: float) -> int:
    """Length of a block: 1.75 n^(1/3), or more under strong correlation.

    Parameters
    ----------
    n : int
    lag1 : float
        Lag-1 correlation, 0 up to less than 1.

    Returns
    -------
    int

    Notes
    -----
    For an AR(1) series the length that estimates a variance best is (2 rho / (1 - rho^2))^(2/3) n^(1/3)
    (Carlstein 1986); METHODS.md 12 gives the default.

    Examples
    --------
    >>> block_length(80, 0.0), block_length(80, 0.8), block_length(8, 0.0)
    (8, 12, 1)
    """
    carlstein = math.cbrt((2.0 * lag1 / (1.0 - lag1 * lag1)) ** 2)
    wanted = max(1.75, carlstein) * math.cbrt(n)
    return max(1, min(round(wanted), n // _LEAST_BLOCKS))


def block_correction(n: int, length: int, coefficients: int) -> float:
    """Factor by which deviations in resampled blocks of residuals fall short of the real ones.

    Parameters
    ----------
    n, length : int
    coefficients : int
        Fitted to the series, p.

    Returns
    -------
    float

    Notes
    -----
    A fit makes its residuals add up to 0, which takes p l / n of the variance of the sum over a block of l,
    and p / n of that of a point: the hat matrix summed over a block, averaged over the blocks of the circle.

    Examples
    --------
    >>> block_correction(80, 1, 2), round(block_correction(80, 8, 2), 3)
    (1.0, 1.104)
    """
    return math.sqrt((n - coefficients) / max(n - coefficients * length, 1))


def drawn_blocks(n: int, length: int, seed: int, replicate: int) -> IntArray:
    """Rows of a resampled series: blocks drawn with replacement, circular (Politis & Romano 1992).

    Parameters
    ----------
    n, length : int
    seed, replicate : int

    Returns
    -------
    ndarray of int64, shape (n,)

    Examples
    --------
    >>> rows = drawn_blocks(10, 5, 0, 3)
    >>> bool(np.all((rows[1:5] - rows[:4]) % 10 == 1))
    True
    """
    count = -(-n // length)
    starts = np.floor(_uniform(seed, _BOOTSTRAP, replicate, count) * n).astype(np.int64)
    rows = (starts[:, None] + np.arange(length)[None, :]).reshape(-1)[:n]
    return np.asarray(rows % n)


def shuffled_blocks(n: int, length: int, seed: int, replicate: int) -> IntArray:
    """Rows of a permuted series: cut into blocks at a random place of the circle and put in random order.

    Parameters
    ----------
    n, length : int
        Blocks of one point permute the points.
    seed, replicate : int

    Returns
    -------
    ndarray of int64, shape (n,)
        Each row once.

    Examples
    --------
    >>> sorted(shuffled_blocks(7, 3, 0, 1).tolist())
    [0, 1, 2, 3, 4, 5, 6]
    """
    count = -(-n // length)
    drawn = _uniform(seed, _SHUFFLE, replicate, count + 1)
    shift = int(drawn[count] * n)
    edges = np.arange(count + 1) * length
    edges[-1] = n
    rows = [np.arange(edges[k], edges[k + 1]) for k in np.argsort(drawn[:count], kind="stable").tolist()]
    return np.asarray((np.concatenate(rows) + shift) % n)


def _uniform(seed: int, stream: int, replicate: int, draws: int) -> FloatArray:
    """Numbers in [0, 1) from the upper 53 bits."""
    bits = random_block(as_counter(seed), stream, replicate, 1, draws)[0]
    return np.asarray((bits >> np.uint64(11)) * math.ldexp(1.0, -53), dtype=np.float64)
