"""Track files to recordings; refusals name the part of the request that is at fault."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from estimators import InputError
from estimators.adapters.tracks import Recording, read_track
from estimators.adapters.tracks.field_names import ColumnError
from estimators.adapters.tracks.source import MOST_BYTES, Source, TooLargeError
from service.codecs.limits import Limits
from service.errors import Problem, ProblemType, invalid_value
from service.schemas.fields import TimeUnit
from service.schemas.trajectories import COLUMN_PARAMETERS
from service.trajectories.ellipses import named_ellipse, refuse_both
from service.trajectories.recorded import TABLES

_FOR_TABLES = "is for tables (CSV, Arrow, Parquet); leave it out with other files"


def read_files(
    sources: Sequence[Source],
    *,
    columns: Mapping[str, str],
    time_unit: TimeUnit | None,
    limits: Limits,
    check: Callable[[], object],
    field: str,
) -> list[Recording]:
    """Read files of any format; their content tells which.

    Parameters
    ----------
    sources : sequence of bytes or Path
    columns : mapping of str to str
        Columns of tables by what they are, where they have not the usual names.
    time_unit : {"s", "ms", "us", "ns"} or None
        Of times in tables that are numbers.
    limits : Limits
        Of the unpacked bytes of each file, of all rows, and of devices.
    check : callable
        Called while files are read; raises if nobody waits any more.
    field : str
        What a problem of a file names.

    Raises
    ------
    Problem
        422 if a file is not what it should be, 413 beyond the limits.
    """
    refuse_both(columns, COLUMN_PARAMETERS)
    recordings: list[Recording] = []
    for place, source in enumerate(sources):
        which = f"file {place + 1}: " if len(sources) > 1 else ""
        try:
            recording = read_track(
                source,
                columns=columns,
                time_unit=time_unit,
                most_bytes=limits.unpacked_bytes or MOST_BYTES,
                check=check,
            )
        except TooLargeError as error:
            raise Problem(
                ProblemType.body_too_large,
                f"{which}unpacked, the file {error.message}",
                extra={"limit": limits.unpacked_bytes},
            ) from error
        except ColumnError as error:
            # The library's words repeat the header of the file.
            raise _no_column(error, field, which) from error
        except InputError as error:
            named = field if error.field == "track" else error.field
            raise invalid_value(named, f"{which}{error.message}") from error
        _refuse_unused(recording, columns, time_unit)
        recordings.append(named_ellipse(recording, columns))
        limits.check_points(sum(map(len, recordings)))
        limits.check_series(sum(len(item.devices) for item in recordings))
    return recordings


def _no_column(error: ColumnError, field: str, which: str) -> Problem:
    """Problem of a table without a column that was named, or that it must have."""
    if error.field == "columns":
        return invalid_value(
            COLUMN_PARAMETERS[error.columns[0]], f"{which}the table has no column of this name"
        )
    missing = ", ".join(error.columns)
    return invalid_value(
        field, f"{which}has no column for {missing} in its header; rename, or say which it is"
    )


def _refuse_unused(recording: Recording, columns: Mapping[str, str], time_unit: TimeUnit | None) -> None:
    """Refuse arguments of tables beside files that are none."""
    if recording.form in TABLES:
        return
    if time_unit is not None:
        raise invalid_value("time_unit", _FOR_TABLES)
    for role in columns:
        raise invalid_value(COLUMN_PARAMETERS[role], _FOR_TABLES)
