r"""Labels of a track: a beam over sequences of modes, followed piece by piece.

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

from estimators.arrays import CodeArray, FloatArray, IntArray
from estimators.kernels import kernel
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
from estimators.trajectories.labelling.priors import PRIORS, fill_prior, log_first
from estimators.trajectories.labelling.ranking import pile, take_top
from estimators.trajectories.labelling.settling import likeliest, settle, share_of_good, trace
from estimators.trajectories.labelling.signature import TRACK
from estimators.trajectories.labelling.state import (
    COLUMNS,
    WITHOUT_PATH,
    copy_state,
    is_too_fast,
)
from estimators.trajectories.labelling.steps import begin, branch, follow, look_ahead
from estimators.trajectories.labelling.twins import count_near, find_twin
from estimators.trajectories.labelling.velocity import take_velocity

WIDTH = 40
"""Hypotheses that are followed."""
_BORN = 0.6
"""Of the threshold of hopelessness: for what begins at a fix. There is so much of it at every fix that it
would fill the beam, and what begins in earnest soon stands out."""
_GOING_ON = (NOMINAL, NOMINAL + LEVEL_STRIDE * HURRIED, BURST, ADRIFT, EXIT)
"""Labels of what goes on or ends."""
FIRST = 3
"""Hypotheses of the first fix, whatever the width."""
_FEWEST_OF_PLACE = 5
_PLACES = 5
"""A beam has room for hypotheses of so many places at least: those of one place differ in little, and would
together crowd out the one that turns out right."""
GOOD = (NOMINAL, WIDE, EXIT, TELEPORT)
"""Kinds of fixes that tell where the track is."""
HOPELESS = 25.0
"""A branch exp(-25) times as likely as the best is not followed."""
"""What begins anew has so much less of that to spare than what goes on."""
_TOO_FAST = 30.0
"""What a speed above the top costs, as a logarithm."""
SHORTEST_S = 1e-6
"""Fixes of one time are reckoned so far apart, so that nothing is impossible between them."""
USED, SEEN, OPEN = range(3)
"""Places in what is known of the course so far."""


@kernel(
    types.float64(
        *TRACK,
        types.int64,
        types.int64,
        types.float64,
        types.float64,
        types.float64,
        types.boolean,
        types.float64[:, ::1],
        types.int64[::1],
        types.float64[::1],
        types.float64[::1],
        types.float64[:, ::1],
        types.int64[::1],
        types.uint8[:, ::1],
        types.uint8[:, ::1],
        types.uint8[::1],
        types.float64[::1],
    )
)
def label_piece(
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
    total: float,
    is_last: bool,
    states: FloatArray,
    mode: IntArray,
    age: FloatArray,
    weight: FloatArray,
    good: FloatArray,
    course: IntArray,
    parent: CodeArray,
    kind_of: CodeArray,
    labels: CodeArray,
    probability: FloatArray,
) -> float:
    """Follow a track for a piece; see :class:`estimators.trajectories.labelling.passage.Passage`.

    A label is settled once all hypotheses descend from it, whatever the pieces: the likeliest sequence of the
    whole track is found without keeping the whole.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Seconds, increasing. The first row is the last of the piece before, if there was one.
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
    total : float
        What the piece before returned; 0 at first.
    is_last : bool
        Whether the track ends with this piece.
    states, mode, age, weight, good : ndarray, shape (room, ...)
        Hypotheses: states (:mod:`estimators.trajectories.labelling.state`), modes, ages of bursts, logarithms
        of weights, and in column k % lag the probability of fix k to be good, as a hypothesis and those
        merged into it see it.
    course : ndarray of int64, shape (3,)
        Hypotheses in use, fixes taken in, and fixes whose labels are not settled.
    parent, kind_of : ndarray of uint8, shape (rows, room)
        Of each unsettled fix; with room for the piece.
    labels : ndarray of uint8, shape (all,)
        Out: of the whole track.
    probability : ndarray, shape (all,)
        Out: of a fix to be neither a spike nor part of a burst.

    Returns
    -------
    float
        Log likelihood of the labelled track, given its first fix; short of the last weights before the end.
    """
    n = t.size
    room = weight.size
    crowd = max(_FEWEST_OF_PLACE, width // _PLACES)
    home, home_mode, home_age, home_good = states, mode, age, good
    ahead, new = states.copy(), states.copy()
    new_mode, new_age, new_weight = np.zeros(room, np.int64), np.zeros(room), np.zeros(room)
    new_good = np.ones(good.shape)
    scores, heap = np.empty(room * BRANCHES), np.empty(room * BRANCHES, np.int64)
    kinds, origin = np.empty(room * BRANCHES, np.int64), np.empty(room * BRANCHES, np.int64)
    prior, last_dt = np.empty(PRIORS), -1.0

    if course[SEEN] == 0:
        first = (NOMINAL, SPIKE, ADRIFT)
        for h in range(FIRST):
            kind = first[h]
            mode[h] = begin(kind, fixes[0, 0], fixes[0, 1], variance[0], colour, states, h)
            if velocity_variance[0] < math.inf:
                take_velocity(states, h, velocity[0, 0], velocity[0, 1], velocity_variance[0])
            weight[h] = log_first(kind, rates)
            kind_of[0, h] = kind if kind != ADRIFT else ADRIFT + LEVEL_STRIDE * THROWN
            good[h, 0] = 1.0 if kind == NOMINAL else 0.0
        course[USED], course[SEEN], course[OPEN] = FIRST, 1, 1
    used = course[USED]
    # Of the first row: which fix of the track it is, and where it stands among the unsettled ones.
    at, held = course[SEEN] - 1, course[OPEN] - 1
    for k in range(1, n):
        dt = min(max(t[k] - t[k - 1], SHORTEST_S), LONGEST_S)
        east, north = fixes[k, 0], fixes[k, 1]
        if dt != last_dt:
            last_dt = dt
            fill_prior(dt, rates, prior)
        count = 0
        for h in range(used):
            look_ahead(mode[h], dt, manoeuvre, colour, rates, states, h, ahead)
            if velocity_variance[k] < math.inf:
                take_velocity(ahead, h, velocity[k, 0], velocity[k, 1], velocity_variance[k])
            before = count
            count = branch(
                mode[h], age[h], weight[h], dt, east, north, variance[k], colour, prior, ahead, h, scores,
                kinds, count,
            )  # fmt: skip
            for place in range(before, count):
                origin[place] = h
        best = -math.inf
        for place in range(count):
            best = max(best, scores[place])
        total += best
        alive = 0
        for place in range(count):
            if scores[place] >= best - (hopeless if kinds[place] in _GOING_ON else _BORN * hopeless):
                scores[alive], kinds[alive], origin[alive] = scores[place], kinds[place], origin[place]
                alive += 1
        pile(scores, heap, alive)
        kept, place = 0, (at + k) % lag if lag > 0 else 0
        while alive > 0 and kept < width:
            chosen = take_top(scores, heap, alive)
            alive -= 1
            score, h = scores[chosen], origin[chosen]
            kind, level = kinds[chosen] % LEVEL_STRIDE, kinds[chosen] // LEVEL_STRIDE
            copy_state(ahead, h, new, kept, COLUMNS if mode[h] == ASTRAY else WITHOUT_PATH)
            now = follow(kind, level, mode[h], dt, east, north, variance[k], colour, new, kept)
            if top_speed < math.inf and is_too_fast(new, kept, top_speed):
                score -= _TOO_FAST
            mass = math.exp(score - best)
            is_good = 1.0 if kind in GOOD else 0.0
            twin = find_twin(new, new_mode, kept, now)
            if twin >= 0:
                if lag > 0:
                    share = mass / (mass + new_weight[twin])
                    seen = new_good[twin, place]
                    for row in range(lag):
                        new_good[twin, row] += share * (good[h, row] - new_good[twin, row])
                    new_good[twin, place] = seen + share * (is_good - seen)
                new_weight[twin] += mass
                continue
            if count_near(new, kept) >= crowd:
                continue
            if lag > 0:
                for row in range(lag):
                    new_good[kept, row] = good[h, row]
                new_good[kept, place] = is_good
            new_mode[kept] = now
            lasting = now >= BURSTING and mode[h] == now and kind != REDRAW
            new_age[kept] = age[h] + dt if lasting else 0.0
            new_weight[kept] = mass
            parent[held + k, kept] = h
            kind_of[held + k, kept] = kinds[chosen]
            kept += 1
        used = kept
        states, new = new, states
        mode, new_mode = new_mode, mode
        age, new_age = new_age, age
        for h in range(used):
            weight[h] = math.log(new_weight[h])
        good, new_good = new_good, good
        if lag > 0 and at + k + 1 >= lag:
            probability[at + k + 1 - lag] = share_of_good((at + k + 1) % lag, used, weight, good)
    course[USED], course[SEEN] = used, at + n
    last = held + n - 1
    if not is_last:
        for h in range(used):
            home[h], home_mode[h], home_age[h], home_good[h] = states[h], mode[h], age[h], good[h]
        course[OPEN] = settle(last, at - held, used, parent, kind_of, labels)
        return float(total)
    for k in range(max(0, at + n - lag), at + n):
        probability[k] = share_of_good(k % lag, used, weight, good)
    h, mass = likeliest(used, weight)
    total += weight[h] + math.log(mass)
    trace(last, h, at - held, parent, kind_of, labels)
    course[OPEN] = 0
    return float(total)
