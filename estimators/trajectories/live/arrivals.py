"""The door of live tracks: columns of a call become fixes that arrive one after the other."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from estimators.arrays import ArrayLike, FloatArray, InputError
from estimators.trajectories.columns import HEIGHT_M, column_of, on_earth
from estimators.trajectories.live.stream import Fix, Stream, TimeKind
from estimators.trajectories.rows import times_of


def arrivals(
    stream: Stream,
    t_s: ArrayLike,
    lat_deg: ArrayLike,
    lon_deg: ArrayLike,
    height_m: ArrayLike | None,
    accuracy_m: ArrayLike | None,
) -> list[Fix | None]:
    """Read the rows of a call.

    Returns
    -------
    list of Fix or None
        None where a row has no time.

    Raises
    ------
    InputError
        As :func:`estimators.clean_trajectory`, and if times are of another kind than before.
    """
    internal, axis, column = times_of(t_s)
    n = internal.size
    latitude, longitude = column_of(lat_deg, "lat_deg", n), column_of(lon_deg, "lon_deg", n)
    placed = on_earth(latitude, longitude)
    latitude, longitude = np.where(placed, latitude, np.nan), np.where(placed, longitude, np.nan)
    unknown = np.full(n, np.nan)
    height = unknown if height_m is None else _short(column_of(height_m, "height_m", n), -HEIGHT_M)
    accuracy = unknown if accuracy_m is None else _short(column_of(accuracy_m, "accuracy_m", n), 0.0)
    timed = np.isfinite(internal)
    if timed.any():
        _agree_on_kind(stream, "datetime" if axis.kind == "datetime" else "number")
    if axis.kind == "datetime":
        stamps: list[int | float] = column.astype("datetime64[ns]").astype(np.int64).tolist()
    else:
        stamps = column.astype(np.float64).tolist()
    rows = range(stream.received, stream.received + n)
    columns = (rows, stamps, latitude.tolist(), longitude.tolist(), height.tolist(), accuracy.tolist())
    fixes = (Fix(*values) for values in zip(*columns, strict=True))
    return [fix if known else None for fix, known in zip(fixes, timed.tolist(), strict=True)]


def as_time_column(stamps: list[int | float], kind: TimeKind) -> npt.NDArray[np.float64 | np.datetime64]:
    """Give the caller's times of fixes."""
    if kind == "datetime":
        return np.array(stamps, dtype=np.int64).astype("datetime64[ns]")
    return np.array(stamps, dtype=np.float64)


def missing_times(n: int, kind: TimeKind) -> npt.NDArray[np.float64 | np.datetime64]:
    """Give as many times that are missing."""
    return np.full(n, "NaT", dtype="datetime64[ns]") if kind == "datetime" else np.full(n, np.nan)


def _agree_on_kind(stream: Stream, kind: TimeKind) -> None:
    if stream.kind not in ("none", kind):
        before = "points in time" if stream.kind == "datetime" else "numbers of seconds"
        raise InputError("t_s", f"the track so far has {before}; send those, or begin anew without a state")
    stream.kind = kind


def _short(values: FloatArray, above: float) -> FloatArray:
    """Round to 32 bits, as the state holds them; NaN for what cannot be."""
    with np.errstate(invalid="ignore"):
        sound = (values > above) & (values < HEIGHT_M)
    return np.where(sound, values, np.nan).astype(np.float32).astype(np.float64)
