"""Many epochs through the compiled snapshot solver; one epoch is a batch of one."""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.snapshot.fault_sets import CAPACITY
from estimators.gnss.snapshot.fault_weight import LARGEST_SET
from estimators.gnss.snapshot.one_epoch import TOO_FEW, answer_epoch
from estimators.kernels import kernel, ro

MOST_CLOCKS = 8
MOST_SATELLITES = 256
NUMBERS = 8


@kernel(
    types.void(
        ro(types.float64, 2),
        ro(types.float64),
        ro(types.float64),
        ro(types.int64),
        ro(types.int64),
        ro(types.int64),
        types.boolean,
        ro(types.boolean),
        types.boolean,
        types.float64,
        types.float64,
        types.float64,
        types.float64,
        types.float64,
        ro(types.float64),
        types.boolean[::1],
        types.boolean[::1],
        types.float64[::1],
        types.float64[::1],
        types.float64[:, ::1],
        types.float64[:, ::1],
        types.float64[:, ::1],
        types.int64[::1],
    )
)
def answer_epochs(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    offsets: IntArray,
    clocks: IntArray,
    rotated: bool,
    given: BoolArray,
    choose: bool,
    fault_prior: float,
    shape: float,
    scale: float,
    alert_m: float,
    risk: float,
    limits: FloatArray,
    excluded: BoolArray,
    rival: BoolArray,
    probability: FloatArray,
    weight: FloatArray,
    state: FloatArray,
    rival_position: FloatArray,
    numbers: FloatArray,
    status: IntArray,
) -> None:
    """Solve epochs one after the other.

    Parameters
    ----------
    satellites, ranges, sigma, clock : ndarray, one row per satellite and epoch
    offsets : ndarray of int64, shape (epochs + 1,)
    clocks : ndarray of int64, shape (epochs,)
        Number of receiver clocks.
    rotated : bool
        Whether satellite positions are in the frame of the time of reception.
    given : ndarray of bool
        Satellites to exclude, where ``choose`` is False.
    choose : bool
        Whether the posterior decides what to exclude.
    fault_prior, shape, scale, alert_m, risk : float
        See :class:`estimators.gnss.options.PositionOptions`.
    limits : ndarray
        99.9 % limits of chi square, by degrees of freedom from 0.
    excluded, rival, probability, weight : ndarray, one entry per satellite and epoch
        Out: left out of the answer, left out by the competing set, probability to be faulty, what it counts.
    state : ndarray, shape (epochs, 3 + MOST_CLOCKS)
        Out: position and clocks in metres.
    rival_position : ndarray, shape (epochs, 3)
        Out; NaN where no set competes.
    numbers : ndarray, shape (epochs, NUMBERS)
        Out: tail at the alert limit, HPL, VPL, sum of squares of all, probability of the competing set, its
        horizontal distance, fault sets weighed, 1 if these are all that there are.
    status : ndarray of int64, shape (epochs,)
        Out.
    """
    members = np.empty((CAPACITY, LARGEST_SET), np.int64)
    sizes = np.empty(CAPACITY, np.int64)
    weights = np.empty(CAPACITY)
    for e in range(offsets.size - 1):
        a, b = offsets[e], offsets[e + 1]
        p = 3 + clocks[e]
        if b - a < p:
            status[e] = TOO_FEW
            continue
        status[e] = answer_epoch(
            satellites[a:b],
            ranges[a:b],
            sigma[a:b],
            clock[a:b],
            p,
            rotated,
            given[a:b],
            choose,
            fault_prior,
            shape,
            scale,
            alert_m,
            risk,
            limits,
            members,
            sizes,
            weights,
            excluded[a:b],
            rival[a:b],
            probability[a:b],
            weight[a:b],
            state[e, :p],
            rival_position[e],
            numbers[e],
        )
