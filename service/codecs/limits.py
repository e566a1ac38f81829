"""Bounds of what is read, and what the arrays of a request must hold, whatever format they came in."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from estimators.arrays import LARGEST_TIME, LARGEST_VALUE, SMALLEST_TIME
from estimators.trends.bases.settings import MOST_COLUMNS
from service.codecs.columns import Columns
from service.errors import Problem, ProblemType, invalid_value

#: Of a caller's own column; the name comes back as that of a parameter.
LONGEST_NAME = 100

#: A body may unpack to so many times the largest body: honest tables compress by less, and a bomb by a
#: thousand times.
UNPACKED_PER_BODY = 4


@dataclass(frozen=True, slots=True)
class Limits:
    """Most that is read; None is no limit.

    Attributes
    ----------
    points : int or None
        Rows.
    series : int or None
    unpacked_bytes : int or None
        Bytes of columns once they are decompressed.
    """

    points: int | None = None
    series: int | None = None
    unpacked_bytes: int | None = None

    def check_points(self, count: int) -> None:
        """Refuse more rows than are taken (413)."""
        if self.points is not None and count > self.points:
            raise Problem(
                ProblemType.too_many_points,
                f"{count} rows; at most {self.points} are taken",
                extra={"limit": self.points},
            )

    def check_series(self, count: int) -> None:
        """Refuse more series than are taken (413)."""
        if self.series is not None and count > self.series:
            raise Problem(
                ProblemType.too_many_series,
                f"more than {self.series} series; send them in several batches",
                extra={"limit": self.series},
            )

    def check_bytes(self, count: int) -> None:
        """Refuse what unpacks to more than is taken (413)."""
        if self.unpacked_bytes is not None and count > self.unpacked_bytes:
            raise Problem(
                ProblemType.body_too_large,
                f"the columns unpack to more than {self.unpacked_bytes} bytes; send fewer rows or columns",
                extra={"limit": self.unpacked_bytes},
            )


def check_columns(columns: Columns, max_points: int) -> None:
    """Check that columns belong together and can be computed with, and make them read-only.

    Parameters
    ----------
    columns : Columns
    max_points : int
        Most rows, and most times to predict at.

    Raises
    ------
    Problem
        Naming the column and, where one is at fault, the row.
    """
    _check_lengths(columns, max_points)
    if columns.weight is not None:
        _refuse(~(columns.weight >= 0), "weight", "weights are precisions: numbers that are not negative")
    if columns.predict is not None:
        _refuse(np.isnan(columns.predict), "predict", "a time is missing")
    too_large = f"is beyond ±{LARGEST_VALUE:g}, where squares overflow; choose a larger unit"
    _refuse(np.abs(columns.value) > LARGEST_VALUE, "value", too_large)
    if columns.form.kind == "number":
        _check_plain_times(columns)
    for column in (columns.time, columns.value, columns.weight, columns.predict, *columns.own.values()):
        if column is not None:
            column.flags.writeable = False


def check_names(names: Sequence[str], field: str) -> None:
    """Check the names of a caller's own columns, before any of them is read.

    Raises
    ------
    Problem
        If there are too many, or a name is empty, too long or given twice.
    """
    if len(names) > MOST_COLUMNS:
        raise invalid_value(field, f"{len(names)} columns; at most {MOST_COLUMNS} can be fitted together")
    for name in names:
        if not 0 < len(name) <= LONGEST_NAME or not name.isprintable():
            raise invalid_value(field, f"a name has 1 to {LONGEST_NAME} printable characters")
        if names.count(name) > 1:
            raise invalid_value(field, "a column is named twice; name each once")


def _check_lengths(columns: Columns, max_points: int) -> None:
    rows = columns.time.size
    if rows == 0:
        raise invalid_value("time", "is empty; send at least one row")
    longest = max(rows, columns.value.size, 0 if columns.predict is None else columns.predict.size)
    if longest > max_points:
        message = f"{longest} rows; at most {max_points} are taken"
        raise Problem(ProblemType.too_many_points, message, extra={"limit": max_points})
    if columns.value.size != rows:
        raise invalid_value("value", f"{columns.value.size} values for {rows} times; send one value per time")
    if columns.weight is not None and columns.weight.size != rows:
        raise invalid_value("weight", f"{columns.weight.size} weights for {rows} times; send one per time")
    for name, column in columns.own.items():
        if column.size != rows:
            raise invalid_value(
                f"columns.{name}", f"{column.size} entries for {rows} times; send one per time"
            )


def _check_plain_times(columns: Columns) -> None:
    """Refuse numbers that are no times of anything, and integers further apart than 64 bits."""
    ends = []
    for field, column in (("time", columns.time), ("predict", columns.predict)):
        if column is None or not column.size:
            continue
        if np.issubdtype(column.dtype, np.integer):
            ends += [int(column.min()), int(column.max())]
        else:
            size = np.abs(column.astype(np.float64))
            message = f"is neither 0 nor between {SMALLEST_TIME:g} and {LARGEST_TIME:g}; choose another unit"
            _refuse((size > LARGEST_TIME) | ((size > 0) & (size < SMALLEST_TIME)), field, message)
    if ends and max(ends) - min(ends) >= 2**63:
        raise invalid_value("time", "times lie further apart than 64-bit integers can tell; use another unit")


def _refuse(bad: npt.NDArray[Any], field: str, message: str) -> None:
    if np.any(bad):
        raise invalid_value(field, message, int(np.argmax(bad)))
