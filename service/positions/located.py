"""The answer with what its writers need of the request, and the library's verbs as the wire asks for them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from estimators import Epoch, Epochs, Fix, Fixes, NoFit, PositionOptions, locate, locate_series
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.notices import notice_to_dict
from service.codecs.columns import TimeForm, Times
from service.errors import FieldError, Problem, ProblemType
from service.schemas.positions import SolvingArguments

Integers = npt.NDArray[np.int64]
Progress = Callable[[int, int], object]

#: Of ranges that are corrected here, where no other is asked for: the default of the library's corrections.
MASK_DEG = 10.0


@dataclass(frozen=True, slots=True)
class LeftOutRows:
    """Ranges that took no part because of their corrections; one entry each.

    Attributes
    ----------
    row : ndarray of int64, shape (m,)
        Of the table, or which observation of the file.
    satellite, reason : tuple of str
    """

    row: Integers
    satellite: tuple[str, ...]
    reason: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Located:
    """An answer, with what its writers need of the request.

    Attributes
    ----------
    answer : Fix or Fixes
    time : ndarray, shape (epochs,), or None
        Of the epochs; None where there are none.
    form : TimeForm or None
        How they are written.
    place : ndarray of int64, shape (rows,), or None
        Rows of the answer in the order in which they are written; None where it is their own.
    row : ndarray of int64, shape (rows,), or None
        In that order, where each came from; None where every row that came is there.
    left_out : LeftOutRows or None
        The others.
    alert_m : float
        Horizontal error that matters.
    """

    answer: Fix | Fixes
    time: Times | None = None
    form: TimeForm | None = None
    place: Integers | None = None
    row: Integers | None = None
    left_out: LeftOutRows | None = None
    alert_m: float = PositionOptions().alert_m


def locate_many(
    epochs: Epochs,
    arguments: SolvingArguments,
    options: PositionOptions,
    progress: Progress,
    *,
    rotated: bool,
) -> Fixes | NoFit:
    """Positions of epochs; methods for single epochs take each by itself unless told otherwise.

    Parameters
    ----------
    epochs : Epochs
    arguments : SolvingArguments
    options : PositionOptions
    progress : callable
        Called with epochs done and in all; it may raise to end the work.
    rotated : bool

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
        rotated=rotated,
        method=arguments.method,
        options=options,
        progress=progress,
    )


def locate_one(
    epoch: Epoch, arguments: SolvingArguments, options: PositionOptions, *, rotated: bool
) -> Fix | NoFit:
    """Position of one epoch.

    Raises
    ------
    InputError
        If the library refuses an argument.
    """
    return locate(
        epoch.satellites_m,
        epoch.pseudoranges_m,
        sigma_m=epoch.sigma_m,
        cn0_dbhz=epoch.cn0_dbhz,
        system=epoch.system,
        satellite=epoch.satellite,
        rotated=rotated,
        method=arguments.method,
        options=options,
    )


def options_of(arguments: SolvingArguments) -> PositionOptions:
    """Options as the library takes them."""
    return PositionOptions(**arguments.options.model_dump())


def mask_of(arguments: SolvingArguments) -> float:
    """Elevation below which ranges that are corrected here are left out."""
    asked = arguments.options.elevation_mask_deg
    return MASK_DEG if asked is None else asked


def unmasked(options: PositionOptions) -> PositionOptions:
    """Options without a mask, for ranges from which the corrections have masked already."""
    return dataclasses.replace(options, elevation_mask_deg=None)


def left_out_of(observed: ObservedEpochs, source: Integers | None = None) -> LeftOutRows:
    """Gather what the corrections left out, in the order of the input; ``source`` numbers its rows."""
    lost = observed.left_out
    rows = lost.source_row if source is None else source[lost.source_row]
    order = np.argsort(rows, kind="stable")
    return LeftOutRows(
        rows[order],
        tuple(lost.satellite[k] for k in order.tolist()),
        tuple(lost.reason[k] for k in order.tolist()),
    )


def answered(
    found: Fix | Fixes | NoFit, place: Integers | None = None, field: str = "pseudorange_m"
) -> Fix | Fixes:
    """Pass an answer on; ranges that determine no position are a problem.

    Parameters
    ----------
    found : Fix, Fixes or NoFit
    place : ndarray of int64, optional
        Brings rows back into their order.
    field : str
        What the problem names.

    Raises
    ------
    Problem
        422 with the reason.
    """
    if not isinstance(found, NoFit):
        return found
    reason = found.points.reason
    raise Problem(
        ProblemType.no_position,
        found.message,
        errors=[FieldError(field, found.message)],
        extra={
            "reason": found.reason.value,
            "points": {"reason": reason if place is None else [reason[row] for row in place.tolist()]},
            "notices": [notice_to_dict(item) for item in found.notices],
        },
    )
