"""What every input format becomes: :class:`RangeColumns`, with the arguments checked beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from pydantic import ValidationError

from service.codecs.arguments import from_validation
from service.codecs.columns import TimeForm, Times
from service.errors import Problem, ProblemType, invalid_value
from service.schemas.positions import PositionArguments

REQUIRED = ("x_m", "y_m", "z_m", "pseudorange_m")
NUMBERS = (*REQUIRED, "sigma_m", "cn0_dbhz")
WORDS = ("system", "satellite")
FIELDS = (*NUMBERS, *WORDS, "time")

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RangeColumns:
    """Pseudoranges as they came, one entry per row.

    Attributes
    ----------
    numbers : dict of str to ndarray of float64, shape (rows,)
        By name, those of :data:`NUMBERS` that were sent; NaN where missing.
    words : dict of str to list of str
        By name, those of :data:`WORDS` that were sent.
    time : ndarray, shape (rows,), or None
        None makes all rows one epoch.
    form : TimeForm or None
        How the times were written.
    """

    numbers: dict[str, Floats]
    words: dict[str, list[str]]
    time: Times | None
    form: TimeForm | None

    @property
    def rows(self) -> int:
        """Number of rows."""
        return self.numbers["pseudorange_m"].size

    @property
    def satellites_m(self) -> Floats:
        """Positions of the satellites, shape (rows, 3)."""
        return np.column_stack([self.numbers[name] for name in ("x_m", "y_m", "z_m")])


def read_position_arguments(given: dict[str, Any]) -> PositionArguments:
    """Validate the arguments, as in a JSON body without the columns.

    Raises
    ------
    Problem
        Naming every argument that is wrong.
    """
    try:
        return PositionArguments.model_validate(given)
    except ValidationError as error:
        raise from_validation(error.errors(include_input=False, include_url=False)) from None


def check_ranges(columns: RangeColumns, arguments: PositionArguments, max_points: int) -> None:
    """Check that columns belong together and to the arguments.

    Raises
    ------
    Problem
        Naming the field and, where one is at fault, the row.
    """
    lengths = {name: column.size for name, column in columns.numbers.items()}
    lengths |= {name: len(column) for name, column in columns.words.items()}
    if columns.time is not None:
        lengths["time"] = columns.time.size
    rows = columns.rows
    if rows == 0:
        raise invalid_value("pseudorange_m", "is empty; send at least one row")
    longest = max(lengths.values())
    if longest > max_points:
        message = f"{longest} rows; at most {max_points} are taken"
        raise Problem(ProblemType.too_many_points, message, extra={"limit": max_points})
    for name, length in lengths.items():
        if length != rows:
            raise invalid_value(name, f"{length} entries for {rows} pseudoranges; send one per pseudorange")
    if columns.time is None:
        for name in ("motion", "window_s", "surroundings", "time_unit"):
            if getattr(arguments, name) is not None:
                raise invalid_value(name, "is for many epochs; send the column time with it")
        if arguments.causal:
            raise invalid_value("causal", "is for many epochs; send the column time with it")
        return
    missing = np.isnat(columns.time) if columns.time.dtype.kind == "M" else np.isnan(columns.time)
    if np.any(missing):
        raise invalid_value("time", "is missing; every row needs its epoch", int(np.argmax(missing)))
