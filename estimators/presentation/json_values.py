"""Numbers and estimates in JSON-safe form: what JSON lacks becomes null.

Columns are converted as whole arrays: 1e5 points take milliseconds, not seconds.
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.result import Estimate


def numbers_to_json(values: FloatArray) -> list[float | None]:
    """Floats with None for what is not finite.

    Examples
    --------
    >>> numbers_to_json(np.array([1.5, np.nan]))
    [1.5, None]
    """
    if np.isfinite(values).all():
        return list(values.tolist())
    return [value if math.isfinite(value) else None for value in values.tolist()]


def estimate_to_dict(estimate: Estimate) -> dict[str, float | None]:
    """JSON-safe form of an estimate."""
    return {
        "value": estimate.value,
        "stderr": estimate.stderr,
        "low": estimate.low,
        "high": estimate.high,
    }
