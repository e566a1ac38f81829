"""Series and requests that many tests of the service share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

from service.errors import Problem

T = TypeVar("T")

JSON = {"content-type": "application/json"}
CSV = {"content-type": "text/csv"}


def attempt(read: Callable[[], T]) -> T | Problem:
    """What was read, or the problem that was met."""
    try:
        return read()
    except Problem as problem:
        return problem


def contaminated(n: int = 40) -> tuple[list[float], list[float]]:
    """Times and values of a line with noise and a few outliers."""
    rng = np.random.default_rng(7)
    times = np.arange(n, dtype=np.float64)
    values = 3.0 + 0.5 * times + 0.1 * rng.standard_normal(n)
    values[3::10] += 25.0
    return times.tolist(), values.tolist()


def body(**fields: Any) -> dict[str, Any]:
    """JSON body of a contaminated line with some fields changed."""
    times, values = contaminated()
    return {"time": times, "value": values} | fields
