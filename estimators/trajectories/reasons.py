"""Why a row of a track has the label it has."""

from __future__ import annotations

from enum import IntEnum


class FixReason(IntEnum):
    """What a row is; the names are what callers see.

    ``spike``: a fix that is off alone; ``burst``: one of several that are off together; ``stale``: an old
    position repeated while the track moves on; ``duplicate``: the same time and place as another row;
    ``out_of_order``: one of a run of rows whose clock was off; ``invalid``: no time, or no place on Earth;
    ``gap_edge``: beside a gap, so that only one side vouches for it.
    """

    ok = 0
    spike = 1
    burst = 2
    stale = 3
    duplicate = 4
    out_of_order = 5
    invalid = 6
    gap_edge = 7
