"""A smoothed track in its plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimators.arrays import CodeArray, FloatArray


@dataclass(frozen=True, slots=True)
class Solved:
    """States of rows that have a time, in order of time.

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

    def part(self, rows: slice) -> Solved:
        """Give some of the rows."""
        return Solved(self.labels[rows], self.variance[rows], self.states[rows], self.covariances[rows])

    @staticmethod
    def joined(parts: Sequence[Solved]) -> Solved:
        """Parts on end as one."""
        return Solved(
            np.concatenate([part.labels for part in parts]),
            np.concatenate([part.variance for part in parts]),
            np.concatenate([part.states for part in parts]),
            np.concatenate([part.covariances for part in parts]),
        )


def at_times(solved: Solved, t: FloatArray, when: FloatArray) -> tuple[FloatArray, FloatArray]:
    """States and covariances at other times, between those of a track.

    Parameters
    ----------
    solved : Solved
    t : ndarray, shape (m,)
        Its times, ascending.
    when : ndarray, shape (k,)
        Times wanted; before the first and after the last the state there stands.

    Returns
    -------
    states : ndarray, shape (k, 2, 3)
    covariances : ndarray, shape (k, 3, 3)
    """

    def between(values: FloatArray) -> FloatArray:
        columns = values.reshape(t.size, -1).T
        found = np.column_stack([np.interp(when, t, column) for column in columns])
        return found.reshape(when.size, *values.shape[1:])

    return between(solved.states), between(solved.covariances)
