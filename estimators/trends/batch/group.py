"""Series that are searched side by side: their usable points one after the other, in their frames."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.found import Scale
from estimators.options import RobustOptions
from estimators.series import Series
from estimators.trends.batch.source import Settings


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """Series with at least two different times each.

    Attributes
    ----------
    series : ndarray of int64, shape (m,)
        Their numbers in the table.
    offsets : ndarray of int64, shape (m + 1,)
        Into the columns of points.
    t : ndarray of float64, shape (points,)
        Times in the frame, from -1 to 1.
    y : ndarray of float64, shape (points,)
    weights : ndarray of float64, shape (points,), or None
        Precisions with mean 1 in each series.
    rows : slice, or ndarray of int64, shape (points,)
        The caller's rows; a slice where every one of them is a point.
    origin : ndarray, shape (m,)
        The caller's time at internal time 0: float64, integers or datetime64[ns].
    middle, half : ndarray of float64, shape (m,)
        Of the frame, in internal time.
    floor : ndarray of float64, shape (m,)
        Least noise scale.
    central : ndarray of float64, shape (m,)
        Range of the central nine tenths of the values.
    quantum : ndarray of float64, shape (m,)
        Step of the values where they are quantised, else 0.
    constant : ndarray of bool, shape (m,)
        Whether all values are equal.
    ordinary : ndarray of bool, shape (m,)
        Whether the values are fitted in their own unit.
    checked : dict of int to Series
        By position: the series that came through :func:`estimators.series.as_series`.
    """

    series: IntArray
    offsets: IntArray
    t: FloatArray
    y: FloatArray
    weights: FloatArray | None
    rows: slice | IntArray
    origin: np.ndarray[Any, Any]
    middle: FloatArray
    half: FloatArray
    floor: FloatArray
    central: FloatArray
    quantum: FloatArray
    constant: BoolArray
    ordinary: BoolArray
    checked: dict[int, Series]

    @property
    def size(self) -> int:
        """Number m of series."""
        return int(self.series.size)

    @property
    def lengths(self) -> IntArray:
        """Points per series."""
        return np.diff(self.offsets)

    def rows_of(self, k: int) -> slice:
        """Place of the points of the k-th series."""
        return slice(int(self.offsets[k]), int(self.offsets[k + 1]))

    def select(self, kept: BoolArray) -> Group:
        """Keep some of the series."""
        if kept.all():
            return self
        lengths = self.lengths
        points = np.repeat(kept, lengths)
        places = (np.cumsum(kept) - 1).tolist()
        rows = np.arange(self.rows.start, self.rows.stop) if isinstance(self.rows, slice) else self.rows
        return Group(
            series=self.series[kept],
            offsets=bounds_of(lengths[kept]),
            t=self.t[points],
            y=self.y[points],
            weights=None if self.weights is None else self.weights[points],
            rows=rows[points],
            origin=self.origin[kept],
            middle=self.middle[kept],
            half=self.half[kept],
            floor=self.floor[kept],
            central=self.central[kept],
            quantum=self.quantum[kept],
            constant=self.constant[kept],
            ordinary=self.ordinary[kept],
            checked={places[k]: series for k, series in self.checked.items() if kept[k]},
        )


def bounds_of(lengths: IntArray) -> IntArray:
    """Offsets of stretches of these lengths.

    Examples
    --------
    >>> bounds_of(np.array([3, 0, 2]))
    array([0, 3, 3, 5])
    """
    bounds = np.zeros(lengths.size + 1, dtype=np.int64)
    np.cumsum(lengths, out=bounds[1:])
    return bounds


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """What is known of the noise of each series before its search: :class:`Scale` as columns.

    Attributes
    ----------
    sigma, threshold : ndarray of float64, shape (m,), or None
    sigma_source, threshold_source : str
    floor : ndarray of float64, shape (m,)
    """

    sigma: FloatArray | None
    sigma_source: str
    threshold: FloatArray | None
    threshold_source: str
    floor: FloatArray

    @classmethod
    def told(cls, asked: Settings, floor: FloatArray) -> Known:
        """Take what the caller told; a threshold follows from a noise scale."""
        sigma = None if asked.sigma is None else np.full(floor.size, asked.sigma)
        if asked.threshold is None and asked.sigma is not None:
            following = np.full(floor.size, asked.options.threshold_sigmas * asked.sigma)
            return cls(sigma, "given", following, "sigma", floor)
        threshold = None if asked.threshold is None else np.full(floor.size, asked.threshold)
        return cls(sigma, "given", threshold, "given", floor)

    @classmethod
    def piloted(cls, sigma: FloatArray, options: RobustOptions, floor: FloatArray) -> Known:
        """Take what a pilot fit by ``auto`` found."""
        least = np.maximum(sigma, floor)
        return cls(least, "mixture", options.threshold_sigmas * least, "sigma", floor)

    def of(self, k: int) -> Scale:
        """Say what is known of the k-th series."""
        return Scale(
            None if self.sigma is None else float(self.sigma[k]),
            self.sigma_source,
            None if self.threshold is None else float(self.threshold[k]),
            self.threshold_source,
            float(self.floor[k]),
        )

    def select(self, kept: BoolArray) -> Known:
        """Keep some of the series."""
        return Known(
            None if self.sigma is None else self.sigma[kept],
            self.sigma_source,
            None if self.threshold is None else self.threshold[kept],
            self.threshold_source,
            self.floor[kept],
        )
