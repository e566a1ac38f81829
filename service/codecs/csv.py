"""CSV in (a header and named columns) and out (one row per input row).

Empty cells and the usual spellings of "not available" are missing values. Numbers that are all integers
stay integers, as in JSON. The arguments of the fit come from the query string.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import orjson

from estimators import Trend
from estimators.trends.presentation.dictionary import fitted_values
from service.codecs.arguments import read_arguments
from service.codecs.columns import Columns, TimeForm, Times, from_epoch
from service.codecs.limits import check_names
from service.codecs.times import parse_iso
from service.errors import FieldError, Problem, ProblemType, invalid_value
from service.schemas.fields import TimeUnit
from service.schemas.options import AnswerQuery, FitArguments, TrendQuery

HEADER = (
    "time",
    "value",
    "fit",
    "confidence_low",
    "confidence_high",
    "prediction_low",
    "prediction_high",
    "inlier",
    "probability",
    "residual",
    "reason",
)

#: What spreadsheets, R, pandas and SQL write for "not available"; compared in lower case.
MISSING = frozenset({"", "na", "n/a", "nan", "null", "none", "nat"})

_ISO_START = re.compile(r"\d{4}-\d\d", re.ASCII)
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)

#: The shortest exact text of a float64 has 24 characters, its longest exact expansion about 770.
LONGEST_NUMBER = 800


def read_csv(body: bytes, query: TrendQuery) -> tuple[Columns, FitArguments]:
    """Columns and arguments of a CSV body.

    Raises
    ------
    Problem
        If the body is not CSV in UTF-8, a column is not there, or a cell cannot be read.
    """
    arguments = read_arguments(query.fit_arguments())
    header, rows = split_table(body)
    time_cells = _column(header, rows, query.time_column, "time")
    value_cells = _column(header, rows, query.value_column, "value")
    weight: npt.NDArray[np.float64] | None = None
    if query.weight_column is not None or "weight" in header:
        weight = read_cells(_column(header, rows, query.weight_column, "weight"), "weight")
    time, form = read_time_cells(time_cells, "time", arguments.time_unit)
    predict: Times | None = None
    if query.predict:
        asked = [cell for item in query.predict for cell in item.split(",")]
        predict, asked_form = read_time_cells(asked, "predict", arguments.time_unit)
        if asked_form != form:
            raise invalid_value("predict", "must be written in the same form as the time column")
    names = [name.strip() for item in query.own_columns or () for name in item.split(",")]
    check_names(names, "columns")
    own = {name: read_cells(_column(header, rows, name, "columns"), f"columns.{name}") for name in names}
    horizon: Times | None = None
    if query.horizon is not None:
        horizon = read_horizon(query.horizon, arguments.time_unit, form)
    return Columns(time, read_cells(value_cells, "value"), weight, predict, form, horizon, own), arguments


def read_horizon(text: str, unit: TimeUnit | None, form: TimeForm) -> Times:
    """Time by which values are to be reached, from the query string.

    Parameters
    ----------
    text : str
    unit : {"s", "ms", "us", "ns"} or None
    form : TimeForm
        Of the series.

    Returns
    -------
    ndarray, shape (1,)

    Raises
    ------
    Problem
        If it is no time, or written in another form than those of the series.
    """
    horizon, asked_form = read_time_cells([text], "horizon", unit)
    if asked_form != form:
        raise invalid_value("horizon", "must be written in the same form as the time column")
    return horizon


def write_csv(trend: Trend, columns: Columns, _query: AnswerQuery) -> bytes:
    """One row per input row: the series, the trend, both bands and the label."""
    bands = trend.predict(trend.time)
    cells: list[list[bytes]] = [
        _time_cells(columns),
        _cells(columns.value),
        _cells(fitted_values(trend)),
        _cells(bands.confidence_low),
        _cells(bands.confidence_high),
        _cells(bands.prediction_low),
        _cells(bands.prediction_high),
        _cells(trend.points.inlier),
        _cells(trend.points.probability),
        _cells(trend.points.residual),
        [reason.encode() for reason in trend.points.reason],
    ]
    lines = map(b",".join, zip(*cells, strict=True))
    return b"\n".join([",".join(HEADER).encode(), *lines, b""])


def _cells(column: Any) -> list[bytes]:
    """Cells of numbers or booleans: the shortest text that reads back as the same; empty for NaN."""
    texts = orjson.dumps(column, option=orjson.OPT_SERIALIZE_NUMPY)[1:-1].split(b",")
    return [b"" if text == b"null" else text for text in texts]


def _time_cells(columns: Columns) -> list[bytes]:
    rendered = columns.form.render(columns.time)
    if isinstance(rendered, list):
        return [b"" if item is None else str(item).encode() for item in rendered]
    if np.issubdtype(rendered.dtype, np.datetime64):
        texts: list[str] = np.datetime_as_string(np.asarray(rendered, dtype="datetime64[s]")).tolist()
        return [f"{text}Z".encode() for text in texts]
    return _cells(np.ascontiguousarray(rendered))


def split_table(body: bytes) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a CSV body; a Problem where it is not CSV in UTF-8 or a row has other cells."""
    try:
        text = body.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise Problem(ProblemType.malformed_body, "the CSV is not valid UTF-8") from None
    try:
        table = list(csv.reader(io.StringIO(text, newline=""), strict=True))
    except csv.Error:
        raise Problem(ProblemType.malformed_body, "the CSV is broken: check its quotes") from None
    table = [row for row in table if row]
    if not table:
        raise Problem(ProblemType.empty_body)
    header = [name.strip() for name in table[0]]
    rows = table[1:]
    ragged = next((number for number, row in enumerate(rows) if len(row) != len(header)), None)
    if ragged is not None:
        message = f"row {ragged} has {len(rows[ragged])} cells, the header has {len(header)}"
        raise Problem(ProblemType.malformed_body, message, errors=[FieldError("body", message, ragged)])
    return header, rows


