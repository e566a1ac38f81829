"""Readings and the robust loss of lines through them: squares in noise scales, cut off for outliers.

The loss min(u^2, 3^2), u = residual / sigma, is the biweight of Fearnhead and Rigaill (2019), "Changepoint
detection in the presence of outliers": no reading, however far off, can pay for a change on its own.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray

CUT = 3.0
"""Noise scales beyond which a reading is an outlier (Fearnhead and Rigaill 2019: K = 3 sigma)."""

_POLISHES = 20


@dataclass(frozen=True, slots=True)
class Readings:
    """Readings in order of time.

    Attributes
    ----------
    t, y : ndarray of float64, shape (n,)
        Time from -1 to 1; values.
    root : ndarray of float64, shape (n,), or None
        Square roots of the weights.
    sigma : float
        Noise scale of a reading of mean weight.
    """

    t: FloatArray
    y: FloatArray
    root: FloatArray | None
    sigma: float

    @property
    def n(self) -> int:
        """Number of readings."""
        return int(self.t.size)

    def scores(self, line: FloatArray, rows: IntArray | slice = slice(None)) -> FloatArray:
        """Residuals of a line ``(level at 0, slope)`` in noise scales."""
        off = (self.y[rows] - line[0] - line[1] * self.t[rows]) / self.sigma
        return np.asarray(off if self.root is None else off * self.root[rows])

    def losses(self, line: FloatArray, rows: IntArray | slice = slice(None)) -> FloatArray:
        """Loss of every reading under a line."""
        score = self.scores(line, rows)
        return np.minimum(score * score, CUT * CUT)

    def loss(self, line: FloatArray, rows: IntArray) -> float:
        """Loss of some readings under a line."""
        return float(self.losses(line, rows).sum())


@dataclass(frozen=True, slots=True)
class FittedLine:
    """A line and its loss on the readings it was polished on."""

    line: FloatArray
    loss: float


def polish(readings: Readings, rows: IntArray, start: FloatArray) -> FittedLine:
    """Descend to a local minimum of the loss: least squares on the readings within the cut, repeated.

    Every step minimises a parabola that lies on or above the loss and touches it where the step starts, so
    that none makes the loss larger.

    Parameters
    ----------
    readings : Readings
    rows : ndarray of int64
        Readings to fit.
    start : ndarray of float64, shape (2,)

    Returns
    -------
    FittedLine
    """
    t, y = readings.t[rows], readings.y[rows]
    weight = None if readings.root is None else readings.root[rows] ** 2
    best = FittedLine(start, readings.loss(start, rows))
    for _ in range(_POLISHES):
        near = np.abs(readings.scores(best.line, rows)) <= CUT
        line = _least_squares(t, y, weight, near)
        if line is None:
            break
        loss = readings.loss(line, rows)
        if loss >= best.loss * (1.0 - 1e-9):
            break
        best = FittedLine(line, loss)
    return best


def _least_squares(
    t: FloatArray, y: FloatArray, weight: FloatArray | None, near: BoolArray
) -> FloatArray | None:
    """Line through some readings; None where they do not determine one."""
    if np.count_nonzero(near) < 2:
        return None
    t, y = t[near], y[near]
    w = np.ones(t.size) if weight is None else weight[near]
    total = float(w.sum())
    t_mean, y_mean = float((w * t).sum()) / total, float((w * y).sum()) / total
    away = t - t_mean
    spread = float((w * away * away).sum())
    if spread <= 0.0:
        return None
    slope = float((w * away * (y - y_mean)).sum()) / spread
    return np.array([y_mean - slope * t_mean, slope])
