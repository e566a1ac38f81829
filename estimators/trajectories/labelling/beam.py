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
from estimators.trajectories.labelling.astray import are_twin_paths
from estimators.trajectories.labelling.branches import BRANCHES
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    ASTRAY,
    BURST,
    BURSTING,
    EXIT,
    HURRIED,
    LEVEL_STRIDE,
    LONGEST_S,
    NOMINAL,
    REDRAW,
    SPIKE,
    TELEPORT,
    THROWN,
    WIDE,
)
from estimators.trajectories.labelling.priors import PRIORS, R_SPIKE, R_TELEPORT, R_WIDE, fill_prior
from estimators.trajectories.labelling.state import are_twins, is_near
from estimators.trajectories.labelling.steps import begin, branch, follow, look_ahead
from estimators.trajectories.labelling.velocity import take_velocity

WIDTH = 40
"""Hypotheses that are followed."""
_BORN = 0.6
"""Of the threshold of hopelessness: for what begins at a fix. There is so much of it at every fix that it
would fill the beam, and what begins in earnest soon stands out."""
_GOING_ON = (NOMINAL, NOMINAL + LEVEL_STRIDE * HURRIED, BURST, ADRIFT, EXIT)
"""Labels of what goes on or ends."""
_FEWEST_OF_PLACE = 5
_PLACES = 5
"""A beam has room for hypotheses of so many places at least: those of one place differ in little, and would
together crowd out the one that turns out right."""
GOOD = (NOMINAL, WIDE, EXIT, TELEPORT)
"""Kinds of fixes that tell where the track is."""
HOPELESS = 25.0
"""A branch exp(-25) times as likely as the best is not followed."""
_TOO_FAST = 30.0
"""What a speed above the top costs, as a logarithm."""
_ASTRAY_AT_FIRST = 0.02
"""Probability that a track begins with a fault that lasts."""
SHORTEST_S = 1e-6
"""Fixes of one time are reckoned so far apart, so that nothing is impossible between them."""


