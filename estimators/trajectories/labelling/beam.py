r"""Labels of a whole track: a beam over sequences of modes.

Every hypothesis is a Kalman filter with a history of labels; at each fix it branches into all that the fix
can be (:mod:`estimators.trajectories.labelling.modes`), and the likeliest go on. Two hypotheses of the same
mode whose states agree have the same future, so that they are merged: the likelier lends its state, and their
probabilities add up. Without that, a dozen copies that differ in one old label crowd out the one that turns
out right.

Every mode carries the same prior per sample, or bursts would become absorbing at high rates. The sum over the
hypotheses that are left is the likelihood of the track, by which parameters are chosen. The probability of a
fix to be good is what the hypotheses of a lag later say of it, those merged into them included.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import CodeArray, FloatArray
from estimators.kernels import device, kernel, ro
from estimators.trajectories.labelling.branches import (
    BRANCHES,
    GOOD,
    R_GROWTH,
    R_SPIKE,
    R_TELEPORT,
    R_WALK,
    R_WIDE,
    branch_burst,
    branch_nominal,
    fill_prior,
    take,
)
from estimators.trajectories.labelling.modes import (
    BURSTING,
    COLOUR_TIME_S,
    LEVEL_STRIDE,
    LONGEST_S,
    REACH_M,
    REDRAW,
    SPIKE,
    STILL_SPREAD_MPS,
    bias_walk,
)
from estimators.trajectories.labelling.state import are_twins, predict, start_at

WIDTH = 12
"""Hypotheses that are followed."""
_TOO_FAST = 30.0
"""What a speed above the top costs, as a logarithm."""
HOPELESS = 25.0
"""A branch exp(-25) times as likely as the best is not followed."""
_UNKNOWN_M = 1e4
"""Standard deviation of the position where the first fix is no good."""

_SHORTEST_S = 1e-6
"""Fixes of one time are reckoned so far apart, so that nothing is impossible between them."""


@kernel(
    types.float64(
        ro(types.float64),
        ro(types.float64, 2),
        ro(types.float64),
        types.float64,
        types.float64,
        ro(types.float64),
        types.int64,
        types.int64,
        types.float64,
        types.float64,
        types.uint8[::1],
        types.float64[::1],
    )
)
def label_track(
    t: FloatArray,
    fixes: FloatArray,
    variance: FloatArray,
    colour: float,
    manoeuvre: float,
    rates: FloatArray,
    lag: int,
    width: int,
    hopeless: float,
    top_speed: float,
    labels: CodeArray,
    probability: FloatArray,
) -> float:
    """Likeliest labels of a track.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Seconds, increasing.
    fixes : ndarray, shape (n, 2)
        East and north in metres.
    variance : ndarray, shape (n,)
        Of white noise, per axis.
    colour : float
        Standard deviation of coloured noise in metres.
    manoeuvre : float
        Spectral density of the acceleration, m^2/s^3.
    rates : ndarray, shape (8,)
    lag : int
        Fixes after which the probability of a fix is settled; 0 leaves probabilities alone.
    width : int
        Hypotheses that are followed, at most 127.
    hopeless : float
        A branch exp(-hopeless) times as likely as the best is not followed.
    top_speed : float
        m/s; what would be faster, three standard deviations allowed for, is not followed. May be infinite.
    labels : ndarray of uint8, shape (n,)
        Out.
    probability : ndarray, shape (n,)
        Out: of a fix to be neither a spike nor part of a burst.

    Returns
    -------
    float
        Log likelihood of the labelled track, given its first fix.
    """
    n = t.size
    # Two hypotheses of the first fix, whatever the width.
    room = max(width, 2)
    x, P = np.zeros((room, 2, 3)), np.zeros((room, 3, 3))
    new_x, new_P = np.zeros((room, 2, 3)), np.zeros((room, 3, 3))
    ahead, spread = np.zeros((room, 2, 3)), np.zeros((room, 3, 3))
    mode, new_mode = np.zeros(room, np.int64), np.zeros(room, np.int64)
    age, new_age = np.zeros(room), np.zeros(room)
    weight, new_weight = np.zeros(room), np.zeros(room)
    parent, kind_of = np.zeros((n, room), np.int8), np.zeros((n, room), np.int8)
    # Row k % lag: probability of fix k to be good, as a hypothesis and those merged into it see it.
    good, new_good = np.ones((room, max(lag, 1))), np.ones((room, max(lag, 1)))
    scores = np.empty(room * BRANCHES)
    kinds, origin = np.empty(room * BRANCHES, np.int64), np.empty(room * BRANCHES, np.int64)
    prior, last_dt = np.empty(10), -1.0
    squared_colour = colour * colour

    for first in range(2):
        start_at(x[first], P[first], fixes[0, 0], fixes[0, 1], variance[0], colour, STILL_SPREAD_MPS**2)
    P[1, 0, 0] += _UNKNOWN_M**2
    weight[0] = math.log1p(-rates[R_SPIKE] - rates[R_WIDE] - rates[R_TELEPORT])
    weight[1] = math.log(rates[R_SPIKE])
    kind_of[0, 1] = SPIKE
    good[1, 0] = 0.0
    used = 2
    total = 0.0
    for k in range(1, n):
        dt = min(max(t[k] - t[k - 1], _SHORTEST_S), LONGEST_S)
        east, north = fixes[k, 0], fixes[k, 1]
        if dt != last_dt:
            fade, last_dt = math.exp(-dt / COLOUR_TIME_S), dt
            fill_prior(dt, rates, prior)
        count = 0
        for h in range(used):
            bursting = mode[h] == BURSTING
            if bursting:
                bias = x[h, 0, 2] ** 2 + x[h, 1, 2] ** 2
                walk = dt * bias_walk(bias, colour, rates[R_WALK], rates[R_GROWTH])
                predict(x[h], P[h], dt, manoeuvre, 1.0, walk, ahead[h], spread[h])
            else:
                walk = squared_colour * (1.0 - fade * fade)
                predict(x[h], P[h], dt, manoeuvre, fade, walk, ahead[h], spread[h])
            place = max(spread[h, 0, 0], 0.0)
            base = max(place + 2.0 * spread[h, 0, 2] + spread[h, 2, 2], 0.0)
            squared, squared_place = 0.0, 0.0
            for axis in range(2):
                off = (east if axis == 0 else north) - ahead[h, axis, 0]
                squared_place += off * off
                off -= ahead[h, axis, 2]
                squared += off * off
            core = 9.0 * (variance[k] + squared_colour) + place
            reach = math.log(math.pi * math.log1p(REACH_M * REACH_M / core))
            before = count
            if bursting:
                count = branch_burst(
                    age[h], dt, weight[h], base, place + squared_colour, variance[k], squared,
                    squared_place, core, reach, prior, scores, kinds, count,
                )  # fmt: skip
            else:
                count = branch_nominal(
                    mode[h], weight[h], base, variance[k], squared, squared_place, core, reach, prior,
                    scores, kinds, count,
                )  # fmt: skip
            for branch in range(before, count):
                origin[branch] = h
        best = -math.inf
        for branch in range(count):
            best = max(best, scores[branch])
        total += best
        alive = 0
        for branch in range(count):
            if scores[branch] >= best - hopeless:
                scores[alive], kinds[alive], origin[alive] = scores[branch], kinds[branch], origin[branch]
                alive += 1
        kept = 0
        for _ in range(alive):
            if kept == width:
                break
            chosen = 0
            for branch in range(1, alive):
                if scores[branch] > scores[chosen]:
                    chosen = branch
            score = scores[chosen]
            scores[chosen] = -math.inf
            h = origin[chosen]
            kind, level = kinds[chosen] % LEVEL_STRIDE, kinds[chosen] // LEVEL_STRIDE
            for i in range(3):
                new_x[kept, 0, i] = ahead[h, 0, i]
                new_x[kept, 1, i] = ahead[h, 1, i]
                for j in range(i, 3):
                    new_P[kept, i, j] = spread[h, i, j]
            now = take(kind, level, mode[h], east, north, variance[k], colour, new_x[kept], new_P[kept])
            if top_speed < math.inf and _is_too_fast(new_x[kept], new_P[kept], top_speed):
                score -= _TOO_FAST
            mass = math.exp(score - best)
            is_good = 1.0 if kind in GOOD else 0.0
            twin = -1
            for other in range(kept):
                if new_mode[other] == now and are_twins(new_x[kept], new_P[kept], new_x[other], new_P[other]):
                    twin = other
                    break
            if twin >= 0:
                if lag > 0:
                    share = mass / (mass + new_weight[twin])
                    for row in range(lag):
                        seen = is_good if row == k % lag else good[h, row]
                        new_good[twin, row] += share * (seen - new_good[twin, row])
                new_weight[twin] += mass
                continue
            for row in range(lag):
                new_good[kept, row] = is_good if row == k % lag else good[h, row]
            new_mode[kept] = now
            lasting = now == BURSTING and mode[h] == BURSTING and kind != REDRAW
            new_age[kept] = age[h] + dt if lasting else 0.0
            new_weight[kept] = mass
            parent[k, kept] = h
            kind_of[k, kept] = kinds[chosen]
            kept += 1
        used = kept
        x, new_x = new_x, x
        P, new_P = new_P, P
        mode, new_mode = new_mode, mode
        age, new_age = new_age, age
        for h in range(used):
            weight[h] = math.log(new_weight[h])
        good, new_good = new_good, good
        if lag > 0 and k + 1 >= lag:
            probability[k + 1 - lag] = _share((k + 1) % lag, used, weight, good)
    for k in range(max(0, n - lag), n):
        probability[k] = _share(k % lag, used, weight, good)
    h = 0
    for other in range(1, used):
        if weight[other] > weight[h]:
            h = other
    held = 0.0
    for other in range(used):
        held += math.exp(weight[other] - weight[h])
    total += weight[h] + math.log(held)
    for k in range(n - 1, -1, -1):
        labels[k] = kind_of[k, h]
        h = parent[k, h]
    return float(total)


@device
def _is_too_fast(x: FloatArray, P: FloatArray, top_speed: float) -> bool:
    """Whether a state moves faster than the track can, by more than three standard deviations."""
    return math.hypot(x[0, 1], x[1, 1]) > top_speed + 3.0 * math.sqrt(P[1, 1])


@device
def _share(row: int, used: int, weight: FloatArray, good: FloatArray) -> float:
    """Probability that a fix was good, over the hypotheses of a later one."""
    held, total = 0.0, 0.0
    for h in range(used):
        mass = math.exp(weight[h])
        total += mass
        held += mass * good[h, row]
    return min(1.0, held / total)
