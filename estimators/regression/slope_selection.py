"""Selection of order statistics among the slopes of all pairs, without forming the pairs.

An interval of slopes that holds the wanted one is narrowed at order statistics of a random choice of the
slopes in it, until it holds few enough to be listed (Matousek 1991; Dillencourt, Mount & Netanyahu 1992).
The choice decides how long that takes, never what is found.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from estimators.arrays import FloatArray
from estimators.regression.slope_order import count_inversions, pick_slopes

_LISTED = 1 << 16  # slopes listed at once; 4 per point where that is more


@dataclass(slots=True)
class PairSlopes:
    """The slopes of all pairs of points at different times, as an ordered sequence never written out.

    Parameters
    ----------
    t : ndarray of float64, shape (n,)
        Times in any order, ties allowed.
    y : ndarray of float64, shape (n,)

    Attributes
    ----------
    count : int
        Number of slopes.

    Examples
    --------
    >>> import numpy as np
    >>> slopes = PairSlopes(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 3.0]))
    >>> slopes.count, slopes.ranked([0, 1, 2])
    (3, [0.5, 1.0, 2.0])
    """

    t: FloatArray
    y: FloatArray
    count: int = field(init=False)
    _repeated: int = field(init=False)
    _known: dict[float, tuple[int, int]] = field(init=False)
    _listed: tuple[float, float, FloatArray] | None = field(init=False, default=None)
    _round: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        t, y = np.ascontiguousarray(self.t), np.ascontiguousarray(self.y)
        if not np.all(t[1:] > t[:-1]):
            order = np.lexsort((y, t))
            t, y = t[order], y[order]
        self.t, self.y = t, y
        n = t.size
        same_time = t[1:] == t[:-1]
        self.count = n * (n - 1) // 2 - _pairs_within_runs(same_time)
        self._repeated = _pairs_within_runs(same_time & (y[1:] == y[:-1]))
        # Per value: number of slopes below it, and not above it.
        self._known = {-math.inf: (0, 0), math.inf: (self.count, self.count)}

    def ranked(self, ranks: Sequence[int]) -> list[float]:
        """Slopes of the given ranks, counted from 0 for the smallest.

        Each is exactly the slope of a pair as floating point computes it, unless more slopes than can be
        listed lie within one unit in its last place: then it is right to that unit.
        """
        return [self._select(rank) for rank in ranks]

    def median(self) -> float:
        """Median slope; an even number of slopes averages the two middle ones."""
        low, high = self.ranked([(self.count - 1) // 2, self.count // 2])
        return low if low == high else 0.5 * low + 0.5 * high

    def _select(self, rank: int) -> float:
        capacity = max(_LISTED, 4 * self.t.size)
        while True:
            for value, (below, not_above) in self._known.items():
                if below <= rank < not_above:
                    return value
            low = max(value for value, (_, not_above) in self._known.items() if not_above <= rank)
            high = min(value for value, (below, _) in self._known.items() if below > rank)
            offset = self._known[low][1]
            inside = self._known[high][0] - offset
            if inside <= capacity:
                listed = self._list(low, high, inside)
                place = min(rank - offset, listed.size - 1)
                return float(np.partition(listed, place)[place])
            if math.nextafter(low, high) >= high:
                return low if 2 * (rank - offset) < inside else high
            self._narrow(low, high, inside, rank - offset)

    def _list(self, low: float, high: float, inside: int) -> FloatArray:
        if self._listed is None or self._listed[:2] != (low, high):
            listed = np.empty(inside)
            found = pick_slopes(self.t, self.y, low, high, inside, 0, listed)
            self._listed = (low, high, listed[:found])
        return self._listed[2]

    def _narrow(self, low: float, high: float, inside: int, place: int) -> None:
        """Count at two values that most likely enclose the wanted slope."""
        self._round += 1
        sample = np.empty(max(2 * self.t.size, _LISTED // 8))
        found = pick_slopes(self.t, self.y, low, high, inside, self._round, sample)
        middle = (place + 0.5) / inside * found
        spread = 1.5 * math.sqrt(found) + 1.0  # three standard errors of a median's place
        ends = [math.floor(middle - spread), math.ceil(middle + spread)]
        inner = sorted(end for end in ends if 0 <= end < found)
        pivots = np.partition(sample[:found], inner)[inner] if inner else np.empty(0)
        useful = {float(value) for value in pivots if low < value < high}
        for value in useful or {between(low, high)}:
            counts = np.empty(2, dtype=np.int64)
            count_inversions(self.t, self.y, value, counts)
            below, equal = counts.tolist()
            self._known[value] = (below, below + equal - self._repeated)


def _pairs_within_runs(same_as_previous: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> int:
    """Pairs of elements within runs, from whether each element continues the run of the one before."""
    starts = np.flatnonzero(np.concatenate(([True], ~same_as_previous, [True])))
    lengths = np.diff(starts)
    return int(np.sum(lengths * (lengths - 1) // 2))


def between(low: float, high: float) -> float:
    """Find a value strictly between two that are not neighbours."""
    largest = float(np.finfo(np.float64).max)
    low, high = max(low, -largest), min(high, largest)
    middle = 0.5 * low + 0.5 * high
    return middle if low < middle < high else math.nextafter(low, high)