@kernel(
    types.float64(
        ro(types.float64),
        ro(types.float64, 2),
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
    velocity: FloatArray,
    velocity_variance: FloatArray,
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
    velocity : ndarray, shape (n, 2)
        Reported, east and north, m/s.
    velocity_variance : ndarray, shape (n,)
        Per axis; infinite where there is none.
    colour : float
        Standard deviation of coloured noise in metres.
    manoeuvre : float
        Spectral density of the acceleration, m^2/s^3.
    rates : ndarray, shape (13,)
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
    # Three hypotheses of the first fix, whatever the width.
    room = max(width, 3)
    crowd = max(_FEWEST_OF_PLACE, width // _PLACES)
    x, P, path, spread = (
        np.zeros((room, 2, 3)),
        np.zeros((room, 3, 3)),
        np.zeros((room, 2, 2)),
        np.zeros((room, 3)),
    )
    x_ahead, P_ahead, path_ahead, spread_ahead = x.copy(), P.copy(), path.copy(), spread.copy()
    new_x, new_P, new_path, new_spread = x.copy(), P.copy(), path.copy(), spread.copy()
    mode, new_mode = np.zeros(room, np.int64), np.zeros(room, np.int64)
    age, new_age = np.zeros(room), np.zeros(room)
    weight, new_weight = np.zeros(room), np.zeros(room)
    parent, kind_of = np.zeros((n, room), np.int8), np.zeros((n, room), np.int8)
    # Row k % lag: probability of fix k to be good, as a hypothesis and those merged into it see it.
    good, new_good = np.ones((room, max(lag, 1))), np.ones((room, max(lag, 1)))
    scores = np.empty(room * BRANCHES)
    kinds, origin = np.empty(room * BRANCHES, np.int64), np.empty(room * BRANCHES, np.int64)
    prior, last_dt = np.empty(PRIORS), -1.0

    first = (NOMINAL, SPIKE, ADRIFT)
    for h in range(3):
        kind = first[h]
        mode[h] = begin(kind, fixes[0, 0], fixes[0, 1], variance[0], colour, x[h], P[h], path[h], spread[h])
        if velocity_variance[0] < math.inf:
            take_velocity(x[h], P[h], velocity[0, 0], velocity[0, 1], velocity_variance[0])
        weight[h] = log_first(kind, rates)
        kind_of[0, h] = kind if kind != ADRIFT else ADRIFT + LEVEL_STRIDE * THROWN
        good[h, 0] = 1.0 if kind == NOMINAL else 0.0
    used = 3
    total = 0.0
    for k in range(1, n):
        dt = min(max(t[k] - t[k - 1], SHORTEST_S), LONGEST_S)
        east, north = fixes[k, 0], fixes[k, 1]
        if dt != last_dt:
            last_dt = dt
            fill_prior(dt, rates, prior)
        count = 0
        for h in range(used):
            look_ahead(
                mode[h], dt, manoeuvre, colour, rates, x[h], P[h], path[h], spread[h], x_ahead[h],
                P_ahead[h], path_ahead[h], spread_ahead[h],
            )  # fmt: skip
            if velocity_variance[k] < math.inf:
                take_velocity(x_ahead[h], P_ahead[h], velocity[k, 0], velocity[k, 1], velocity_variance[k])
            before = count
            count = branch(
                mode[h], age[h], weight[h], dt, east, north, variance[k], colour, prior, x_ahead[h],
                P_ahead[h], path_ahead[h], spread_ahead[h], scores, kinds, count,
            )  # fmt: skip
            for at in range(before, count):
                origin[at] = h
        best = -math.inf
        for at in range(count):
            best = max(best, scores[at])
        total += best
        alive = 0
        for at in range(count):
            if scores[at] >= best - (hopeless if kinds[at] in _GOING_ON else _BORN * hopeless):
                scores[alive], kinds[alive], origin[alive] = scores[at], kinds[at], origin[at]
                alive += 1
        kept = 0
        for _ in range(alive):
            if kept == width:
                break
            chosen = 0
            for at in range(1, alive):
                if scores[at] > scores[chosen]:
                    chosen = at
            score = scores[chosen]
            scores[chosen] = -math.inf
            h = origin[chosen]
            kind, level = kinds[chosen] % LEVEL_STRIDE, kinds[chosen] // LEVEL_STRIDE
            for i in range(3):
                new_x[kept, 0, i] = x_ahead[h, 0, i]
                new_x[kept, 1, i] = x_ahead[h, 1, i]
                for j in range(i, 3):
                    new_P[kept, i, j] = P_ahead[h, i, j]
            if mode[h] == ASTRAY:
                new_path[kept] = path_ahead[h]
                new_spread[kept] = spread_ahead[h]
            now = follow(
                kind, level, mode[h], dt, east, north, variance[k], colour, new_x[kept], new_P[kept],
                new_path[kept], new_spread[kept],
            )  # fmt: skip
            if top_speed < math.inf and _is_too_fast(new_x[kept], new_P[kept], top_speed):
                score -= _TOO_FAST
            mass = math.exp(score - best)
            is_good = 1.0 if kind in GOOD else 0.0
            twin, neighbours = -1, 0
            for other in range(kept):
                if (
                    new_mode[other] == now
                    and are_twins(new_x[kept], new_P[kept], new_x[other], new_P[other])
                    and (
                        now != ASTRAY
                        or are_twin_paths(
                            new_path[kept], new_spread[kept], new_path[other], new_spread[other]
                        )
                    )
                ):
                    twin = other
                    break
                if is_near(new_x[kept], new_P[kept], new_x[other], new_P[other]):
                    neighbours += 1
            if twin >= 0:
                if lag > 0:
                    share = mass / (mass + new_weight[twin])
                    for row in range(lag):
                        seen = is_good if row == k % lag else good[h, row]
                        new_good[twin, row] += share * (seen - new_good[twin, row])
                new_weight[twin] += mass
                continue
            if neighbours >= crowd:
                continue
            for row in range(lag):
                new_good[kept, row] = is_good if row == k % lag else good[h, row]
            new_mode[kept] = now
            lasting = now >= BURSTING and mode[h] == now and kind != REDRAW
            new_age[kept] = age[h] + dt if lasting else 0.0
            new_weight[kept] = mass
            parent[k, kept] = h
            kind_of[k, kept] = kinds[chosen]
            kept += 1
        used = kept
        x, new_x = new_x, x
        P, new_P = new_P, P
        path, new_path = new_path, path
        spread, new_spread = new_spread, spread
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
def log_first(kind: int, rates: FloatArray) -> float:
    """Ln prior of what the first fix is."""
    if kind == ADRIFT:
        return math.log(_ASTRAY_AT_FIRST)
    if kind == SPIKE:
        return math.log(rates[R_SPIKE])
    return math.log1p(-rates[R_SPIKE] - rates[R_WIDE] - rates[R_TELEPORT])


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