def _column(header: list[str], rows: list[list[str]], asked: str | None, role: str) -> list[str]:
    """Cells of a column; ``asked`` is the name the caller gave, else the role itself is the name."""
    name = role if asked is None else asked
    places = [place for place, found in enumerate(header) if found == name]
    if len(places) != 1:
        how_many = "no column" if not places else "more than one column"
        parameter = role if role == "columns" else f"{role}_column"
        named = f" {name[:60]!r}" if role == "columns" else " of this name"
        raise invalid_value(parameter, f"the header has {how_many}{named}; say which with ?{parameter}=")
    place = places[0]
    return [row[place] for row in rows]


def read_cells(cells: Sequence[str], field: str) -> npt.NDArray[np.float64]:
    """Numbers of a column, NaN where one is missing; a Problem names the row of what is no number."""
    numbers = _plain_floats(cells)
    if numbers is not None:
        return numbers
    numbers = np.full(len(cells), np.nan)
    for row, cell in enumerate(map(str.strip, cells)):
        if cell.lower() in MISSING:
            continue
        if len(cell) > LONGEST_NUMBER or _NUMBER.fullmatch(cell) is None:
            raise invalid_value(field, "expected a number or an empty cell", row)
        numbers[row] = float(cell)
        if np.isinf(numbers[row]):
            raise invalid_value(field, "is too large a number for a 64-bit float", row)
    return numbers


def _plain_floats(cells: Sequence[str]) -> npt.NDArray[np.float64] | None:
    """All cells at once where none is missing and none uses Python's own spellings (``1_000``, ``inf``)."""
    try:
        numbers = np.fromiter(map(float, cells), dtype=np.float64, count=len(cells))
    except ValueError:
        return None
    return numbers if _is_plain(cells) and bool(np.isfinite(numbers).all()) else None


def _plain_integers(cells: Sequence[str]) -> npt.NDArray[np.int64] | None:
    """All cells at once where all are integers of 64 bits."""
    try:
        return np.array(list(map(int, cells)), dtype=np.int64) if _is_plain(cells) else None
    except (ValueError, OverflowError):
        return None


def _is_plain(cells: Sequence[str]) -> bool:
    text = "".join(cells)
    return text.isascii() and "_" not in text


def read_time_cells(cells: Sequence[str], field: str, unit: TimeUnit | None) -> tuple[Times, TimeForm]:
    """Read the times of a column and the form they came in; a Problem names the row of what is no time."""
    first = next((cell for cell in cells if cell.strip().lower() not in MISSING), "")
    if _ISO_START.match(first.strip()):
        if unit is not None:
            raise invalid_value("time_unit", "is for epoch numbers; leave it out with ISO 8601 times")
        stripped = map(str.strip, cells)
        return parse_iso([None if cell.lower() in MISSING else cell for cell in stripped], field), TimeForm(
            "iso"
        )
    if unit is None:
        integers = _plain_integers(cells)
        return (read_cells(cells, field) if integers is None else integers), TimeForm("number")
    missing = np.array([cell.strip().lower() in MISSING for cell in cells], dtype=np.bool_)
    integers = _plain_integers(["0" if gone else cell for cell, gone in zip(cells, missing, strict=True)])
    numbers = read_cells(cells, field) if integers is None else integers
    return from_epoch(numbers, unit, field, missing), TimeForm("epoch", unit)
