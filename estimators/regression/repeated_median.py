"""Siegel's repeated median line: the median over points of the median slope to all others (Siegel 1982).

Breakdown 50 %, no threshold, no scale. Up to 400 points every row of slopes is formed; beyond that the
outer median is enclosed between values at which the rows are classified in O(n log n) by counting
inversions, until few rows are left whose medians need to be known (in the spirit of Matousek, Mount &
Netanyahu 1998). Both ways give the same line.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.regression.group_uncertainty import GroupUncertainty, group_uncertainty
from estimators.regression.row_medians import count_slopes_per_row, median_slopes
from estimators.regression.slope_selection import between
from estimators.regression.theil_sen import MedianLine

MAX_POINTS = 1_000_000
"""More points than this are refused: a fit would take minutes."""

_FORMED = 160_000  # slopes that are quicker formed than avoided: 400 points
_SLICE = 2_000_000  # slopes formed in one compiled call, about 20 ms
_WORTH_FORMING = 200_000_000  # rather than to go on with pivots that decide little
_MOST_FORMED = 10_000_000_000  # about a minute and a half
_SAMPLED_ROWS = 64
_ROUNDS = 200


class TooManySlopesError(ValueError):
    """The repeated median of these points would take minutes."""


def repeated_median(t: FloatArray, y: FloatArray) -> MedianLine:
    """Repeated median slope, and the intercept median(y - slope t), in O(n) memory.

    Each point's inner median runs over the points at other times; even numbers average the two middle
    values. The intercept is the ``hierarchical`` one of :func:`scipy.stats.siegelslopes`.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Not all equal, n <= 1,000,000; any order, ties allowed.
    y : ndarray of float64, shape (n,)

    Returns
    -------
    MedianLine

    Raises
    ------
    ValueError
        If no two times differ.
    TooManySlopesError
        If there are too many points, or values so coarse that too many slopes would have to be formed.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.arange(9.0)
    >>> y = 1.0 + 2.0 * t
    >>> y[5:] = [1e3, -1e5, 70.0, 1e6]
    >>> repeated_median(t, y)
    MedianLine(slope=2.0, intercept=1.0)
    """
    if t.size > MAX_POINTS:
        raise TooManySlopesError(f"{t.size} points; the repeated median takes at most {MAX_POINTS}")
    t, y = np.ascontiguousarray(t), np.ascontiguousarray(y)
    if not np.all(t[1:] > t[:-1]):
        order = np.lexsort((y, t))
        t, y = t[order], y[order]
    if t[0] == t[-1]:
        raise ValueError("no two times differ: there is no slope")
    slope = _Rows(t, y).median() + 0.0  # no negative zeros
    return MedianLine(slope, float(np.median(y - slope * t)))


def repeated_median_uncertainty(t: FloatArray, y: FloatArray) -> GroupUncertainty | None:
    """Covariance of (intercept, slope) of the repeated median line, from 20 groups of points.

    The line's influence function is no multiple of a score of its residuals, so that the sandwich of a
    loss does not give its variance.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Ascending; the intercept is the value at t = 0.
    y : ndarray of float64, shape (n,)

    Returns
    -------
    GroupUncertainty or None
        None where there are too few points to leave some out.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(-1.0, 1.0, 100)
    >>> y = 2.0 * t + 0.1 * np.random.default_rng(0).normal(size=100)
    >>> bool(0.01 < repeated_median_uncertainty(t, y).stderr[1] < 0.1)
    True
    """
    return group_uncertainty(_coefficients, t, y)


def _coefficients(t: FloatArray, y: FloatArray) -> FloatArray:
    line = repeated_median(t, y)
    return np.array([line.intercept, line.slope])


@dataclass(slots=True)
class _Rows:
    """The rows of slopes of points sorted by (t, y), and what is known about their medians.

    A row's median lies between its two middle slopes (which are one if their number is odd). A row counts
    as below a value, or above it, only if both are.
    """

    t: FloatArray
    y: FloatArray
    low: float = -math.inf
    high: float = math.inf
    undecided: tuple[float, float] | None = None
    is_below: BoolArray = field(init=False)
    is_above: BoolArray = field(init=False)
    _lower_rank: IntArray = field(init=False)
    _upper_rank: IntArray = field(init=False)
    _repeats: IntArray = field(init=False)

    def __post_init__(self) -> None:
        n = self.t.size
        same_time = self.t[1:] == self.t[:-1]
        others = n - _run_lengths(same_time)
        self._lower_rank, self._upper_rank = (others - 1) // 2, others // 2
        self._repeats = _run_lengths(same_time & (self.y[1:] == self.y[:-1]))
        self.is_below = np.zeros(n, dtype=np.bool_)
        self.is_above = np.zeros(n, dtype=np.bool_)

    def median(self) -> float:
        n = self.t.size
        ranks = (n - 1) // 2, n // 2
        for _ in range(_ROUNDS):
            open_rows = np.flatnonzero(~(self.is_below | self.is_above))
            if open_rows.size <= max(_SAMPLED_ROWS, _FORMED // n):
                break
            if math.nextafter(math.nextafter(self.low, self.high), self.high) >= self.high:
                # At most one number lies between the enclosing ones: the answer is known to its last digit.
                return math.nextafter(self.low, self.high)
            pivots = self._pivots(open_rows, ranks)
            if not pivots:
                break
            for pivot in pivots:
                if self.low < pivot < self.high and self._classify(pivot, ranks):
                    return pivot
        if open_rows.size * n > _MOST_FORMED:
            raise TooManySlopesError(f"{open_rows.size} of {n} rows could not be told apart by counting")
        medians = np.sort(self._medians(open_rows))
        first = int(np.count_nonzero(self.is_below))
        low, high = (float(medians[min(max(rank - first, 0), medians.size - 1)]) for rank in ranks)
        return low if low == high else 0.5 * (low + high)

    def _medians(self, rows: IntArray) -> FloatArray:
        medians = np.empty(rows.size)
        slice_rows = max(_SLICE // self.t.size, 1)
        for start in range(0, rows.size, slice_rows):
            part = slice(start, start + slice_rows)
            median_slopes(self.t, self.y, rows[part], medians[part])
        return medians

    def _pivots(self, open_rows: IntArray, ranks: tuple[int, int]) -> list[float]:
        """Values that most likely enclose the outer median, from the medians of some open rows."""
        sample = np.sort(
            self._medians(open_rows[(np.arange(_SAMPLED_ROWS) * open_rows.size) // _SAMPLED_ROWS])
        )
        first = np.count_nonzero(self.is_below)
        middle = (0.5 * (ranks[0] + ranks[1]) + 0.5 - first) / open_rows.size * _SAMPLED_ROWS
        spread = math.sqrt(_SAMPLED_ROWS)  # two standard errors of a median's place
        ends = (math.floor(middle - spread), math.ceil(middle + spread))
        inner = self.undecided or (math.nan, math.nan)
        useful = {
            float(sample[end])
            for end in ends
            if 0 <= end < _SAMPLED_ROWS
            and self.low < sample[end] < self.high
            and not inner[0] <= sample[end] <= inner[1]
        }
        if useful:
            return sorted(useful)
        if self.undecided and open_rows.size * self.t.size <= _WORTH_FORMING:
            return []
        gaps = [(self.low, inner[0]), (inner[1], self.high)] if self.undecided else [(self.low, self.high)]
        return [between(low, high) for low, high in gaps if math.nextafter(low, high) < high]

    def _classify(self, pivot: float, ranks: tuple[int, int]) -> bool:
        """Sort the rows by which side of ``pivot`` they lie on; tell whether it is the outer median."""
        n = self.t.size
        below, equal = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
        count_slopes_per_row(self.t, self.y, pivot, below, equal)
        not_above = below + (equal - self._repeats)
        lower_is_less, upper_is_less = below > self._lower_rank, below > self._upper_rank
        lower_is_more, upper_is_more = not_above <= self._lower_rank, not_above <= self._upper_rank
        if np.count_nonzero(upper_is_less) > ranks[1]:
            self.high = pivot
            self.is_above = ~lower_is_less
        elif n - np.count_nonzero(lower_is_more) <= ranks[0]:
            self.low = pivot
            self.is_below = ~upper_is_more
        else:
            exact = np.count_nonzero(~lower_is_less & ~upper_is_more)
            surely_less = np.count_nonzero(upper_is_less)
            perhaps_less = n - np.count_nonzero(lower_is_more) - exact
            if perhaps_less <= ranks[0] and ranks[1] < surely_less + exact:
                return True
            low, high = self.undecided or (pivot, pivot)
            self.undecided = (min(low, pivot), max(high, pivot))
        return False


def _run_lengths(same_as_previous: BoolArray) -> IntArray:
    """Per element, the length of its run, from whether each continues the run of the one before."""
    starts = np.flatnonzero(np.concatenate(([True], ~same_as_previous, [True])))
    lengths = np.diff(starts)
    return np.asarray(np.repeat(lengths, lengths), dtype=np.int64)
