"""An exponential under multiplicative noise: the line through the logarithms, with all that lines have.

Values of zero and of the minority's sign have no logarithm in it: they are flagged ``invalid`` and counted,
never dropped silently (METHODS.md 11.3).
"""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators.arrays import Reason
from estimators.result import NoFit, NoFitReason
from estimators.series import Series
from estimators.trends.curve import LineGeometry
from estimators.trends.exponential.curve import ExponentialCurve
from estimators.trends.line.fit import fit_line
from estimators.trends.request import Request, no_fit
from estimators.trends.trend import Trend


def majority_sign(series: Series) -> float:
    """Sign of most values: 1 or -1."""
    return 1.0 if np.count_nonzero(series.y > 0.0) >= np.count_nonzero(series.y < 0.0) else -1.0


def logarithms(series: Series, sign: float) -> tuple[Series, int]:
    """Series of ln|y| and the number of readings that have none.

    Parameters
    ----------
    series : Series
    sign : float
        From :func:`majority_sign`.
    """
    own = series.y * sign > 0.0
    left_out = int(series.n - np.count_nonzero(own))
    if not left_out:
        return dataclasses.replace(series, y=np.log(np.abs(series.y))), 0
    rows = np.arange(series.n) if series.rows is None else series.rows
    reasons = series.reasons.copy()
    reasons[rows[~own]] = Reason.invalid
    weights = None
    if series.weights is not None and own.any():
        weights = series.weights[own] / series.weights[own].mean()
    kept = dataclasses.replace(
        series,
        t=series.t[own],
        y=np.log(np.abs(series.y[own])),
        weights=weights,
        rows=rows[own],
        reasons=reasons,
    )
    return kept, left_out


def fit_multiplicative(request: Request) -> tuple[Trend, ExponentialCurve, int] | NoFit:
    """Fit the line through the logarithms.

    Parameters
    ----------
    request : Request
        Threshold and sigma are of ln(value).

    Returns
    -------
    tuple or NoFit
        The line of the logarithms as a trend, the exponential, and the readings without a logarithm.
    """
    sign = majority_sign(request.series)
    series, left_out = logarithms(request.series, sign)
    if series.n < 2:
        message = (
            f"{series.n or 'No'} usable point{'' if series.n == 1 else 's'} of one sign; an exponential "
            "under multiplicative noise needs two, and neither 0 nor values of the other sign occur in it."
        )
        return no_fit(NoFitReason.too_few_points, message, series)
    line = fit_line(dataclasses.replace(request, series=series))
    if isinstance(line, NoFit):
        return line
    geometry = line.geometry
    if not isinstance(geometry, LineGeometry):
        raise TypeError("the fit of a line has a line's geometry")
    first, last = float(request.series.t[0]), float(request.series.t[-1])
    curve = ExponentialCurve(
        noise="multiplicative",
        sign=sign,
        center=geometry.center,
        log_level=geometry.level,
        rate=geometry.slope,
        level_stderr=geometry.level_stderr,
        rate_stderr=geometry.slope_stderr,
        sigma=geometry.sigma,
        span=(first, last),
    )
    return line, curve, left_out
