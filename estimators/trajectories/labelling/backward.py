"""Labels of a track read backward, as labels of the track.

A burst that is read backward begins at its last fix; where its offset jumps, the fix after the jump is the
one before it. What counts as a burst, a spike or good is the same in both directions.
"""

from __future__ import annotations

import numpy as np

from estimators.arrays import CodeArray
from estimators.trajectories.labelling.modes import (
    ADRIFT,
    BURST,
    ENTRY,
    EXIT,
    LEVEL_STRIDE,
    NOMINAL,
    REDRAW,
    SPIKE,
    TELEPORT,
)


def turned_round(backward: CodeArray) -> CodeArray:
    """Turn labels of the reversed track into labels in order of time.

    Parameters
    ----------
    backward : ndarray of uint8, shape (n,)
        As :class:`~estimators.trajectories.labelling.passage.Passage` labels a reversed track.

    Returns
    -------
    ndarray of uint8, shape (n,)

    Examples
    --------
    >>> turned_round(np.array([0, ENTRY, BURST, EXIT, 0], dtype=np.uint8)).tolist()
    [0, 0, 3, 4, 6]
    """
    labels = backward[::-1].copy()
    kind = labels % LEVEL_STRIDE
    labels[(kind == EXIT) | (kind == TELEPORT)] = NOMINAL
    told = np.flatnonzero((kind != SPIKE) & (kind != ADRIFT))
    if told.size == 0:
        return labels
    held = kind[told]
    levels = backward[::-1][told] // LEVEL_STRIDE
    bursting = np.isin(held, (ENTRY, BURST, REDRAW))
    # What happened between two fixes is written on the first of them backward, on the second forward.
    labels[told[bursting]] = BURST
    begins = bursting & ~np.concatenate([[False], bursting[:-1]])
    ends = ~bursting & np.concatenate([[False], bursting[:-1]])
    # A burst that follows another at once is one whose offset jumps.
    jumps = bursting & np.concatenate([[False], np.isin(held[:-1], (REDRAW, ENTRY))])
    labels[told[jumps]] = REDRAW
    labels[told[begins]] = ENTRY
    labels[told[ends]] = EXIT
    moved = np.concatenate([[False], held[:-1] == TELEPORT]) & ~bursting & ~ends
    labels[told[moved]] = TELEPORT + LEVEL_STRIDE * np.concatenate([[0], levels[:-1]])[moved]
    return labels
