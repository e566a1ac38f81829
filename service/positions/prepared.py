"""What has been read, ready to be solved: the one way from ranges to positions for HTTP and command line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from service.codecs.limits import Limits
from service.codecs.positions.columns import RangeColumns, Recording, check_ranges
from service.positions.located import Located, Progress
from service.positions.recordings import is_series, locate_observed, read_recording
from service.positions.tables import locate_columns
from service.schemas.positions import PositionArguments, RecordingArguments


@dataclass(frozen=True, slots=True)
class Prepared:
    """Ranges that were read and checked.

    Attributes
    ----------
    rows : int
        Ranges, for the bounds and the log.
    is_series : bool
        Whether the answer is one of many epochs.
    locate : callable
        Positions; called with a callable that is told the epochs done and in all, and may raise.
    """

    rows: int
    is_series: bool
    locate: Callable[[Progress], Located]


def prepare_table(columns: RangeColumns, arguments: PositionArguments, limits: Limits) -> Prepared:
    """Check a table of ranges.

    Raises
    ------
    Problem
        Naming the field and, where one is at fault, the row.
    """
    check_ranges(columns, arguments, limits)
    return Prepared(
        columns.rows,
        columns.time is not None,
        lambda progress: locate_columns(columns, arguments, progress),
    )


def prepare_recording(
    recording: Recording, arguments: RecordingArguments, limits: Limits, check: Callable[[], None]
) -> Prepared:
    """Read the files of a receiver.

    Raises
    ------
    Problem
        Naming the part that is at fault.
    """
    observed = read_recording(recording, arguments, limits, check)
    return Prepared(
        int(observed.source_row.size),
        is_series(observed, arguments),
        lambda progress: locate_observed(observed, arguments, progress),
    )
