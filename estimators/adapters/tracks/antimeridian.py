"""Lines cut where they cross longitude 180, as RFC 7946, section 3.1.9, asks for: :func:`cut_line`."""

from __future__ import annotations

import numpy as np

from estimators.arrays import FloatArray

Piece = FloatArray


def cut_line(line: FloatArray) -> list[Piece]:
    """Cut a line of positions at the antimeridian.

    Parameters
    ----------
    line : ndarray of float64, shape (n, k)
        Longitude and latitude in degrees, and whatever else is linear along the line.

    Returns
    -------
    list of ndarray, shape (m, k)
        Each within -180 to 180, without a step of more than half a turn. Where the line crosses, both pieces
        have the crossing as their end, with everything else interpolated.

    Examples
    --------
    >>> import numpy as np
    >>> [piece.tolist() for piece in cut_line(np.array([[179.0, 0.0], [-179.0, 1.0]]))]
    [[[179.0, 0.0], [180.0, 0.5]], [[-180.0, 0.5], [-179.0, 1.0]]]
    """
    pieces: list[Piece] = []
    start = 0
    head = line[:0]
    for at in np.flatnonzero(np.abs(np.diff(line[:, 0])) > 180.0).tolist():
        before, after = line[at], line[at + 1]
        side = 180.0 if before[0] > 0.0 else -180.0
        way = after[0] + 2.0 * side - before[0]
        share = (side - before[0]) / way if way else 0.0
        crossing = before + share * (after - before)
        end, begin = crossing.copy(), crossing
        end[0], begin[0] = side, -side
        pieces.append(np.vstack([head, line[start : at + 1], end]))
        head, start = begin[np.newaxis], at + 1
    pieces.append(np.vstack([head, line[start:]]))
    return pieces
