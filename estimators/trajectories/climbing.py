"""The top of a function of logarithms, coordinate by coordinate on a grid, and how broad it is."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from estimators.arrays import FloatArray

Evidence: TypeAlias = Callable[[FloatArray], float]
"""From logarithms of parameters to the logarithm of what they are worth."""
_UNIT = 0.23
"""Of the grid, a factor of 1.26."""
_MOST_RUNS = 80
_FACTORS = np.log(2.0) * np.arange(-2, 6)
"""By which a broad top is felt out."""


def climb(
    evidence: Evidence,
    start: FloatArray,
    axes: tuple[int, ...],
    strides: tuple[int, ...],
    least: FloatArray,
    largest: FloatArray,
) -> FloatArray:
    """Ascend with steps of so many units, one stride after the other.

    Examples
    --------
    >>> top = climb(lambda x: -float(x @ x), np.ones(2), (0, 1), (4, 2, 1), np.full(2, -9.0), np.full(2, 9.0))
    >>> top.round(2).tolist()
    [0.08, 0.08]
    """
    seen: dict[tuple[int, ...], float] = {}

    def logs_at(place: tuple[int, ...]) -> FloatArray:
        return np.clip(start + _UNIT * np.array(place), least, largest)

    def value_at(place: tuple[int, ...]) -> float:
        if place not in seen:
            seen[place] = evidence(logs_at(place))
        return seen[place]

    place = (0,) * start.size
    for stride in strides:
        moved = True
        while moved and len(seen) < _MOST_RUNS:
            moved = False
            for axis in axes:
                for sign in (1, -1):
                    while True:
                        tried = (*place[:axis], place[axis] + sign * stride, *place[axis + 1 :])
                        if not value_at(tried) > value_at(place):
                            break
                        place, moved = tried, True
    return logs_at(place)


def mean_square(evidence: Evidence, top: FloatArray, axis: int) -> FloatArray:
    """Move one of the logarithms to its root mean square under the evidence.

    Where the evidence has a sharp top nothing moves. Where it is flat, as for the noise of a track of fixes
    so far apart that any noise is motion, the mean tells more than whichever point is highest.
    """
    tried = np.tile(top, (_FACTORS.size, 1))
    tried[:, axis] += _FACTORS
    worth = np.array([evidence(logs) for logs in tried])
    weight = np.exp(worth - worth.max())
    moved = top.copy()
    moved[axis] += 0.5 * np.log(float(np.sum(weight * np.exp(2.0 * _FACTORS)) / np.sum(weight)))
    return moved
