"""Frame, least noise scale and unit of many series, compiled.

The same numbers as :class:`estimators.trends.line.frame.Frame`,
:func:`estimators.noise.resolution.scale_floor` and :func:`estimators.trends.magnitude.value_unit` give for
one. Series with many tied values, which are rounded ones, are left to
:func:`estimators.noise.resolution.find_quantisation`.
"""

from __future__ import annotations

import numpy as np
from numba import types

from estimators.arrays import LARGEST_VALUE, BoolArray, FloatArray, IntArray
from estimators.consensus.structure.ranking import sort_values
from estimators.inference.chance import central_range
from estimators.kernels import kernel, ro
from estimators.noise.resolution import TIED_SHARE, find_quantisation, scale_floor
from estimators.trends.batch.group import Group
from estimators.trends.batch.ready import Ready
from estimators.trends.line.fit import LEAST_FLOOR

_SAMPLE = 4096
_ULPS = 4.0
_EPS = float(np.finfo(np.float64).eps)
_TINY = float(np.finfo(np.float64).tiny)
_REAL, _INT, _FLAG = types.float64, types.int64, types.boolean


def measure_group(ready: Ready, sigma: float | None) -> Group:
    """Put series into their frames and measure their least noise scales.

    Parameters
    ----------
    ready : Ready
    sigma : float or None
        A given noise scale; the least is no larger.
    """
    m = ready.series.size
    t = np.empty(ready.t.size)
    middle, half, floor, central, quantum = np.empty(m), np.empty(m), np.empty(m), np.empty(m), np.zeros(m)
    constant, ordinary, tied = (np.empty(m, dtype=np.bool_) for _ in range(3))
    fill_scales(ready.offsets, ready.t, ready.y, t, middle, half, floor, central, constant, ordinary, tied)
    for k in np.flatnonzero(tied).tolist():
        rows = slice(int(ready.offsets[k]), int(ready.offsets[k + 1]))
        quantisation = find_quantisation(ready.y[rows], ready.t[rows])
        if quantisation.is_quantised:
            quantum[k] = quantisation.quantum
            floor[k] = scale_floor(ready.y[rows], quantisation)
    for k in np.flatnonzero(np.diff(ready.offsets) > _SAMPLE).tolist():
        central[k] = central_range(ready.y[ready.offsets[k] : ready.offsets[k + 1]])
    np.maximum(floor, LEAST_FLOOR, out=floor)
    if sigma is not None:
        np.minimum(floor, sigma, out=floor)
    return Group(
        ready.series, ready.offsets, t, ready.y, ready.weights, ready.rows, ready.origin, middle, half,
        floor, central, quantum, constant, ordinary, ready.checked,
    )  # fmt: skip


@kernel(
    types.void(
        ro(_INT), ro(_REAL), ro(_REAL), _REAL[::1], _REAL[::1], _REAL[::1], _REAL[::1], _REAL[::1],
        _FLAG[::1], _FLAG[::1], _FLAG[::1],
    )
)  # fmt: skip
def fill_scales(
    offsets: IntArray,
    t: FloatArray,
    y: FloatArray,
    in_frame: FloatArray,
    middle: FloatArray,
    half: FloatArray,
    floor: FloatArray,
    central: FloatArray,
    constant: BoolArray,
    ordinary: BoolArray,
    tied: BoolArray,
) -> None:
    """Fill columns of :class:`Group`; ``tied`` says where the values may be quantised."""
    room = np.empty(_SAMPLE)
    for k in range(offsets.size - 1):
        a, b = offsets[k], offsets[k + 1]
        n = b - a
        middle[k] = 0.5 * (t[b - 1] + t[a])
        half[k] = 0.5 * (t[b - 1] - t[a])
        low, high = y[a], y[a]
        for i in range(a, b):
            in_frame[i] = (t[i] - middle[k]) / half[k]
            low = min(low, y[i])
            high = max(high, y[i])
        constant[k] = low == high
        largest = max(high, -low)
        ordinary[k] = largest == 0.0 or largest >= 1.0 / LARGEST_VALUE
        size = min(n, _SAMPLE)
        for i in range(size):
            room[i] = y[a + (i if n <= _SAMPLE else i * n // _SAMPLE)]
        ordered = room[:size]
        sort_values(ordered)
        ties = 0
        for i in range(1, size):
            ties += ordered[i] == ordered[i - 1]
        tied[k] = 2 * ties > TIED_SHARE * size
        tenth = size // 10
        central[k] = ordered[19 * size // 20] - ordered[size // 20]
        largest = max(abs(ordered[tenth]), abs(ordered[size - 1 - tenth]))
        spacing = np.nextafter(largest, np.inf) - largest
        spread = ordered[size - 1 - tenth] - ordered[tenth]
        floor[k] = max(_ULPS * spacing, _EPS * spread, _TINY)
