"""JSON in (msgspec, columns straight into arrays) and out (orjson, straight from arrays).

A body is skimmed once for its keys, each column's text is decoded by a decoder of its own type, and only
what remains, a handful of scalars, is validated by pydantic. Integers stay integers: epoch nanoseconds do
not fit into a float64.
"""

from __future__ import annotations

import re
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
import orjson

from estimators import Trend
from estimators.trends.presentation.dictionary import fitted_values
from service.codecs.arguments import read_arguments, refuse_beside_json
from service.codecs.columns import Columns, TimeForm, Times, from_epoch
from service.codecs.limits import check_names
from service.codecs.moments import write_moments
from service.codecs.times import parse_iso
from service.errors import Problem, ProblemType, invalid_value, unknown_fields
from service.schemas.fields import TimeUnit
from service.schemas.options import AnswerQuery, FitArguments, TrendOptions, TrendQuery

COLUMN_FIELDS = ("time", "value", "weight", "predict", "horizon", "columns")
FIELDS = (*COLUMN_FIELDS, *FitArguments.model_fields)


class Key:
    """A key of an object. Equal keys are distinct objects, so that a repeated one is seen, not lost."""

    __slots__ = ("name",)

    def __init__(self, name: str) -> None:
        self.name = name


def _make_key(kind: type, value: Any) -> Any:
    if kind is Key and isinstance(value, str):
        return Key(value)
    raise NotImplementedError


_OBJECT = msgspec.json.Decoder(dict[Key, msgspec.Raw], dec_hook=_make_key)
_NUMBERS = msgspec.json.Decoder(list[float | None])
_TIMES = msgspec.json.Decoder(list[int | float | str | None])
_ANY = msgspec.json.Decoder(Any)

_WANTED = dict.fromkeys(("time", "predict", "horizon"), "a number, ISO 8601 text or null") | {
    "series": "text or an integer"
}

_BYTE = re.compile(r"\(byte (\d+)\)")
_ROW = re.compile(r"\$\[(\d+)\]")
_NOT_FINITE = re.compile(rb"-?(nan|inf)", re.IGNORECASE)
_OPEN_COLUMN = re.compile(
    rb'"(time|value|weight|predict|lat|lon|height|accuracy|speed|bearing|semi_major|semi_minor|orientation'
    rb'|[xyz]_m|pseudorange_m|sigma_m|cn0_dbhz)"'
    rb"\s*:\s*\[[^\]]*\Z"
)


def read_json(body: bytes, query: TrendQuery) -> tuple[Columns, FitArguments]:
    """Columns and arguments of a JSON body.

    Raises
    ------
    Problem
        If the body is not JSON, holds unknown or repeated keys, or a value of the wrong type.
    """
    refuse_beside_json(query.csv_only())
    fields = read_object(body, FIELDS, "")
    arguments = read_arguments(
        {
            name: read_argument(raw, name, tuple(TrendOptions.model_fields))
            for name, raw in fields.items()
            if name not in COLUMN_FIELDS
        }
    )
    for name in ("time", "value"):
        if name not in fields:
            raise invalid_value(name, "is required")
    time, form = read_times(fields["time"], "time", arguments.time_unit)
    predict: Times | None = None
    if not is_null(fields.get("predict")):
        predict, asked_form = read_times(fields["predict"], "predict", arguments.time_unit, form)
        if asked_form != form:
            raise invalid_value("predict", "must be written in the same form as time")
    weight = None if is_null(fields.get("weight")) else read_numbers(fields["weight"], "weight")
    horizon = _horizon(fields.get("horizon"), arguments.time_unit, form)
    own = _own_columns(fields.get("columns"))
    return Columns(
        time, read_numbers(fields["value"], "value"), weight, predict, form, horizon, own
    ), arguments


