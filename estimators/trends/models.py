"""The shapes a trend can have: one row each, read by the service, the command line and the documentation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from estimators.result import NoFit
from estimators.trends.line_fit import fit_line
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
    """

    name: str
    title: str
    equation: str
    parameters: tuple[str, ...]
    summary: str
    fit: Callable[[Request], Trend | NoFit]


_ROWS = (
    TrendModel(
        "line",
        "Straight line",
        "y = intercept + slope * (t - origin)",
        ("slope", "intercept"),
        "A constant rate of change.",
        fit_line,
    ),
)

MODELS: Mapping[str, TrendModel] = MappingProxyType({row.name: row for row in _ROWS})
"""Trend shapes by name."""
