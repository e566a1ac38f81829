"""The columns of a trend: a polynomial, pairs of cosine and sine per period, the caller's own.

The polynomial is made of Legendre's, the best conditioned for times spread evenly over the frame [-1, 1];
the caller's columns are centred and scaled. All columns are then of size 1, as the searches expect.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from estimators.arrays import FloatArray
from estimators.trends.line.frame import Frame


@dataclass(frozen=True, slots=True)
class Season:
    """A periodic part of a trend.

    Attributes
    ----------
    period : float
        In the internal unit of time: seconds for points in time.
    harmonics : int
        Pairs of cosine and sine: of the period, of its half, and so on.
    chosen : bool
        Whether the period was found in the data, and not given.
    """

    period: float
    harmonics: int
    chosen: bool = False


@dataclass(frozen=True, slots=True)
class OwnColumn:
    """A column of the caller: its values enter as ``(value - mean) / size``."""

    name: str
    mean: float
    size: float

    @classmethod
    def of(cls, name: str, values: FloatArray) -> OwnColumn:
        """Centre and size of the values that take part."""
        mean = float(np.mean(values))
        size = float(np.max(np.abs(values - mean)))
        return cls(name, mean, size if size > 1e-12 * abs(mean) else 0.0)


@dataclass(frozen=True, slots=True)
class Design:
    """What the columns of a trend are, in order: polynomial, seasons, own columns.

    Attributes
    ----------
    frame : Frame
    degree : int
    seasons : tuple of Season
    own : tuple of OwnColumn
    """

    frame: Frame
    degree: int
    seasons: tuple[Season, ...] = ()
    own: tuple[OwnColumn, ...] = ()

    @property
    def size(self) -> int:
        """Number of columns."""
        return self.degree + 1 + 2 * sum(season.harmonics for season in self.seasons) + len(self.own)

    @property
    def polynomial(self) -> slice:
        """Coefficients of the polynomial."""
        return slice(0, self.degree + 1)

    def season(self, index: int) -> slice:
        """Coefficients of a season."""
        start = self.degree + 1 + 2 * sum(season.harmonics for season in self.seasons[:index])
        return slice(start, start + 2 * self.seasons[index].harmonics)

    def own_column(self, index: int) -> int:
        """Coefficient of a column of the caller."""
        return self.size - len(self.own) + index

    def columns(self, at: FloatArray, own: Mapping[str, FloatArray] | None = None) -> FloatArray:
        """Evaluate all columns at internal times.

        Parameters
        ----------
        at : ndarray of float64, shape (k,)
        own : mapping of str to ndarray of float64, shape (k,), optional
            The caller's columns at these times; without them they stand at their means.

        Returns
        -------
        ndarray of float64, shape (size, k), C-contiguous
        """
        made = np.empty((self.size, at.size))
        made[self.polynomial] = polynomial_columns(self.frame.apply(at), self.degree)
        for index, season in enumerate(self.seasons):
            made[self.season(index)] = season_columns(self.phase(at, season), season.harmonics)
        for index, column in enumerate(self.own):
            row = self.own_column(index)
            made[row] = 0.0 if own is None else (own[column.name] - column.mean) / column.size
        return made

    def phase(self, at: FloatArray, season: Season) -> FloatArray:
        """Phase of a season at internal times, in radians; 0 in the middle of the series."""
        turns = np.fmod(at - self.frame.middle, season.period) / season.period
        return np.asarray(2.0 * math.pi * turns)

    def with_seasons(self, seasons: tuple[Season, ...]) -> Design:
        """Exchange the seasons."""
        return dataclasses.replace(self, seasons=seasons)


def frame_of(t: FloatArray) -> Frame:
    """Frame of ascending times, which may all be equal."""
    frame = Frame.of(t)
    return frame if frame.half > 0.0 else Frame(frame.middle, 1.0)


def polynomial_columns(u: FloatArray, degree: int) -> FloatArray:
    """Legendre polynomials 0 to ``degree`` at frame times, by their recurrence, shape (degree + 1, k).

    Examples
    --------
    >>> polynomial_columns(np.array([-1.0, 0.0, 1.0]), 2)[2]
    array([ 1. , -0.5,  1. ])
    """
    made = np.empty((degree + 1, u.size))
    made[0] = 1.0
    if degree > 0:
        made[1] = u
    for k in range(1, degree):
        made[k + 1] = ((2 * k + 1) * u * made[k] - k * made[k - 1]) / (k + 1)
    return made


def polynomial_powers(degree: int) -> FloatArray:
    """Coefficients of powers of the frame time, shape (degree + 1, degree + 1): row k is that of P_k."""
    made = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        made[k, : k + 1] = legendre.leg2poly(np.eye(degree + 1)[k])[: k + 1]
    return made


def season_columns(phase: FloatArray, harmonics: int) -> FloatArray:
    """Cosine and sine of each harmonic, shape (2 harmonics, k)."""
    made = np.empty((2 * harmonics, phase.size))
    for k in range(harmonics):
        made[2 * k] = np.cos((k + 1) * phase)
        made[2 * k + 1] = np.sin((k + 1) * phase)
    return made


def season_slopes(phase: FloatArray, harmonics: int) -> FloatArray:
    """Differentiate :func:`season_columns` by the phase."""
    columns = season_columns(phase, harmonics)
    made = np.empty_like(columns)
    for k in range(harmonics):
        made[2 * k] = -(k + 1) * columns[2 * k + 1]
        made[2 * k + 1] = (k + 1) * columns[2 * k]
    return made
