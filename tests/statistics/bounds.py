"""Binomial bounds: what a claimed rate lets happen in a number of draws, but for one time in ten thousand."""

from __future__ import annotations

from scipy.stats import binom

SURE = 0.9999


def most(draws: int, rate: float) -> int:
    """Largest plausible count of events that happen at most at this rate."""
    return int(binom.ppf(SURE, draws, rate))


def fewest(draws: int, rate: float) -> int:
    """Smallest plausible count of events that happen at least at this rate."""
    return int(binom.ppf(1.0 - SURE, draws, rate))
