"""What the clocks of some epochs tell of the others': whole milliseconds, smooth drifts, and where they lead.

Receivers of low cost set their clock back by whole milliseconds when it has run off; others set it to the
second in every epoch. Which it is shows in the clocks themselves.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.gnss.series.observed import Observations
from estimators.gnss.snapshot.epochs import MOST_CLOCKS
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT

MILLISECOND_M = 1e-3 * SPEED_OF_LIGHT
SMOOTH_CLOCK = (0.01, 0.01)
"""Densities of clock (m2/s) and drift (m2/s3) of a crystal oscillator, as tuned on driven receivers."""
FREE_CLOCK = (1e12, 0.01)
"""A clock about which one epoch tells the next nothing."""
_ROUGH_M = 50.0
_REACHES = (7, 3)
_LAGS = 3
_LEAST_STEP_S = 1e-3
_TELLING_M = 20.0
"""Clocks that their neighbours foretell less well settle no fault: faults have that size."""
_LEAST_SPREAD_M = 0.5
_MAD = 1.4826


def by_system(observations: Observations, clock_m: FloatArray) -> FloatArray:
    """Clocks in the order of the series' systems instead of the epoch's.

    Parameters
    ----------
    observations : Observations
    clock_m : ndarray, shape (epochs, MOST_CLOCKS)

    Returns
    -------
    ndarray, shape (epochs, systems)
        NaN where a system was not received.
    """
    out = np.full((len(observations), len(observations.letters)), np.nan)
    for k, letters in enumerate(observations.table.letters):
        for which, letter in enumerate(letters):
            out[k, observations.letters.index(letter)] = clock_m[k, which]
    return out


def jumps_of(clock_m: FloatArray) -> FloatArray:
    """Whole milliseconds, in metres, by which a clock was set since the first epoch.

    Parameters
    ----------
    clock_m : ndarray, shape (epochs,)
        NaN where unknown.

    Examples
    --------
    >>> (jumps_of(np.array([0.0, 5.0, 10.0 + MILLISECOND_M, 15.0 + MILLISECOND_M])) / MILLISECOND_M).tolist()
    [0.0, 0.0, 1.0, 1.0]
    """
    out = np.zeros(clock_m.size)
    known = np.flatnonzero(np.isfinite(clock_m))
    if known.size > 1:
        step = np.diff(clock_m[known])
        # The customary step is the drift; a jump stands out from it by whole milliseconds.
        whole = np.round((step - np.median(step)) / MILLISECOND_M)
        since = np.concatenate([[0.0], np.cumsum(whole)]) * MILLISECOND_M
        place = np.clip(np.searchsorted(known, np.arange(clock_m.size), side="right") - 1, 0, None)
        out = since[place]
    return out


def is_smooth(seconds: FloatArray, clock_m: FloatArray) -> bool:
    """Whether a clock goes on as it went: what is left of it after its drift is small.

    Parameters
    ----------
    seconds, clock_m : ndarray, shape (epochs,)
        Without jumps; NaN where unknown.
    """
    known = np.flatnonzero(np.isfinite(clock_m))
    if known.size < 3:
        return True
    dt = np.maximum(np.diff(seconds[known]), _LEAST_STEP_S)
    rate = np.diff(clock_m[known]) / dt
    off = np.diff(rate) * np.minimum(dt[1:], dt[:-1])
    allowed = _ROUGH_M + 3.0 * np.sqrt(SMOOTH_CLOCK[1] * float(np.median(dt)) ** 3)
    return bool(np.median(np.abs(off)) < allowed)


def expect_clocks(observations: Observations, clock_m: FloatArray) -> tuple[FloatArray, float] | None:
    """Clocks as their neighbours on both sides lead one to expect them.

    Epochs in which the clock was taken for that of the faulty satellites come in runs; medians over seven
    epochs on each side stand them, and three do where clocks wander.

    Parameters
    ----------
    observations : Observations
    clock_m : ndarray, shape (epochs, MOST_CLOCKS)

    Returns
    -------
    tuple of ndarray, shape (epochs, MOST_CLOCKS), and float, or None
        The clocks expected, NaN where there are not enough neighbours, and their spread in metres; None
        where clocks foretell too little.
    """
    systems = by_system(observations, clock_m)
    for reach in _REACHES:
        expected = np.full_like(systems, np.nan)
        for j in range(systems.shape[1]):
            known = np.flatnonzero(np.isfinite(systems[:, j]))
            if known.size > 2 * _LAGS:
                expected[known, j] = _foretold(observations.seconds[known], systems[known, j], reach)
        off = np.abs(systems - expected)
        if np.isfinite(off).any():
            spread = max(_MAD * float(np.nanmedian(off)), _LEAST_SPREAD_M)
            if spread <= _TELLING_M:
                return _by_epoch(observations, expected), 2.0 * spread
    return None


def _by_epoch(observations: Observations, systems: FloatArray) -> FloatArray:
    """Clocks in the order of each epoch's systems."""
    out = np.full((len(observations), MOST_CLOCKS), np.nan)
    for k, letters in enumerate(observations.table.letters):
        for which, letter in enumerate(letters):
            out[k, which] = systems[k, observations.letters.index(letter)]
    return out


def _foretold(seconds: FloatArray, clock_m: FloatArray, reach: int) -> FloatArray:
    """Clocks as the epochs around foretell them: medians of slopes and levels (Theil 1950, Sen 1968)."""
    jumps = jumps_of(clock_m)
    level = clock_m - jumps
    n, width = level.size, min(2 * reach + 1, level.size)
    every = np.arange(n)
    near = np.clip(every - reach, 0, n - width)[:, None] + np.arange(width)
    t, c = seconds[near], level[near]
    slopes = [
        (c[:, lag:] - c[:, :-lag]) / np.maximum(t[:, lag:] - t[:, :-lag], _LEAST_STEP_S)
        for lag in range(1, _LAGS + 1)
    ]
    rate = np.median(np.concatenate(slopes, axis=1), axis=1)
    from_each = c - rate[:, None] * (t - seconds[:, None])
    others = near != every[:, None]
    return np.asarray(np.median(from_each[others].reshape(n, width - 1), axis=1) + jumps)
