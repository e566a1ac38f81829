"""The shapes a trend can have: one row each, read by the service, the command line and the documentation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from estimators.result import NoFit
from estimators.trends.bases.fit import fit_constant, fit_linear, fit_straight
from estimators.trends.choice import fit_auto
from estimators.trends.exponential.fit import fit_exponential
from estimators.trends.request import Request
from estimators.trends.trend import Trend


@dataclass(frozen=True, slots=True)
class TrendModel:
    """A trend shape.

    Attributes
    ----------
    name : str
        What callers pass as ``model``.
    title : str
    equation : str
    parameters : tuple of str
        Names in the answer.
    summary : str
    fit : callable
        From a :class:`~estimators.trends.request.Request` to the answer.
    any_magnitude : bool
        Whether ``fit`` itself copes with values whose squares underflow.
    takes : tuple of str
        Settings of :class:`~estimators.trends.bases.settings.Basis` that the shape has a use for.
    """

    name: str
    title: str
    equation: str
    parameters: tuple[str, ...]
    summary: str
    fit: Callable[[Request], Trend | NoFit]
    any_magnitude: bool = False
    takes: tuple[str, ...] = ()


_ROWS = (
    TrendModel(
        "line",
        "Straight line",
        "y = intercept + slope * (t - origin)",
        ("slope", "intercept"),
        "A constant rate of change.",
        fit_straight,
        takes=("seasonal", "harmonics"),
    ),
    TrendModel(
        "constant",
        "Level",
        "y = level",
        ("level",),
        "No change at all.",
        fit_constant,
        takes=("seasonal", "harmonics"),
    ),
    TrendModel(
        "linear",
        "Polynomial, seasons and own columns",
        "y = polynomial(t) + seasons(t) + columns",
        ("slope", "intercept", "slope_end", "power_2"),
        "Any sum of terms with a coefficient each.",
        fit_linear,
        takes=("degree", "seasonal", "harmonics", "columns"),
    ),
    TrendModel(
        "exponential",
        "Exponential growth or decay",
        "y = level * exp(rate * (t - origin))",
        ("rate", "level"),
        "A constant rate of growth; whether the noise grows along is told from the data.",
        fit_exponential,
        any_magnitude=True,
    ),
    TrendModel(
        "auto",
        "Told from the data",
        "that of the model chosen",
        (),
        "Level, line, parabola or exponential, as the values say; the evidence is in the answer.",
        fit_auto,
        takes=("seasonal", "harmonics"),
    ),
)

MODELS: Mapping[str, TrendModel] = MappingProxyType({row.name: row for row in _ROWS})
"""Trend shapes by name."""
