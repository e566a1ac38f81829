r"""Noise and motion from differences: where the search for parameters starts.

A fix against the straight line between its neighbours a span h before and after has, per axis, the variance

    V(h) = 3/2 s^2 + c^2 (3/2 - 2 e^(-h/tau) + e^(-2h/tau) / 2) + q h^3 / 6

under white noise s, coloured noise (c, tau) and white acceleration q. V comes from a low quantile of
the squared distances, which bursts and spikes leave alone (METHODS_TRACKS, "A composition that works on
synthetic tracks").
"""

from __future__ import annotations

import math

import numpy as np

from estimators.arrays import FloatArray
from estimators.trajectories.labelling.modes import COLOUR_TIME_S

_QUANTILE = 0.2
_QUANTILE_OF = {1: 0.0641848, 2: -2.0 * math.log1p(-_QUANTILE)}
"""That quantile of chi-square, by the number of axes."""
_LONGEST_S = 24.0
_SPANS_S = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
_FEWEST = 8
_SHORTEST_S = 1e-9
_LEAST_M2 = 1e-4
_STEPS = 30
_DAMPING = 1e-3
PRIOR_LOG = np.array([math.log(4.0), 0.0, 0.0])
"""Means of the logarithms of white noise in metres, coloured noise in metres, and manoeuvre in m^2/s^3."""
PRIOR_SPREAD = np.array([1.5, 1.0, 2.5])


def span_variances(t: FloatArray, fixes: FloatArray) -> FloatArray:
    """Spans in seconds and variances per axis, shape (spans, 2); no rows where there are too few fixes.

    ``fixes`` has one axis or two, whose squared distances are sigma^2 times chi-square of as many degrees.
    """
    quantile = _QUANTILE_OF[fixes.shape[1]]
    n = t.size
    if n < 2 * _FEWEST:
        return np.empty((0, 2))
    step = float(np.median(np.diff(t)))
    if not step > 0.0:
        return np.empty((0, 2))
    steps = sorted({max(1, round(span / step)) for span in (step, 2 * step, *_SPANS_S)})
    rows = []
    for k in steps:
        if (k > 2 and k * step > _LONGEST_S) or n < 2 * k + _FEWEST:
            continue
        before, after = t[k:-k] - t[: -2 * k], t[2 * k :] - t[k:-k]
        even = (np.minimum(before, after) > 0.5 * k * step) & (np.maximum(before, after) < 2.0 * k * step)
        if np.count_nonzero(even) < _FEWEST:
            continue
        share = (after / np.maximum(before + after, _SHORTEST_S))[:, None]
        off = fixes[k:-k] - share * fixes[: -2 * k] - (1.0 - share) * fixes[2 * k :]
        squared = np.sum(off * off, axis=1)[even]
        variance = float(np.quantile(squared, _QUANTILE)) / quantile
        rows.append((0.5 * float(np.median((before + after)[even])), max(variance, _LEAST_M2)))
    return np.array(rows).reshape(-1, 2)


def start_from_spans(t: FloatArray, fixes: FloatArray) -> FloatArray:
    """Logarithms of s, c and q that fit V(h), by damped Gauss-Newton under wide log-normal priors.

    Parameters
    ----------
    t : ndarray, shape (n,)
    fixes : ndarray, shape (n, 1) or (n, 2)

    Returns
    -------
    ndarray, shape (3,)
    """
    spans = span_variances(t, fixes)
    logs = PRIOR_LOG.copy()
    if len(spans) == 0:
        return logs
    h, wanted = spans[:, 0], np.log(spans[:, 1])
    fade = np.exp(-h / COLOUR_TIME_S)
    shapes = np.column_stack([np.full(h.size, 1.5), 1.5 - 2.0 * fade + 0.5 * fade * fade, h**3 / 6.0])
    powers = np.array([2.0, 2.0, 1.0])
    for _ in range(_STEPS):
        parts = shapes * np.exp(powers * logs)
        total = parts.sum(axis=1)
        slope = parts * powers / total[:, None]
        off = wanted - np.log(total)
        pull = (PRIOR_LOG - logs) / PRIOR_SPREAD**2
        information = 4.0 * slope.T @ slope + np.diag(1.0 / PRIOR_SPREAD**2 + _DAMPING)
        step = np.linalg.solve(information, 4.0 * slope.T @ off + pull)
        logs = logs + np.clip(step, -1.0, 1.0)
    return logs
