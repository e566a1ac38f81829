"""Answers about positions as CSV."""

from __future__ import annotations

import csv
import io
from typing import Any

from service.codecs.positions.documents import written_times
from service.codecs.positions.rows import Column, columns_of, epochs_of
from service.positions.located import Located
from service.schemas.position_query import PositionAnswerQuery


def write_csv(located: Located, query: PositionAnswerQuery) -> bytes:
    """One line per satellite and epoch in the order the rows came, or one per epoch; empty is null."""
    columns = {name: _cells(column) for name, column in columns_of(located, query.rows).items()}
    times = written_times(located)
    if times:
        columns = {"time": [times[k] for k in epochs_of(located, query.rows).tolist()], **columns}
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(columns)
    lines.writerows(zip(*columns.values(), strict=True))
    return text.getvalue().encode()


def _cells(column: Column) -> list[Any]:
    if isinstance(column, list):
        return column
    if column.dtype.kind == "b":
        return ["true" if value else "false" for value in column.tolist()]
    # NaN is the one value that differs from itself.
    return ["" if value != value else value for value in column.tolist()]  # noqa: PLR0124
