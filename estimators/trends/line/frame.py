"""The line: its normalising frame, and the way back from the frame to the caller's units.

Times are centred and scaled to [-1, 1] (METHODS.md 13.2: epoch seconds make the normal equations lose nine
digits); values stay in their own units, so that nothing is lost on the way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.inference.intervals import student_quantile
from estimators.inference.sandwich import LineUncertainty
from estimators.result import Estimate
from estimators.series import Series
from estimators.trends.curve import LineGeometry


@dataclass(frozen=True, slots=True)
class Frame:
    """Affine map of the time axis: ``frame time = (t - middle) / half``."""

    middle: float
    half: float

    @classmethod
    def of(cls, t: FloatArray) -> Frame:
        """Frame of ascending times with a positive span."""
        half = 0.5 * (float(t[-1]) - float(t[0]))
        return cls(0.5 * (float(t[-1]) + float(t[0])), half)

    def apply(self, t: FloatArray) -> FloatArray:
        """Map times to [-1, 1]."""
        return np.asarray((t - self.middle) / self.half)


def line_geometry(
    theta: FloatArray, frame: Frame, uncertainty: LineUncertainty | None, sigma: float, series: Series
) -> LineGeometry:
    """Line and its standard errors in the units of the series.

    Parameters
    ----------
    theta : ndarray of float64, shape (2,)
        Level at frame time 0 and slope per unit of frame time.
    frame : Frame
    uncertainty : LineUncertainty or None
    sigma : float
    series : Series
    """
    center = uncertainty.center if uncertainty is not None else 0.0
    return LineGeometry(
        center=frame.middle + frame.half * center,
        level=float(theta[0] + theta[1] * center),
        slope=float(theta[1]) / frame.half,
        level_stderr=math.nan if uncertainty is None else math.sqrt(uncertainty.level_variance),
        slope_stderr=math.nan if uncertainty is None else math.sqrt(uncertainty.slope_variance) / frame.half,
        sigma=sigma,
        span=(float(series.t[0]), float(series.t[-1])),
    )


def line_parameters(
    line: LineGeometry, intercept_at: float, level: float, dof: float | None
) -> dict[str, Estimate]:
    """Slope and intercept with intervals.

    Parameters
    ----------
    line : LineGeometry
    intercept_at : float
        Internal time at which the intercept is taken.
    level : float
        Confidence level.
    dof : float or None
        None leaves the uncertainty out.
    """
    away = intercept_at - line.center
    intercept = line.level + line.slope * away
    # hypot: standard errors of tiny values have squares that underflow.
    stderr = math.hypot(line.level_stderr, line.slope_stderr * away)
    return {
        "slope": _estimate(line.slope, line.slope_stderr, level, dof),
        "intercept": _estimate(intercept, stderr, level, dof),
    }


def _estimate(value: float, stderr: float, level: float, dof: float | None) -> Estimate:
    if dof is None:
        return Estimate(value, None, None, None)
    half = student_quantile(level, dof) * stderr
    return Estimate(value, stderr, value - half, value + half)
