"""A smoothed track in its plane."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from estimators.arrays import CodeArray, FloatArray


@dataclass(frozen=True, slots=True)
class Solved:
    """States of all rows that have a time, in order of time.

    Attributes
    ----------
    labels : ndarray of uint8, shape (m,)
        ``MISSING`` where nothing was measured.
    variance : ndarray, shape (m,)
        Of the white noise of each fix, per axis.
    states : ndarray, shape (m, 2, 3)
        Position, velocity and bias, east and north.
    covariances : ndarray, shape (m, 3, 3)
        Of each axis.
    """

    labels: CodeArray
    variance: FloatArray
    states: FloatArray
    covariances: FloatArray


def at_times(solved: Solved, t: FloatArray, when: FloatArray) -> Solved:
    """States at other times, between those of a track.

    Parameters
    ----------
    solved : Solved
    t : ndarray, shape (m,)
        Its times, ascending.
    when : ndarray, shape (m,)
        Times wanted; before the first and after the last the state there stands.
    """

    def between(values: FloatArray) -> FloatArray:
        columns = values.reshape(t.size, -1)
        return np.column_stack([np.interp(when, t, column) for column in columns.T]).reshape(values.shape)

    return replace(solved, states=between(solved.states), covariances=between(solved.covariances))
