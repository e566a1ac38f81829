"""What happens when a fix arrives: it is sorted in, and may settle the oldest open ones.

A fix is settled with at least three quarters of the lag of later fixes known, and at most the lag. Fixes
before the last settled one come too late; where that goes on the clock has been set back, and the track
begins anew.
"""

from __future__ import annotations

from bisect import bisect_right

from estimators.trajectories.live.answer import LiveRows, rows_of_track, rows_without_place
from estimators.trajectories.live.arrivals import as_time_column, missing_times
from estimators.trajectories.live.stream import Fix, Stream
from estimators.trajectories.live.window import learn, solve_window
from estimators.trajectories.reasons import FixReason
from estimators.trajectories.rows import LONGEST_S

_SET_BACK = 8
"""So many rows on end that come too late are no stragglers."""
_FIRST_LOOKS = (8, 16, 32, 64, 128)
_LOOK_EVERY = 64
"""Fixes after which noise and motion are estimated: soon at first, and then steadily."""


def advance(stream: Stream, row: int, fix: Fix | None) -> list[LiveRows]:
    """Take a row; return what it settles.

    Parameters
    ----------
    stream : Stream
        Changed in place.
    row : int
    fix : Fix or None
        None if the row has no time.
    """
    stream.received = row + 1
    if fix is None:
        return [rows_without_place([row], missing_times(1, stream.kind), FixReason.invalid)]
    settled = []
    if _is_late(stream, fix):
        if any(fix[1:4] == held[1:4] for held in stream.held):
            return [_unplaced(stream, fix, FixReason.duplicate)]
        stream.late += 1
        if stream.late < _SET_BACK:
            return [_unplaced(stream, fix, FixReason.out_of_order)]
        settled = settle(stream, stream.open)
        stream.begin_anew()
    stream.late = 0
    stamps = [held.stamp for held in stream.held]
    stream.held.insert(bisect_right(stamps, fix.stamp), fix)
    stream.taken += 1
    if stream.taken in _FIRST_LOOKS or stream.taken % _LOOK_EVERY == 0:
        learn(stream)
    lag = stream.settings.lag
    if stream.open > lag:
        settled += settle(stream, 1 + lag // 4)
    return settled


def settle(stream: Stream, count: int) -> list[LiveRows]:
    """Settle the oldest open fixes; one piece of answer, or none."""
    if count == 0:
        return []
    answer = open_rows(stream, count)
    stream.good += answer.inlier.tolist()
    stream.settled += count
    stream.forget_oldest()
    return [answer]


def open_rows(stream: Stream, count: int) -> LiveRows:
    """Say of the oldest open fixes what can be said now."""
    fixes = stream.held[stream.settled : stream.settled + count]
    rows, time = [fix.row for fix in fixes], as_time_column([fix.stamp for fix in fixes], stream.kind)
    if not fixes:
        return rows_without_place(rows, time, FixReason.ok)
    track, first = solve_window(stream)
    if track is None:
        return rows_without_place(rows, time, FixReason.invalid)
    return rows_of_track(track, stream.settled - first, rows, time)


def _is_late(stream: Stream, fix: Fix) -> bool:
    """Whether a fix lies before what is settled, or in another age."""
    if stream.settled and fix.stamp < stream.held[stream.settled - 1].stamp:
        return True
    return bool(stream.held) and any(
        abs(stream.seconds_between(end, fix)) > LONGEST_S for end in (stream.held[0], stream.held[-1])
    )


def _unplaced(stream: Stream, fix: Fix, reason: FixReason) -> LiveRows:
    return rows_without_place([fix.row], as_time_column([fix.stamp], stream.kind), reason)
