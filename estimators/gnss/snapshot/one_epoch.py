"""One epoch through the compiled snapshot solver.

Gauss-Newton from the Earth's centre over all satellites, the posterior over fault sets in parity space, a
choice (or the caller's), the solution without the excluded satellites, and protection levels about it. After
gross faults the linearisation point is far off, so the posterior is computed again about the new position.
Where the posterior chose, the satellites left are weighed by how well they agree; the caller's choice is
answered by plain least squares.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.geodesy.local_frame import fill_enu_axes
from estimators.gnss.snapshot.decision import (
    HEAVY,
    empty_share,
    exclude,
    fault_probabilities,
    heaviest,
    safest,
    smallest_subset,
    to_local,
)
from estimators.gnss.snapshot.fault_sets import is_exhaustive, weigh_fault_sets
from estimators.gnss.snapshot.linearise import factorise, fill_normal, iterate
from estimators.gnss.snapshot.parity import fill_inverse, fill_parity
from estimators.gnss.snapshot.reweigh import reweigh
from estimators.gnss.snapshot.tails import solve_tail, tail
from estimators.gnss.snapshot.untested import untested_weight
from estimators.kernels import device

SOLVED, TOO_FEW, UNDETERMINED, UNSETTLED = 0, 1, 2, 3
"""Statuses of an epoch."""
_ROUNDS = 3
_FAR_M = 1000.0
"""Beyond this the curvature of the ranges, d^2 / (2 rho), passes 2 cm; the posterior is computed again."""
_HEALTHY = 1e-5
"""Probability that no satellite is faulty below which the search for one needs no failed chi-square test:
where many satellites agree, they betray a fault that is small in units of the sigmas. Clean epochs of two
stations came down to 1e-3, faults of 20 m among 32 satellites lie at 1e-6 and less."""
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
def answer_epoch(
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
    weight: FloatArray,
    state: FloatArray,
    rival_position: FloatArray,
    numbers: FloatArray,
) -> int:
    """One epoch; see :func:`estimators.gnss.snapshot.epochs.answer_epochs` for what is written."""
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
    place = np.empty((HEAVY, 3))
    variance, vertical, distance, rise = np.empty(HEAVY), np.empty(HEAVY), np.empty(HEAVY), np.empty(HEAVY)
    nu = int(2.0 * shape + 0.5) + freedom
    order = np.argsort(ranges, kind="mergesort")

    for j in range(p):
        state[j] = 0.0
    if not iterate(satellites, ranges, sigma, clock, rotated, used, state, A, z, factor, step):
        return UNDETERMINED
    squares = 0.0
    count = 0
    heavy, found, anywhere = 0, 0, 0.0
    for turn in range(_ROUNDS):
        fill_inverse(factor, N)
        fill_parity(A, N, gain, S)
        squares = _project(S, gain, z, left, centre)
        fill_enu_axes(state[0], state[1], state[2], axes)
        found = weigh_fault_sets(
            A, S, left, sigma, clock, order, freedom, limits[freedom], fault_prior, shape, scale,
            members, sizes, weights,
        )  # fmt: skip
        untested = untested_weight(n, freedom, fault_prior, sizes, weights, found, weights[:found].max())
        heavy, anywhere = heaviest(weights, found, untested, risk, places, shares)
        fault_probabilities(members, sizes, weights, found, probability)
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
        # Nothing is left out of an epoch that may well be healthy.
        doubtful = squares >= limits[freedom] or empty_share(places[:heavy], shares[:heavy]) < _HEALTHY
        if choose and doubtful:
            h = safest(alert_m, place[:heavy], variance[:heavy], nu, shares[:heavy])
            chosen = members[places[h]]
            size = sizes[places[h]]
            explained = exclude(S, left, gain, chosen, size, shift, spread)
            unit = (2.0 * scale + max(0.0, squares - explained)) / nu
            count = smallest_subset(
                S, left, gain, axes, chosen, size, 0.25 * alert_m, _UNSUPPORTED * unit * limits, kept
            )
        elif not choose:
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
            break
        for i in range(n):
            used[i] = True
        fill_normal(A, z, used, factor, step)
        if not factorise(factor):
            return UNDETERMINED

    for i in range(n):
        excluded[i] = not used[i]
        weight[i] = 1.0 if used[i] else 0.0
    if choose:
        reweigh(A, z, used, state, weight)
    # Local positions of the hypotheses, seen from the answer.
    for k in range(3):
        shift[k] = state[k] - before[k]
    to_local(axes, shift, spread, moved)
    farthest, other = -1.0, -1
    for h in range(heavy):
        distance[h] = math.hypot(place[h, 0] - moved[0], place[h, 1] - moved[1])
        rise[h] = abs(place[h, 2] - moved[2])
        if distance[h] > 0.5 * alert_m and shares[h] > farthest:
            farthest = shares[h]
            other = h
    numbers[0] = anywhere + tail(alert_m, distance[:heavy], variance[:heavy], nu, shares[:heavy])
    numbers[1] = solve_tail(risk - anywhere, distance[:heavy], variance[:heavy], nu, shares[:heavy])
    numbers[2] = solve_tail(risk - anywhere, rise[:heavy], vertical[:heavy], nu, shares[:heavy])
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
