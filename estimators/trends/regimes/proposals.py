"""Candidate lines: what the robust search finds in windows of all lengths.

A window that lies within one regime shows that regime's line, and the search of method ``auto`` finds it
among up to 60 % outliers; a window across a change shows one of the two. Lines from windows are proposals
only: :mod:`estimators.trends.regimes.path` chooses among them (as PEaRL does: Isack and Boykov 2012).
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray
from estimators.consensus.found import LineData, Scale
from estimators.consensus.presets import PRESETS
from estimators.options import RobustOptions
from estimators.result import NoFit
from estimators.trends.regimes.readings import Readings

SHORTEST_WINDOW = 12
"""Readings in a window; of fewer, a line and four outliers in ten cannot be told apart."""
MOST_WINDOWS = 64
"""Windows side by side on the finest of the scales."""


def propose_lines(readings: Readings, floor: float, options: RobustOptions) -> FloatArray:
    """Lines of half-overlapping windows, each scale half as long as the last.

    Parameters
    ----------
    readings : Readings
    floor : float
        Smallest noise scale that the values can show.
    options : RobustOptions

    Returns
    -------
    ndarray of float64, shape (k, 2)
        Level at 0 and slope; the first is the line at 0, which the series was measured from.
    """
    lines = [np.zeros(2)]
    scale = Scale(None, "given", None, "given", floor)
    parts = 1
    while parts <= MOST_WINDOWS and readings.n // parts >= SHORTEST_WINDOW:
        edges = np.linspace(0, readings.n, 2 * parts + 1).astype(np.int64)
        for start, stop in zip(edges[:-2], edges[2:], strict=True):
            line = _line_in(readings, int(start), int(stop), scale, options)
            if line is not None:
                lines.append(line)
        parts *= 2
    return np.array(lines)


def _line_in(
    readings: Readings, start: int, stop: int, scale: Scale, options: RobustOptions
) -> FloatArray | None:
    t = readings.t[start:stop]
    half = 0.5 * float(t[-1] - t[0])
    if half <= 0.0:
        return None
    middle = 0.5 * float(t[-1] + t[0])
    weights = None if readings.root is None else readings.root[start:stop] ** 2
    data = LineData((t - middle) / half, np.ascontiguousarray(readings.y[start:stop]), weights)
    found = PRESETS["auto"].search.run(data, scale, options, 0)
    if isinstance(found, NoFit):
        return None
    slope = float(found.theta[1]) / half
    return np.array([float(found.theta[0]) - slope * middle, slope])
