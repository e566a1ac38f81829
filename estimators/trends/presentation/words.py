"""What every shape says of itself: its equation, its parameters and a rival, as short strings."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from estimators.result import Estimate
from estimators.trends.presentation.units import MISSING, rounded

if TYPE_CHECKING:
    from estimators.trends.trend import RunnerUp, Trend


@dataclass(frozen=True, slots=True)
class EstimateLine:
    """One parameter in words: name with its unit, value, standard error, interval, p-value."""

    name: str
    value: str
    stderr: str
    interval: str
    p_value: str


class Words(Protocol):
    """How one shape of trend is put into words; stateless."""

    def equation(self, trend: Trend, time_name: str, value_name: str) -> str:
        """Fitted equation with rounded numbers."""
        ...

    def estimates(self, trend: Trend, time_name: str) -> Iterable[EstimateLine]:
        """Lines of the table of parameters."""
        ...

    def rival(self, trend: Trend, other: RunnerUp) -> str:
        """Parameters of a runner-up."""
        ...


def estimate_line(name: str, estimate: Estimate, p_value: str = "") -> EstimateLine:
    """Put an estimate into words, with the digits that its standard error supports.

    Parameters
    ----------
    name : str
    estimate : Estimate
    p_value : str
    """
    return EstimateLine(
        name=name,
        value=rounded(estimate.value, estimate.stderr),
        stderr=MISSING if estimate.stderr is None else rounded(estimate.stderr, estimate.stderr),
        interval=interval_text(estimate.low, estimate.high, estimate.stderr),
        p_value=p_value,
    )


def interval_text(low: float | None, high: float | None, scale: float | None) -> str:
    """Interval with the digits of an uncertainty, or a dash where there is none."""
    if low is None or high is None or not (math.isfinite(low) and math.isfinite(high)):
        return MISSING
    return f"[{rounded(low, scale)}, {rounded(high, scale)}]"
