"""Which part of the plane a map shows: the track and its good fixes, whatever outliers lie far away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray

# Faults within this share of the track's extent on either side enlarge the map; those beyond do not.
ROOM_FOR_FAULTS = 0.15
_MARGIN = 0.06
_LEAST_M = 1.0
_RIM_PX = 7.0


@dataclass(frozen=True, slots=True)
class View:
    """A part of the plane at one scale in both directions.

    Attributes
    ----------
    low_m : ndarray of float64, shape (2,)
        East and north of the lower left corner.
    size_px : ndarray of float64, shape (2,)
    metre_px : float
        Pixels per metre.
    """

    low_m: FloatArray
    size_px: FloatArray
    metre_px: float

    @classmethod
    def over(cls, core_m: FloatArray, faults_m: FloatArray, size_px: FloatArray) -> View:
        """Choose the part that shows places at the largest scale.

        Parameters
        ----------
        core_m : ndarray of float64, shape (m, 2)
            What has to be seen.
        faults_m : ndarray of float64, shape (k, 2)
            What is to be seen if it is not far off.
        size_px : ndarray of float64, shape (2,)
            Of the axes.
        """
        low, high = core_m.min(axis=0), core_m.max(axis=0)
        reach = ROOM_FOR_FAULTS * max(float(np.max(high - low)), _LEAST_M)
        near = faults_m[np.all((faults_m >= low - reach) & (faults_m <= high + reach), axis=1)]
        everything = np.concatenate([near, low[None], high[None]])
        low, high = everything.min(axis=0), everything.max(axis=0)
        extent = np.maximum(high - low, _LEAST_M)
        metre_px = float(np.min(size_px * (1.0 - 2.0 * _MARGIN) / extent))
        return cls(0.5 * (low + high) - 0.5 * size_px / metre_px, size_px, metre_px)

    @property
    def high_m(self) -> FloatArray:
        """East and north of the upper right corner, shape (2,)."""
        return self.low_m + self.size_px / self.metre_px

    def in_pixels(self, places_m: FloatArray) -> FloatArray:
        """Pixels from the lower left corner, shape (k, 2)."""
        return (places_m - self.low_m) * self.metre_px

    def shows(self, places_m: FloatArray) -> BoolArray:
        """Whether places lie inside, shape (k,); False where they are NaN."""
        inside = (places_m >= self.low_m) & (places_m <= self.high_m)
        return np.asarray(inside.all(axis=1))

    def to_rim(self, inside_m: FloatArray, beyond_m: FloatArray) -> FloatArray:
        """Where the way from places inside to places beyond leaves the map, a little inside its rim.

        Parameters
        ----------
        inside_m, beyond_m : ndarray of float64, shape (k, 2)

        Returns
        -------
        ndarray of float64, shape (k, 2)
            Metres.
        """
        inset = _RIM_PX / self.metre_px
        low, high = self.low_m + inset, self.high_m - inset
        start = np.clip(inside_m, low, high)
        way = beyond_m - start
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            shares = np.where(
                way > 0.0, (high - start) / way, np.where(way < 0.0, (low - start) / way, np.inf)
            )
        share = np.minimum(shares.min(axis=1), 1.0)
        return np.asarray(np.clip(start + share[:, None] * way, low, high))


def round_length(most: float) -> float:
    """Largest of 1, 2, 5, 10, ... that is not larger.

    Parameters
    ----------
    most : float
        Positive.

    Examples
    --------
    >>> round_length(730.0), round_length(0.3)
    (500.0, 0.2)
    """
    power = 10.0 ** np.floor(np.log10(most))
    return float(next(factor * power for factor in (5.0, 2.0, 1.0) if factor * power <= most * (1.0 + 1e-9)))


def metres_text(metres: float) -> str:
    """Say a length as people read it.

    Examples
    --------
    >>> metres_text(50.0), metres_text(2500.0), metres_text(0.2)
    ('50 m', '2.5 km', '0.2 m')
    """
    number, unit = (metres / 1000.0, "km") if abs(metres) >= 999.5 else (metres, "m")
    return f"{number:,.0f} {unit}" if abs(number) >= 99.95 else f"{number:.3g} {unit}"
