"""Series of values so small that their squares underflow: fitted in a larger unit, answered in their own.

The unit is a power of two, so that going there and back changes no digit of a normal number.
"""

from __future__ import annotations

import dataclasses
import math

from estimators.arrays import LARGEST_VALUE, FloatArray
from estimators.result import Notice
from estimators.trends.trend import Trend

_IN_UNITS_OF_THE_VALUES = frozenset({"sigma", "quantum", "slope", "intercept"})
"""Numbers in the details of notices that are measured in the values' unit."""


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
    if other is not None:
        parameters = {name: value * unit for name, value in other.parameters.items()}
        other = dataclasses.replace(other, parameters=parameters, sigma=other.sigma * unit)
    return dataclasses.replace(
        trend,
        parameters={name: value.scaled(unit) for name, value in trend.parameters.items()},
        points=dataclasses.replace(trend.points, residual=trend.points.residual * unit),
        consensus=dataclasses.replace(
            consensus, threshold=consensus.threshold * unit, sigma=consensus.sigma * unit
        ),
        rmse=None if trend.rmse is None else trend.rmse * unit,
        runner_up=other,
        notices=tuple(_notice(item, unit) for item in trend.notices),
        geometry=trend.geometry.in_value_units(unit),
    )


def _notice(item: Notice, unit: float) -> Notice:
    detail = {
        name: value * unit if name in _IN_UNITS_OF_THE_VALUES else value
        for name, value in item.detail.items()
    }
    return dataclasses.replace(item, detail=detail)
