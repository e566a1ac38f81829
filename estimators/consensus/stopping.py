"""When enough samples have been drawn: pure formulas, exact rather than approximate.

A minimal sample is drawn without replacement, so the chance that it is clean is hypergeometric
(Schonberger, Larsson & Pollefeys 2025; METHODS.md 2.2). The functions here are plain Python; the engine and
the compiled path both run the compiled twins at the end, so that they stop at the same draw.
"""

from __future__ import annotations

import math

from estimators.arrays import IntArray
from estimators.kernels import device

UNBOUNDED = 1 << 62
"""Stands for "no number of draws is enough"; capped before it could overflow (METHODS.md 13.19)."""


def clean_probability(inliers: int, n: int, s: int) -> float:
    """Chance that s distinct points drawn from n are all among the inliers: C(I, s) / C(n, s).

    Parameters
    ----------
    inliers, n, s : int
        Inliers, points, sample size.

    Returns
    -------
    float

    Examples
    --------
    >>> round(clean_probability(6, 9, 4), 4)
    0.119
    """
    if inliers < s or n < s:
        return 0.0
    probability = 1.0
    for i in range(s):
        probability *= (inliers - i) / (n - i)
    return probability


def log_miss_per_draw(probability: float) -> float:
    """ln(1 - p): logarithm of the chance that one draw is not clean."""
    if probability >= 1.0:
        return -math.inf
    return math.log1p(-probability)


def draws_needed(log_miss: float, confidence: float) -> int:
    """Smallest k with k ln(1 - p) <= ln(1 - P), at least 1.

    Parameters
    ----------
    log_miss : float
        ln(1 - p) of one draw.
    confidence : float
        P, below 1.

    Returns
    -------
    int
        :data:`UNBOUNDED` where p is 0.

    Examples
    --------
    >>> draws_needed(log_miss_per_draw(clean_probability(6, 9, 4)), 0.99)
    37
    """
    if log_miss == 0.0:
        return UNBOUNDED
    if log_miss == -math.inf:
        return 1
    needed = math.log1p(-confidence) / log_miss
    if needed >= float(UNBOUNDED):
        return UNBOUNDED
    return max(1, math.ceil(needed))


def distinct_success(inliers: int, n: int, s: int, drawn: int) -> float:
    """Chance of at least one clean sample among ``drawn`` *different* minimal samples.

    With T = C(n, s) subsets of which G = C(I, s) are clean it is 1 - C(T - G, k) / C(T, k); certainty from
    k = T - G + 1 on (METHODS.md 2.2, second level).

    Examples
    --------
    >>> distinct_success(6, 9, 4, 32) >= 0.99 > distinct_success(6, 9, 4, 31)
    True
    """
    total, clean = math.comb(n, s), math.comb(inliers, s)
    if drawn > total - clean:
        return 1.0
    log_miss = 0.0
    for i in range(clean):
        log_miss += math.log1p(-drawn / (total - i))
    return -math.expm1(log_miss)


@device
def fill_nonrandom_minima(n: int, s: int, beta: float, psi: float, minima: IntArray) -> None:
    """Smallest number of inliers among the m best points that chance does not explain, for m = s .. n.

    ``minima[m]`` is the smallest j with P(Bin(m - s, beta) >= j - s) < psi (Chum & Matas 2005). One walk
    along m keeps the binomial tail at the current j by its recurrences, so that the table costs O(n).
    """
    excess, mass, tail = 0, 1.0, 1.0
    for m in range(s, n + 1):
        trials = m - s
        if trials > 0:
            # From Bin(trials - 1) to Bin(trials), at the same excess k: the tail gains beta * pmf(k - 1).
            if excess > 0:
                below = mass * excess * (1.0 - beta) / ((trials - excess) * beta) if trials > excess else 0.0
                if trials == excess:
                    below = beta ** (excess - 1)
                tail += beta * below
            mass = mass * trials * (1.0 - beta) / (trials - excess) if trials > excess else beta**excess
        while tail >= psi:
            tail -= mass
            mass = mass * (trials - excess) * beta / ((excess + 1) * (1.0 - beta)) if excess < trials else 0.0
            excess += 1
            if excess > trials:
                tail, mass = 0.0, 0.0
        minima[m] = s + excess


clean_probability_compiled = device(clean_probability)
log_miss_per_draw_compiled = device(log_miss_per_draw)
draws_needed_compiled = device(draws_needed)
