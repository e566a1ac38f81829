"""What a sequence of labels is worth: its likelihood, without a search.

The labels need only say what each fix is. How one kind becomes another is read as the model has it: what
comes after a burst is its exit, the first fix that is adrift leaves the track or is thrown off it, whichever
is likelier.
"""

from __future__ import annotations

import math

import numpy as np
from numba import types

from estimators.arrays import CodeArray, FloatArray, IntArray
from estimators.kernels import arithmetic, kernel, ro
from estimators.trajectories.labelling.beam import GOOD, SHORTEST_S
from estimators.trajectories.labelling.branches import BRANCHES
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    ASTRAY,
    BURST,
    BURSTING,
    ENTRY,
    EXIT,
    LEVEL_STRIDE,
    LONGEST_S,
    NOMINAL,
    REDRAW,
    SPIKE,
    THROWN,
)
from estimators.trajectories.labelling.priors import PRIORS, fill_prior, log_first
from estimators.trajectories.labelling.signature import TRACK
from estimators.trajectories.labelling.state import COLUMNS
from estimators.trajectories.labelling.steps import begin, branch, follow, look_ahead
from estimators.trajectories.labelling.velocity import take_velocity

IMPOSSIBLE = -1e6
"""Worth of a step that the model does not have."""


@kernel(
    types.float64(
        *TRACK,
        ro(types.uint8),
        types.uint8[::1],
    )
)
def judge_labels(
    t: FloatArray,
    fixes: FloatArray,
    variance: FloatArray,
    velocity: FloatArray,
    velocity_variance: FloatArray,
    colour: float,
    manoeuvre: float,
    rates: FloatArray,
    labels: CodeArray,
    resolved: CodeArray,
) -> float:
    """Log likelihood of a track under given labels.

    Parameters
    ----------
    t, fixes, variance, velocity, velocity_variance, colour, manoeuvre, rates
        As for :func:`estimators.trajectories.labelling.beam.label_piece`.
    labels : ndarray of uint8, shape (n,)
    resolved : ndarray of uint8, shape (n,)
        Out: the same labels as the model has them.

    Returns
    -------
    float
        Far below zero if the labels cannot follow one another.
    """
    state, ahead = np.zeros((1, COLUMNS)), np.zeros((1, COLUMNS))
    scores, kinds, prior = np.empty(BRANCHES), np.empty(BRANCHES, np.int64), np.empty(PRIORS)
    first = labels[0] % LEVEL_STRIDE
    if first not in (SPIKE, ADRIFT):
        first = NOMINAL
    mode = begin(first, fixes[0, 0], fixes[0, 1], variance[0], colour, state, 0)
    if velocity_variance[0] < math.inf:
        take_velocity(state, 0, velocity[0, 0], velocity[0, 1], velocity_variance[0])
    resolved[0] = first if first != ADRIFT else ADRIFT + LEVEL_STRIDE * THROWN
    total, age, last_dt = log_first(first, rates), 0.0, -1.0
    for k in range(1, t.size):
        dt = min(max(t[k] - t[k - 1], SHORTEST_S), LONGEST_S)
        if dt != last_dt:
            last_dt = dt
            fill_prior(dt, rates, prior)
        look_ahead(mode, dt, manoeuvre, colour, rates, state, 0, ahead)
        if velocity_variance[k] < math.inf:
            take_velocity(ahead, 0, velocity[k, 0], velocity[k, 1], velocity_variance[k])
        count = branch(
            mode, age, 0.0, dt, fixes[k, 0], fixes[k, 1], variance[k], colour, prior, ahead, 0, scores, kinds,
            0,
        )  # fmt: skip
        chosen = _choose(labels[k], mode, scores, kinds, count)
        if chosen < 0:
            return IMPOSSIBLE
        total += scores[chosen]
        resolved[k] = kinds[chosen]
        kind = kinds[chosen] % LEVEL_STRIDE
        now = follow(
            kind, kinds[chosen] // LEVEL_STRIDE, mode, dt, fixes[k, 0], fixes[k, 1], variance[k], colour,
            ahead, 0,
        )  # fmt: skip
        state, ahead = ahead, state
        age = age + dt if now >= BURSTING and now == mode and kind != REDRAW else 0.0
        mode = now
    return float(total)


@arithmetic
def _choose(label: int, mode: int, scores: FloatArray, kinds: IntArray, count: int) -> int:
    """Find the branch that a label means; -1 if there is none."""
    for at in range(count):
        if kinds[at] == label:
            return at
    kind = label % LEVEL_STRIDE
    meant = kind
    if mode in (BURSTING, ASTRAY):
        if kind in GOOD:
            meant = EXIT
        elif mode == BURSTING and kind in (ENTRY, REDRAW):
            meant = REDRAW
        elif mode == ASTRAY and kind in (BURST, REDRAW):
            meant = ENTRY
    elif kind in (BURST, REDRAW):
        meant = ENTRY
    elif kind in GOOD:
        meant = NOMINAL
    best, chosen = -math.inf, -1
    for at in range(count):
        if kinds[at] % LEVEL_STRIDE == meant and scores[at] > best:
            best, chosen = scores[at], at
    return chosen
