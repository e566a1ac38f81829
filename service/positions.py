"""From pseudoranges as they came to positions: the library's verbs, their refusals by wire names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from estimators import Epochs, Fix, Fixes, InputError, NoFit, PositionOptions, locate, locate_series
from estimators.notices import notice_to_dict
from service.codecs.columns import TimeForm
from service.codecs.positions.columns import RangeColumns
from service.errors import FieldError, Problem, ProblemType, invalid_value
from service.schemas.positions import PositionArguments

#: The library's arguments by the names they have on the wire.
WIRE_NAMES = {"satellites_m": "x_m", "pseudoranges_m": "pseudorange_m"}


@dataclass(frozen=True, slots=True)
class Located:
    """An answer, with what its writers need of the request.

    Attributes
    ----------
    answer : Fix or Fixes
    form : TimeForm or None
        How times were written; None where there are none.
    place : ndarray of int64, shape (rows,), or None
        Of each row as it came, the row of the answer; None where they are the same.
    """

    answer: Fix | Fixes
    form: TimeForm | None = None
    place: npt.NDArray[np.int64] | None = None


def locate_columns(
    columns: RangeColumns, arguments: PositionArguments, progress: Callable[[int, int], object]
) -> Located:
    """Positions of an epoch, or of the epochs that ``time`` makes of the rows.

    Parameters
    ----------
    columns : RangeColumns
    arguments : PositionArguments
    progress : callable
        Called with epochs done and in all; it may raise to end the work.

    Raises
    ------
    Problem
        422 if the library refuses an argument or finds no position.
    """
    options = PositionOptions(**arguments.options.model_dump())
    try:
        if columns.time is None:
            return Located(_one(columns, arguments, options))
        epochs = Epochs.from_columns(
            time=columns.time,
            satellites_m=columns.satellites_m,
            pseudoranges_m=columns.numbers["pseudorange_m"],
            sigma_m=columns.numbers.get("sigma_m"),
            cn0_dbhz=columns.numbers.get("cn0_dbhz"),
            system=columns.words.get("system"),
            satellite=columns.words.get("satellite"),
        )
        place = np.argsort(epochs.source_row, kind="stable")
        fixes = locate_many(epochs, arguments, options, progress)
    except InputError as error:
        raise invalid_value(WIRE_NAMES.get(error.field, error.field), error.message) from error
    if isinstance(fixes, NoFit):
        raise no_position(fixes, place)
    return Located(fixes, columns.form, None if np.all(place == np.arange(place.size)) else place)


def locate_many(
    epochs: Epochs,
    arguments: PositionArguments,
    options: PositionOptions,
    progress: Callable[[int, int], object],
) -> Fixes | NoFit:
    """Positions of epochs; methods for single epochs take each by itself unless told otherwise.

    Raises
    ------
    InputError
        If the library refuses an argument.
    """
    return locate_series(
        epochs,
        motion=arguments.motion or ("auto" if arguments.method == "auto" else "independent"),
        window_s=arguments.window_s,
        causal=arguments.causal,
        surroundings=arguments.surroundings or "auto",
        rotated=arguments.rotated,
        method=arguments.method,
        options=options,
        progress=progress,
    )


def no_position(found: NoFit, place: npt.NDArray[np.int64] | None = None) -> Problem:
    """Problem of ranges that determine no position; ``place`` brings rows back into their order."""
    reason = found.points.reason
    return Problem(
        ProblemType.no_position,
        found.message,
        errors=[FieldError("pseudorange_m", found.message)],
        extra={
            "reason": found.reason.value,
            "points": {"reason": reason if place is None else [reason[row] for row in place.tolist()]},
            "notices": [notice_to_dict(item) for item in found.notices],
        },
    )


def _one(columns: RangeColumns, arguments: PositionArguments, options: PositionOptions) -> Fix:
    found = locate(
        columns.satellites_m,
        columns.numbers["pseudorange_m"],
        sigma_m=columns.numbers.get("sigma_m"),
        cn0_dbhz=columns.numbers.get("cn0_dbhz"),
        system=columns.words.get("system"),
        satellite=columns.words.get("satellite"),
        rotated=arguments.rotated,
        method=arguments.method,
        options=options,
    )
    if isinstance(found, NoFit):
        raise no_position(found)
    return found
