"""What the ranges of each epoch say to a place that is given: clocks, residuals, and how likely they are."""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import FloatArray, IntArray
from estimators.gnss.series.epoch_clocks import fit_clock, geometry
from estimators.kernels import kernel, ro


@kernel(
    types.void(
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.int64),
        ro(types.int64),
        ro(types.int64),
        types.boolean,
        types.float64,
        types.float64,
        ro(types.float64, 2),
        types.float64[:, ::1],
        types.float64[::1],
        types.float64[::1],
        types.float64[::1],
    )
)
def score_places(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    offsets: IntArray,
    clocks: IntArray,
    rotated: bool,
    fault_prior: float,
    scale: float,
    places: FloatArray,
    clock_m: FloatArray,
    likelihood: FloatArray,
    residual: FloatArray,
    healthy: FloatArray,
) -> None:
    """Score a place for each epoch.

    Parameters
    ----------
    satellites, ranges, sigma, clock, offsets, clocks : ndarray
        As in :func:`estimators.gnss.snapshot.epochs.answer_epochs`.
    rotated : bool
    fault_prior, scale : float
    places : ndarray, shape (epochs, 3)
        Earth-centred, Earth-fixed.
    clock_m : ndarray, shape (epochs, MOST_CLOCKS)
        Out: the likeliest clocks; untouched where there are no ranges.
    likelihood : ndarray, shape (epochs,)
        Out: log density of the ranges at those clocks.
    residual, healthy : ndarray, one entry per row
        Out: metres, and the probability that the range is healthy.
    """
    left = np.empty(ranges.size)
    unit = np.empty(3)
    for e in range(offsets.size - 1):
        first, last = offsets[e], offsets[e + 1]
        likelihood[e] = 0.0
        for i in range(first, last):
            left[i] = ranges[i] - geometry(satellites[i], rotated, places[e], unit)
        for which in range(clocks[e]):
            clock_m[e, which], density = fit_clock(
                left,
                sigma,
                clock,
                first,
                last,
                which,
                scale,
                fault_prior,
                np.nan,
                1.0,
                residual,
                healthy,
            )
            likelihood[e] += density
