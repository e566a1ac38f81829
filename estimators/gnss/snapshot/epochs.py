"""Many epochs through the compiled snapshot solver; one epoch is a batch of one.

Per epoch: Gauss-Newton from the Earth's centre over all satellites, the posterior over fault sets in parity
space, a choice (or the caller's), the solution without the excluded satellites, and protection levels. After
gross faults the linearisation point is far off, so the posterior is computed again about the new position.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.geodesy.local_frame import fill_enu_axes
from estimators.gnss.snapshot.decision import (
    CANDIDATES,
    HEAVY,
    exclude,
    fault_probabilities,
    heaviest,
    smallest_subset,
    solve_tail,
    tail,
    to_local,
)
from estimators.gnss.snapshot.fault_sets import CAPACITY, is_exhaustive, weigh_fault_sets
from estimators.gnss.snapshot.fault_weight import LARGEST_SET
from estimators.gnss.snapshot.linearise import factorise, fill_normal, iterate
from estimators.gnss.snapshot.parity import fill_inverse, fill_parity
from estimators.kernels import device, kernel, ro

MOST_CLOCKS = 8
MOST_SATELLITES = 256
NUMBERS = 8
SOLVED, TOO_FEW, UNDETERMINED, UNSETTLED = 0, 1, 2, 3
"""Statuses of an epoch."""
_ROUNDS = 3
_FAR_M = 1000.0
"""Beyond this the curvature of the ranges, d^2 / (2 rho), passes 2 cm; the posterior is computed again."""
_INDIFFERENT = 1e-3
"""Of sets whose positions are far off with probabilities this close to the least, the likeliest is taken."""
_UNSUPPORTED = 0.3
"""Share of the 99.9 % limit of chi square that an excluded satellite must at least explain."""


@device
def _project(S: FloatArray, gain: FloatArray, z: FloatArray, left: FloatArray, centre: FloatArray) -> float:
    """Residuals of the least-squares solution and its position, from those at any linearisation point."""
    squares = 0.0
    for k in range(3):
        centre[k] = 0.0
    for i in range(z.size):
        held = 0.0
        for j in range(z.size):
            held += S[i, j] * z[j]
        left[i] = held
        squares += held * held
        for k in range(3):
            centre[k] += gain[k, i] * z[i]
    return squares


@device
def _answer(
    satellites: FloatArray,
    ranges: FloatArray,
    sigma: FloatArray,
    clock: IntArray,
    p: int,
    rotated: bool,
    given: BoolArray,
    choose: bool,
    fault_prior: float,
    shape: float,
    scale: float,
    alert_m: float,
    risk: float,
    limits: FloatArray,
    members: IntArray,
    sizes: IntArray,
    weights: FloatArray,
    excluded: BoolArray,
    rival: BoolArray,
    probability: FloatArray,
    state: FloatArray,
    rival_position: FloatArray,
    numbers: FloatArray,
) -> int:
    """One epoch; see :func:`answer_epochs` for what is written."""
    n = ranges.size
    freedom = n - p
    A, z, left = np.empty((n, p)), np.empty(n), np.empty(n)
    factor, N, step = np.empty((p, p)), np.empty((p, p)), np.empty(p)
    gain, S, axes = np.empty((p, n)), np.empty((n, n)), np.empty((3, 3))
    used = np.ones(n, np.bool_)
    centre, shift, moved = np.empty(3), np.empty(3), np.empty(3)
    spread = np.empty((3, 3))
    kept = np.empty(n, np.int64)
    places, shares = np.empty(HEAVY, np.int64), np.empty(HEAVY)
    place, height = np.empty((HEAVY, 3)), np.empty(HEAVY)
    variance, vertical, distance, rise = np.empty(HEAVY), np.empty(HEAVY), np.empty(HEAVY), np.empty(HEAVY)
    risks = np.empty(CANDIDATES)
    nu = 2.0 * shape + freedom
    order = np.argsort(ranges, kind="mergesort")

    for j in range(p):
        state[j] = 0.0
    if not iterate(satellites, ranges, sigma, clock, rotated, used, state, A, z, factor, step):
        return UNDETERMINED
    squares = 0.0
    count = 0
    heavy, found = 0, 0
    for turn in range(_ROUNDS):
        fill_inverse(factor, N)
        fill_parity(A, N, gain, S)
        squares = _project(S, gain, z, left, centre)
        fill_enu_axes(state[0], state[1], state[2], axes)
        suspicious = squares >= limits[min(freedom, limits.size - 1)]
        found = weigh_fault_sets(
            A, S, left, sigma, clock, order, freedom, suspicious, fault_prior, shape, scale,
            members, sizes, weights,
        )  # fmt: skip
        heavy = heaviest(weights, found, places, shares)
        fault_probabilities(members, sizes, weights, found, probability)
        best, least, unit = 0, math.inf, 0.0
        for h in range(heavy):
            explained = exclude(S, left, gain, members[places[h]], sizes[places[h]], shift, spread)
            for k in range(3):
                shift[k] += centre[k]
                for j in range(3):
                    spread[k, j] += N[k, j]
            across, up = to_local(axes, shift, spread, place[h])
            held = (2.0 * scale + max(0.0, squares - explained)) / nu
            variance[h] = across * held
            vertical[h] = up * held
        count = 0
        if choose:
            for h in range(min(heavy, CANDIDATES)):
                for g in range(heavy):
                    distance[g] = math.hypot(place[h, 0] - place[g, 0], place[h, 1] - place[g, 1])
                risks[h] = tail(alert_m, distance[:heavy], variance[:heavy], nu, shares[:heavy])
                least = min(least, risks[h])
            while risks[best] > least + _INDIFFERENT:
                best += 1
            chosen = members[places[best]]
            size = sizes[places[best]]
            if suspicious and size > 0:
                explained = exclude(S, left, gain, chosen, size, shift, spread)
                unit = (2.0 * scale + max(0.0, squares - explained)) / nu
                count = smallest_subset(
                    S, left, gain, axes, chosen, size, 0.25 * alert_m, _UNSUPPORTED * unit * limits, kept
                )
        else:
            for i in range(n):
                if given[i]:
                    kept[count] = i
                    count += 1
        for i in range(n):
            used[i] = True
        for row in range(count):
            used[kept[row]] = False
        before = state[:3].copy()
        if not iterate(satellites, ranges, sigma, clock, rotated, used, state, A, z, factor, step):
            return UNSETTLED
        far = math.sqrt(
            (state[0] - before[0]) ** 2 + (state[1] - before[1]) ** 2 + (state[2] - before[2]) ** 2
        )
        if far < _FAR_M or turn == _ROUNDS - 1:
            # Local positions of the hypotheses, seen from the answer.
            for k in range(3):
                shift[k] = state[k] - before[k]
            to_local(axes, shift, spread, moved)
            break
        for i in range(n):
            used[i] = True
        fill_normal(A, z, used, factor, step)
        if not factorise(factor):
            return UNDETERMINED

    for i in range(n):
        excluded[i] = False
    for row in range(count):
        excluded[kept[row]] = True
    farthest, other = -1.0, -1
    for h in range(heavy):
        distance[h] = math.hypot(place[h, 0] - moved[0], place[h, 1] - moved[1])
        rise[h] = abs(place[h, 2] - moved[2])
        height[h] = place[h, 2]
        if distance[h] > 0.5 * alert_m and shares[h] > farthest:
            farthest = shares[h]
            other = h
    numbers[0] = tail(alert_m, distance[:heavy], variance[:heavy], nu, shares[:heavy])
    numbers[1] = solve_tail(risk, distance[:heavy], variance[:heavy], nu, shares[:heavy])
    numbers[2] = solve_tail(risk, rise[:heavy], vertical[:heavy], nu, shares[:heavy])
    numbers[3] = squares
    numbers[4] = max(0.0, farthest)
    numbers[5] = distance[other] if other >= 0 else 0.0
    numbers[6] = found
    numbers[7] = 1.0 if is_exhaustive(n, freedom) else 0.0
    for k in range(3):
        rival_position[k] = math.nan
    for i in range(n):
        rival[i] = False
    if other >= 0:
        for row in range(sizes[places[other]]):
            rival[members[places[other], row]] = True
        for k in range(3):
            rival_position[k] = before[k]
            for row in range(3):
                rival_position[k] += axes[row, k] * place[other, row]
    return SOLVED


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
    excluded, rival, probability : ndarray, one entry per satellite and epoch
        Out: left out of the answer, left out by the competing set, probability to be faulty.
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
        status[e] = _answer(
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
            state[e, :p],
            rival_position[e],
            numbers[e],
        )
