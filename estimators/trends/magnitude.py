"""Series of values so small that their squares underflow: fitted in a larger unit, answered in their own.

The unit is a power of two, so that going there and back changes no digit of a normal number.
"""

from __future__ import annotations

import dataclasses
import math

from estimators.arrays import LARGEST_VALUE, FloatArray
from estimators.notices import Notice
from estimators.trends.trend import Trend

_IN_UNITS_OF_THE_VALUES = frozenset({"sigma", "quantum", "slope", "intercept", "level"})
"""Numbers in the details of notices that are measured in the values' unit."""
_FREE_OF_UNITS = frozenset({"rate"})
"""Parameters that are not."""


def value_unit(y: FloatArray) -> float:
    """Choose the unit in which to fit: 1 unless all values are below ``1 / LARGEST_VALUE``.

    Parameters
    ----------
    y : ndarray of float64, shape (n,)
        n >= 1.

    Returns
    -------
    float
        Power of two.

    Examples
    --------
    >>> import numpy as np
    >>> value_unit(np.array([0.0, -3.0])), value_unit(np.array([0.0, -3e-300])) < 1e-299
    (1.0, True)
    """
    largest = max(float(y.max()), -float(y.min()))
    if largest == 0.0 or largest >= 1.0 / LARGEST_VALUE:
        return 1.0
    return math.ldexp(1.0, math.frexp(largest)[1])


def in_value_units(trend: Trend, unit: float) -> Trend:
    """Answer for ``y / unit`` as one for ``y``.

    Parameters
    ----------
    trend : Trend
    unit : float
        From :func:`value_unit`.
    """
    consensus, other = trend.consensus, trend.runner_up
    # Noise that is a share of the level is measured in no unit.
    of_noise = 1.0 if trend.noise is not None and trend.noise.domain == "multiplicative" else unit
    if other is not None:
        parameters = {
            name: value if name in _FREE_OF_UNITS else value * unit
            for name, value in other.parameters.items()
        }
        other = dataclasses.replace(other, parameters=parameters, sigma=other.sigma * of_noise)
    return dataclasses.replace(
        trend,
        parameters={
            name: value if name in _FREE_OF_UNITS or name.endswith("_peak") else value.scaled(unit)
            for name, value in trend.parameters.items()
        },
        points=dataclasses.replace(trend.points, residual=trend.points.residual * of_noise),
        consensus=dataclasses.replace(
            consensus, threshold=consensus.threshold * of_noise, sigma=consensus.sigma * of_noise
        ),
        rmse=None if trend.rmse is None else trend.rmse * of_noise,
        runner_up=other,
        notices=tuple(_notice(item, unit) for item in trend.notices),
        geometry=trend.geometry.in_value_units(unit),
        regimes=tuple(regime.in_value_units(unit) for regime in trend.regimes),
        alternative=None if trend.alternative is None else in_value_units(trend.alternative, unit),
    )


def _notice(item: Notice, unit: float) -> Notice:
    detail = {
        name: value * unit if name in _IN_UNITS_OF_THE_VALUES else value
        for name, value in item.detail.items()
    }
    return dataclasses.replace(item, detail=detail)
