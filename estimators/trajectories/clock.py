"""Runs of rows whose clock was off: the file goes on, the time jumps there and back.

A receiver writes fixes in the order in which they happen. Where the time jumps back and, some rows on,
forward by as much (or forward first), the rows between were stamped by a clock that was off, and the jump
says by how much. Rows that are merely in disorder make short runs, and are sorted.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray

_SHORTEST_RUN = 5
_MOST_JUMPS = 1000
"""Of files with more jumps the order says nothing."""
_LONG_STEP = 1.5
_AGREE = 0.5
"""By how many steps the jumps there and back may differ; the rows between have a step of their own."""


def clock_shifts(t: FloatArray) -> FloatArray:
    """Seconds to add to each time so that a run of shifted rows comes where the file has it.

    Parameters
    ----------
    t : ndarray, shape (n,)
        Seconds in the order of the file, finite.

    Returns
    -------
    ndarray, shape (n,)
        Mostly 0.

    Examples
    --------
    >>> clock_shifts(np.array([0, 1, 2, -2, -1, 0, 1, 2, 8, 9.0])).tolist()
    [0.0, 0.0, 0.0, 5.0, 5.0, 5.0, 5.0, 5.0, 0.0, 0.0]
    """
    shifts = np.zeros(t.size)
    steps = np.diff(t)
    backward = np.flatnonzero(steps < 0.0) + 1
    if not 0 < backward.size <= _MOST_JUMPS or not np.any(steps > 0.0):
        return shifts
    step = float(np.median(steps[steps > 0.0]))
    jumps = np.flatnonzero((steps < 0.0) | (steps > _LONG_STEP * step)) + 1
    explained = 0
    for first in backward.tolist():
        shift = step - float(steps[first - 1])
        place = int(np.searchsorted(jumps, first))
        runs = []
        if place + 1 < jumps.size and _matches(steps[jumps[place + 1] - 1], shift, step):
            runs.append((first, int(jumps[place + 1]), shift))
        if place > 0 and _matches(steps[jumps[place - 1] - 1], shift, step):
            runs.append((int(jumps[place - 1]), first, -shift))
        runs = [run for run in runs if run[1] - run[0] >= _SHORTEST_RUN and not shifts[run[0] : run[1]].any()]
        if runs:
            start, stop, by = min(runs, key=lambda run: run[1] - run[0])
            shifts[start:stop] = by
            explained += 1
    # Where most jumps are of another kind the file is in disorder, and runs are a matter of chance.
    return shifts if 2 * explained >= backward.size else np.zeros(t.size)


def _matches(forward: float, shift: float, step: float) -> bool:
    """Whether a step forward undoes a shift backward."""
    return abs(forward - step - shift) <= _AGREE * step
