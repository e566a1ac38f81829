"""Files as receivers write them, RINEX or the log of a phone, to positions; refusals name the part."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import Literal

from estimators import Epochs, InputError
from estimators.gnss.observed_epochs import ObservedEpochs
from service.codecs.columns import TimeForm
from service.codecs.limits import Limits
from service.codecs.positions.columns import Recording
from service.errors import Problem, ProblemType, invalid_value
from service.positions.located import (
    Located,
    Progress,
    answered,
    left_out_of,
    locate_many,
    locate_one,
    mask_of,
    options_of,
    unmasked,
)
from service.schemas.positions import RecordingArguments

_GZIP = b"\x1f\x8b"
_HEAD = 4096
_NAMES = {"log": "observations", "mask_deg": "options.elevation_mask_deg"}


def kind_of(content: bytes) -> Literal["rinex", "log"] | None:
    """Tell a RINEX file and a log by their first bytes, packed or not; None for neither.

    Parameters
    ----------
    content : bytes

    Examples
    --------
    >>> kind_of(b"# Raw,ElapsedRealtimeMillis")
    'log'
    """
    head = content[:_HEAD]
    if head.startswith(_GZIP):
        try:
            head = zlib.decompressobj(zlib.MAX_WBITS | 16).decompress(content, _HEAD)
        except zlib.error:
            return None
    if b"RINEX VERS" in head:
        return "rinex"
    return "log" if b"# Raw," in head or head.startswith(b"Raw,") else None


def read_recording(
    recording: Recording, arguments: RecordingArguments, limits: Limits, check: Callable[[], None]
) -> ObservedEpochs:
    """Epochs of a recording, corrected by the broadcast messages.

    Parameters
    ----------
    recording : Recording
    arguments : RecordingArguments
    limits : Limits
        Of the bytes of each file once it is unpacked, and of epochs and ranges.
    check : callable
        Called while files are read; raises if nobody waits any more.

    Raises
    ------
    Problem
        422 if a file is not what it should be or the files do not belong together; 413 beyond the limits;
        501 where what reads RINEX is not installed.
    """
    # Only who sends such files waits for their readers, and needs their extra.
    try:
        from estimators.adapters.gnss_logger import read_gnss_logger  # noqa: PLC0415
        from estimators.adapters.rinex import read_rinex  # noqa: PLC0415
        from estimators.adapters.rinex_text import MOST_BYTES  # noqa: PLC0415
    except ImportError as error:
        raise Problem(
            ProblemType.not_installed, "reading RINEX needs the extra [rinex]: install plumbline[rinex]"
        ) from error
    is_log = kind_of(recording.observations) == "log"
    read = read_gnss_logger if is_log else read_rinex
    try:
        observed = read(
            recording.observations,
            list(recording.navigation),
            systems=arguments.systems,
            mask_deg=mask_of(arguments),
            weights=arguments.weights or ("strength" if is_log else "elevation"),
            ionosphere=arguments.ionosphere,
            most_bytes=MOST_BYTES if limits.unpacked_bytes is None else limits.unpacked_bytes,
            check=check,
        )
    except InputError as error:
        raise invalid_value(_NAMES.get(error.field, error.field), error.message) from error
    limits.check_points(max(len(observed), observed.source_row.size + len(observed.left_out)))
    return observed


def locate_observed(observed: ObservedEpochs, arguments: RecordingArguments, progress: Progress) -> Located:
    """Positions of the epochs of a recording; of a single epoch as of any single epoch.

    Parameters
    ----------
    observed : ObservedEpochs
    arguments : RecordingArguments
    progress : callable
        Called with epochs done and in all; it may raise to end the work.

    Returns
    -------
    Located
        Times are UTC.

    Raises
    ------
    Problem
        422 if the ranges give no position.
    """
    epochs, options = Epochs.from_observed(observed), unmasked(options_of(arguments))
    try:
        found = (
            locate_many(epochs, arguments, options, progress, rotated=True)
            if is_series(observed, arguments)
            else locate_one(epochs[0], arguments, options, rotated=True)
        )
    except InputError as error:
        raise invalid_value(_NAMES.get(error.field, error.field), error.message) from error
    return Located(
        answered(found, field="observations"),
        observed.time_utc,
        TimeForm("iso"),
        None,
        observed.source_row,
        left_out_of(observed),
        options.alert_m,
    )


def is_series(observed: ObservedEpochs, arguments: RecordingArguments) -> bool:
    """Whether epochs are solved together, which one alone is only if a motion is asked for."""
    return len(observed) != 1 or arguments.motion is not None
