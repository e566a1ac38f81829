"""Arrow IPC and Parquet bodies of pseudoranges, by the readers of batches and within their bounds."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from service.codecs.arguments import refuse_absent
from service.codecs.batch.arrow import take_arrow
from service.codecs.batch.cells import counted_from, is_text, read_floats, read_times
from service.codecs.batch.parquet import take_parquet
from service.codecs.batch.taking import Choice, Take
from service.codecs.columns import TimeForm, Times
from service.codecs.limits import Limits
from service.codecs.positions.columns import (
    FIELDS,
    RAW_NUMBERS,
    REQUIRED,
    WORDS,
    Floats,
    RangeColumns,
    checked_words,
    table_arguments,
)
from service.codecs.sent import Sent
from service.errors import invalid_value
from service.schemas.position_query import PositionQuery
from service.schemas.positions import PositionArguments


def read_arrow_ranges(sent: Sent[PositionQuery]) -> tuple[RangeColumns, PositionArguments]:
    """Columns of an Arrow IPC stream or file; the arguments come from the query string."""
    return _read(sent, take_arrow)


def read_parquet_ranges(sent: Sent[PositionQuery]) -> tuple[RangeColumns, PositionArguments]:
    """Columns of a Parquet file; the arguments come from the query string."""
    return _read(sent, take_parquet)


def _read(
    sent: Sent[PositionQuery], take: Callable[[Any, Choice, Take], None]
) -> tuple[RangeColumns, PositionArguments]:
    arguments = table_arguments(sent.query.arguments())
    wanted = (*FIELDS, *RAW_NUMBERS) if arguments.raw else FIELDS
    pieces = _Pieces(arguments)
    take(pa.BufferReader(sent.content), _Columns(wanted, sent.limits, sent.check), pieces.add)
    return pieces.joined(), arguments


@dataclass(frozen=True, slots=True)
class _Columns:
    """The columns of pseudoranges in a table; a :class:`~service.codecs.batch.taking.Choice`."""

    wanted: Sequence[str]
    limits: Limits
    check: Callable[[], None]

    def choose(self, header: Sequence[str]) -> dict[str, int]:
        refuse_absent([name for name in REQUIRED if name not in header])
        twice = next((name for name in self.wanted if header.count(name) > 1), None)
        if twice is not None:
            raise invalid_value(twice, "the table has it twice; name each column once")
        return {name: header.index(name) for name in self.wanted if name in header}


class _Pieces:
    """Takes a table piece by piece and makes columns of it."""

    def __init__(self, arguments: PositionArguments) -> None:
        self._unit = arguments.time_unit
        self._numbers: dict[str, list[Floats]] = {}
        self._words: dict[str, list[str]] = {}
        self._times: list[Times] = []
        self._form: TimeForm | None = None
        self._rows = 0

    def add(self, columns: Mapping[str, Any]) -> None:
        """Take some rows as Arrow arrays."""
        with counted_from(self._rows):
            for name, column in columns.items():
                if name == "time":
                    times, form = read_times(column, self._unit, self._form, numbers_as_text=False)
                    self._times.append(times)
                    self._form = self._form or form
                elif name in WORDS:
                    self._words.setdefault(name, []).extend(_words(column, name))
                else:
                    self._numbers.setdefault(name, []).append(read_floats(column, name))
        self._rows += len(next(iter(columns.values())))

    def joined(self) -> RangeColumns:
        """Columns of all pieces."""
        if not self._rows:
            raise invalid_value("pseudorange_m", "is empty; send at least one row")
        numbers = {name: np.concatenate(parts) for name, parts in self._numbers.items()}
        if not self._times:
            return RangeColumns(numbers, self._words, None, None)
        form = self._form or TimeForm("number")
        times = self._times
        if form.kind != "number":
            # A piece of nothing but missing times does not know its form.
            blank = np.datetime64("NaT", "ns")
            times = [np.full(part.size, blank) if part.dtype.kind == "f" else part for part in times]
        joined: Times = np.concatenate(times)  # type: ignore[assignment]  # numpy forgets the common type
        return RangeColumns(numbers, self._words, joined, form)


def _words(column: Any, name: str) -> list[str]:
    """Texts of a column; each distinct one is looked at, and held, once."""
    kind = column.type
    inner = kind.value_type if pa.types.is_dictionary(kind) else kind
    if not is_text(inner):
        raise invalid_value(name, "is not a column of text")
    encoded = column if pa.types.is_dictionary(kind) else pc.dictionary_encode(column)
    places = encoded.indices
    if places.null_count:
        row = int(np.argmax(places.is_null().to_numpy(zero_copy_only=False)))
        raise invalid_value(name, "is missing; name every row's", row)
    used, first, rows = np.unique(
        places.to_numpy(zero_copy_only=False), return_index=True, return_inverse=True
    )
    texts = encoded.dictionary.take(pa.array(used)).to_pylist()
    for text, row in zip(texts, first.tolist(), strict=True):
        with counted_from(row):
            checked_words([text or ""], name)
    return [texts[place] for place in rows.tolist()]