def _own_columns(raw: msgspec.Raw | None) -> dict[str, npt.NDArray[np.float64]]:
    """Columns of the caller by name."""
    if raw is None or is_null(raw):
        return {}
    columns = read_object(raw, None, "columns.")
    check_names(list(columns), "columns")
    return {name: read_numbers(text, f"columns.{name}") for name, text in columns.items()}


def _horizon(raw: msgspec.Raw | None, unit: TimeUnit | None, form: TimeForm) -> Times | None:
    """One time, as a column of one."""
    if raw is None or is_null(raw):
        return None
    horizon, asked_form = read_times(msgspec.Raw(b"[" + bytes(raw) + b"]"), "horizon", unit, form)
    if asked_form != form:
        raise invalid_value("horizon", "must be written in the same form as time")
    return horizon


def write_json(trend: Trend, columns: Columns, query: AnswerQuery) -> bytes:
    """``Trend.to_dict()`` with times in the form they came and columns written from their arrays."""
    answer = trend.to_dict(points=False)
    if columns.form.kind == "epoch":
        answer["origin"] = columns.form.render(np.array([trend.origin], dtype="datetime64[ns]"))[0]
        write_moments(answer, trend, columns.form)
    if columns.predict is not None:
        answer["prediction"]["time"] = columns.form.render(columns.predict)
    if "alternative" in answer:
        answer["alternative"]["origin"] = answer["origin"]
        if columns.predict is not None:
            answer["alternative"]["prediction"]["time"] = answer["prediction"]["time"]
    if query.points:
        answer["points"] = {
            "time": columns.form.render(columns.time),
            "fit": fitted_values(trend),
            "inlier": trend.points.inlier,
            "probability": trend.points.probability,
            "residual": trend.points.residual,
            "reason": trend.points.reason,
        }
    return dumps(answer)


def dumps(answer: Any) -> bytes:
    """JSON of a dict with arrays in it; NaN becomes null, points in time end in Z."""
    return orjson.dumps(answer, option=orjson.OPT_SERIALIZE_NUMPY | orjson.OPT_NAIVE_UTC | orjson.OPT_UTC_Z)


def read_object(
    text: bytes | msgspec.Raw, known: tuple[str, ...] | None, prefix: str
) -> dict[str, msgspec.Raw]:
    """Texts of an object's values by key, any if None are known; ``prefix`` names its place in errors."""
    try:
        pairs = _OBJECT.decode(text)
    except msgspec.ValidationError as error:
        if prefix:
            raise invalid_value(prefix.rstrip("."), "must be an object") from error
        raise Problem(ProblemType.malformed_body, "the body must be a JSON object with columns") from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise _malformed(bytes(text), error) from error
    names = [key.name for key in pairs]
    unknown = [] if known is None else [prefix + name for name in names if name not in known]
    if known is not None and unknown:
        raise unknown_fields(unknown, known, prefix.rstrip(".") or "this request")
    repeated = next((name for place, name in enumerate(names) if name in names[:place]), None)
    if repeated is not None:
        raise invalid_value(prefix + repeated, "is given twice; give it once")
    return {key.name: text for key, text in pairs.items()}


def _malformed(body: bytes, error: Exception) -> Problem:
    """Problem of a body that is not JSON; a NaN or an infinity, the usual cause, is named with its row."""
    if isinstance(error, RecursionError):
        return Problem(ProblemType.malformed_body, "the JSON is nested too deep")
    if isinstance(error, UnicodeDecodeError):
        return Problem(ProblemType.malformed_body, "the JSON is not valid UTF-8")
    found = _BYTE.search(str(error))
    if found is None:
        return Problem(ProblemType.malformed_body, "the JSON ends before it is complete")
    place = int(found[1])
    column = _OPEN_COLUMN.search(body, 0, place)
    if column is not None and _NOT_FINITE.match(body, place):
        return invalid_value(
            column[1].decode(),
            "NaN and Infinity are not JSON; send null for a missing value",
            body.count(b",", column.end(1), place),
        )
    return Problem(ProblemType.malformed_body, f"the JSON is broken at byte {place}")


