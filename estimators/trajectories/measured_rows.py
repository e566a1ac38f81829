"""The rows of a track that measure something, for methods that take a long track piece by piece."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.trajectories.estimation import Measured
from estimators.trajectories.projected import Projected

_STEP = 1 << 16
_SAMPLES, _SAMPLE = 16, 1 << 13
"""Of a track of more fixes than both together, so many windows of so many fixes show what it is made of."""


@dataclass(frozen=True, slots=True)
class MeasuredRows:
    """Fixes that measure something, among rows that do not; nothing is copied but what is asked for.

    Attributes
    ----------
    t : ndarray, shape (m,)
        Seconds, ascending.
    fixes : Projected
        East and north, metres, of any rows.
    reported : ndarray, shape (m,), or None
        Radii that hold 68 % as the receiver reports them, metres.
    measures : ndarray of bool, shape (m,)
    velocity : ndarray, shape (m, 2), or None
        East and north as the receiver reports them, m/s.
    velocity_variance : ndarray, shape (m,), or None
        Per axis; infinite where there is no velocity to be trusted.
    before : ndarray of int64
        Fixes before each step of rows; the last entry counts them all.

    Examples
    --------
    >>> from estimators.geodesy.plane import Plane
    >>> known, chosen = np.full(4, True), np.array([True, False, True, True])
    >>> fixes = Projected(Plane(0.0, 0.0), np.zeros(4), np.zeros(4), known, None)
    >>> rows = measured_rows(np.arange(4.0), fixes, chosen)
    >>> rows.size, rows.window(1, 3).t.tolist()
    (3, [2.0, 3.0])
    """

    t: FloatArray
    fixes: Projected
    reported: FloatArray | None
    measures: BoolArray
    velocity: FloatArray | None
    velocity_variance: FloatArray | None
    before: IntArray

    @property
    def size(self) -> int:
        """Number of fixes."""
        return int(self.before[-1])

    def before_row(self, row: int) -> int:
        """Count the fixes before a row."""
        step = row // _STEP
        return int(self.before[step]) + int(np.count_nonzero(self.measures[step * _STEP : row]))

    def window(self, first: int, last: int) -> Measured:
        """Give the fixes from one up to another.

        Parameters
        ----------
        first, last : int
            Among the fixes; the latter is not included.
        """
        begin = _STEP * max(int(np.searchsorted(self.before, first, side="right")) - 1, 0)
        end = min(_STEP * int(np.searchsorted(self.before, last)), self.t.size)
        part = slice(begin, end)
        skipped = first - self.before_row(begin)
        if self.measures[part].all():
            chosen: slice | IntArray = slice(begin + skipped, begin + skipped + last - first)
        else:
            chosen = begin + np.flatnonzero(self.measures[part])[skipped : skipped + last - first]

        def of(column: FloatArray | None) -> FloatArray | None:
            return None if column is None else np.ascontiguousarray(column[chosen])

        return Measured(
            np.ascontiguousarray(self.t[chosen]),
            np.ascontiguousarray(self.fixes[chosen]),
            of(self.reported),
            of(self.velocity),
            of(self.velocity_variance),
        )

    def whole(self) -> Measured:
        """All fixes."""
        return self.window(0, self.size)

    def sample(self) -> Measured:
        """All fixes of a short track; of a long one windows, evenly spread, with gaps between them.

        The windows come without velocities.
        """
        if self.size <= _SAMPLES * _SAMPLE:
            return self.whole()
        firsts = np.linspace(0, self.size - _SAMPLE, _SAMPLES).astype(np.int64).tolist()
        windows = [self.window(first, first + _SAMPLE) for first in firsts]
        reported = [window.reported for window in windows if window.reported is not None]
        return Measured(
            np.concatenate([window.t for window in windows]),
            np.concatenate([window.fixes for window in windows]),
            np.concatenate(reported) if reported else None,
        )


def measured_rows(
    t: FloatArray,
    fixes: Projected,
    measures: BoolArray,
    reported: FloatArray | None = None,
    velocity: FloatArray | None = None,
    velocity_variance: FloatArray | None = None,
) -> MeasuredRows:
    """Make the view of what measures; see :class:`MeasuredRows`."""
    counts = [
        np.count_nonzero(measures[first : first + _STEP]) for first in range(0, max(measures.size, 1), _STEP)
    ]
    before = np.concatenate([[0], np.cumsum(counts)])
    return MeasuredRows(t, fixes, reported, measures, velocity, velocity_variance, before)
