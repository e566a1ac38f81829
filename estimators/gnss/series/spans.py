"""Which windows a series is cut into, and which epochs each of them answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray

_MOST_EPOCHS = 400
_STRIDES = 10
"""Windows that an epoch is in; each answers the epochs of its middle tenth."""


@dataclass(frozen=True, slots=True)
class Span:
    """Epochs ``first`` to ``last`` answer those from ``answer_first`` to ``answer_last``, ends excluded."""

    first: int
    last: int
    answer_first: int
    answer_last: int


def plan_windows(seconds: FloatArray, window_s: float, causal: bool) -> list[Span]:
    """Windows that answer every epoch once.

    Parameters
    ----------
    seconds : ndarray, shape (epochs,)
        In order.
    window_s : float
    causal : bool
        Whether an epoch may be answered by itself and earlier ones only.

    Examples
    --------
    >>> plan_windows(np.arange(4.0), 2.0, True)[-1]
    Span(first=1, last=4, answer_first=3, answer_last=4)
    """
    n = seconds.size
    spans = []
    k = 0
    while k < n:
        if causal:
            after = k + 1
            first, last = int(np.searchsorted(seconds, seconds[k] - window_s)), k + 1
        else:
            after = int(np.searchsorted(seconds, seconds[k] + window_s / _STRIDES))
            after = max(k + 1, after)
            middle = 0.5 * (seconds[k] + seconds[after - 1])
            first = int(np.searchsorted(seconds, middle - 0.5 * window_s))
            last = int(np.searchsorted(seconds, middle + 0.5 * window_s, side="right"))
        spare = _MOST_EPOCHS // 2
        first = max(first, (after - 2 * spare) if causal else (k - spare), 0)
        last = min(last, after if causal else after + spare, n)
        spans.append(Span(min(first, k), max(last, after), k, after))
        k = after
    return spans