def read_argument(raw: msgspec.Raw, name: str, options: tuple[str, ...] = ()) -> Any:
    """Python value of an argument; nested options are checked for repeated keys as the body is."""
    if name == "options":
        inner = read_object(raw, options, "options.")
        return {key: read_argument(text, f"options.{key}") for key, text in inner.items()}
    try:
        return _ANY.decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise invalid_value(
            name, "cannot be read; numbers must fit into 64 bits and text be UTF-8"
        ) from error


def is_null(raw: msgspec.Raw | None) -> bool:
    """Whether a value is null or not there."""
    return raw is None or bytes(memoryview(raw)[:4]) == b"null"


def read_numbers(raw: msgspec.Raw, name: str) -> npt.NDArray[np.float64]:
    """Read a column of numbers; NaN where one is null."""
    return np.array(decode_column(_NUMBERS, raw, name), dtype=np.float64)


def read_times(
    raw: msgspec.Raw, name: str, unit: TimeUnit | None, like: TimeForm | None = None
) -> tuple[Times, TimeForm]:
    """Read a column of times and the form it came in; ``like`` decides where the column itself cannot."""
    column = decode_column(_TIMES, raw, name)
    kinds = set(map(type, column)) - {type(None)}
    if str in kinds or (not kinds and like == TimeForm("iso")):
        if unit is not None:
            raise invalid_value("time_unit", "is for epoch numbers; leave it out with ISO 8601 times")
        if len(kinds) > 1:
            row = next(row for row, item in enumerate(column) if isinstance(item, int | float))
            raise invalid_value(name, "mixes text and numbers; write all times in one form", row)
        return parse_iso(column, name), TimeForm("iso")
    if unit is None:
        exact = kinds == {int} and None not in column
        return (_integers if exact else _floats)(column, name), TimeForm("number")
    if kinds != {int}:
        return from_epoch(_floats(column, name), unit, name), TimeForm("epoch", unit)
    missing = np.array([item is None for item in column])
    whole = _integers([0 if item is None else item for item in column], name)
    return from_epoch(whole, unit, name, missing), TimeForm("epoch", unit)


def _integers(column: list[Any], name: str) -> npt.NDArray[np.int64]:
    try:
        return np.array(column, dtype=np.int64)
    except OverflowError:
        row = next(row for row, item in enumerate(column) if not -(2**63) <= item < 2**63)
        raise invalid_value(name, "integers must fit into 64 bits", row) from None


def _floats(column: list[Any], name: str) -> npt.NDArray[np.float64]:
    try:
        return np.array(column, dtype=np.float64)
    except OverflowError:
        # An integer of more than 308 digits is the only number that msgspec takes and a float cannot hold.
        row = next(row for row, item in enumerate(column) if isinstance(item, int) and abs(item) >= 10**308)
        raise invalid_value(name, "is too large a number for a 64-bit float", row) from None


def decode_column(decoder: msgspec.json.Decoder[Any], raw: msgspec.Raw, name: str) -> list[Any]:
    """Entries of a column; an error names the row."""
    try:
        column: list[Any] = decoder.decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise _bad_column(error, name) from error
    return column


def _bad_column(error: Exception, name: str) -> Problem:
    """Problem of a column that holds something else than it should; msgspec says where, never what."""
    text = str(error)
    found = _ROW.search(text)
    row = int(found[1]) if found else None
    if isinstance(error, UnicodeDecodeError):
        return invalid_value(name, "holds text that is not valid UTF-8")
    if "out of range" in text:
        return invalid_value(name, "is too large a number for a 64-bit float", row)
    if row is None:
        return invalid_value(name, "must be an array")
    wanted = _WANTED.get(name, "a number or null")
    got = text.partition("got `")[2].partition("`")[0]
    return invalid_value(name, f"expected {wanted}, got {got or 'something else'}", row)
