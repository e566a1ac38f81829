"""Tables of pseudoranges, corrected or raw, to positions; refusals by their names on the wire."""

from __future__ import annotations

import dataclasses

import numpy as np

from estimators import Epochs, InputError
from estimators.gnss.calendar import GPS_EPOCH, TimeArray, utc_to_gps
from estimators.gnss.corrections.klobuchar import Klobuchar
from estimators.gnss.observed_epochs import ObservedEpochs
from estimators.gnss.raw import correct_ranges
from service.codecs.columns import Times
from service.codecs.positions.columns import RangeColumns
from service.errors import invalid_value
from service.positions.located import (
    Integers,
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
from service.schemas.positions import PositionArguments

#: The library's arguments by the names they have on the wire.
WIRE_NAMES = {
    "satellites_m": "x_m",
    "pseudoranges_m": "pseudorange_m",
    "velocities_mps": "vx_mps",
    "satellite_velocity_mps": "vx_mps",
    "klobuchar.alpha": "klobuchar_alpha",
    "klobuchar.beta": "klobuchar_beta",
    "mask_deg": "options.elevation_mask_deg",
    "time_gps": "time",
}


def locate_columns(columns: RangeColumns, arguments: PositionArguments, progress: Progress) -> Located:
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
    try:
        epochs = _grouped(columns)
        if arguments.raw:
            return _locate_raw(columns, epochs, arguments, progress)
        options = options_of(arguments)
        if columns.time is None:
            found = locate_one(epochs[0], arguments, options, rotated=arguments.rotated)
            return Located(answered(found), alert_m=options.alert_m)
        place = np.argsort(epochs.source_row, kind="stable")
        fixes = answered(locate_many(epochs, arguments, options, progress, rotated=arguments.rotated), place)
        own_order = bool(np.all(place == np.arange(place.size)))
        return Located(
            fixes, epochs.time, columns.form, None if own_order else place, alert_m=options.alert_m
        )
    except InputError as error:
        raise invalid_value(WIRE_NAMES.get(error.field, error.field), error.message) from error


def _grouped(columns: RangeColumns) -> Epochs:
    """Rows by epoch; all rows are one without times."""
    numbers, words = columns.numbers, columns.words
    return Epochs.from_columns(
        time=np.zeros(columns.rows) if columns.time is None else columns.time,
        satellites_m=columns.satellites_m,
        pseudoranges_m=numbers["pseudorange_m"],
        sigma_m=numbers.get("sigma_m"),
        cn0_dbhz=numbers.get("cn0_dbhz"),
        system=words.get("system"),
        satellite=words.get("satellite"),
        range_rate_mps=numbers.get("range_rate_mps"),
        satellite_velocity_mps=columns.velocities_mps,
    )


def _locate_raw(
    columns: RangeColumns, grouped: Epochs, arguments: PositionArguments, progress: Progress
) -> Located:
    """Positions of pseudoranges as measured; the answer has the rows that the corrections leave."""
    observed = _corrected(columns, grouped, arguments)
    source = grouped.source_row[observed.source_row]
    epochs = dataclasses.replace(Epochs.from_observed(observed), time=grouped.time, source_row=source)
    options = unmasked(options_of(arguments))
    place: Integers = np.argsort(source, kind="stable")
    left_out = left_out_of(observed, grouped.source_row)
    if columns.time is None:
        found = answered(locate_one(epochs[0], arguments, options, rotated=True), place)
        return Located(found, None, None, None, source[place], left_out, options.alert_m)
    fixes = answered(locate_many(epochs, arguments, options, progress, rotated=True), place)
    return Located(fixes, grouped.time, columns.form, place, source[place], left_out, options.alert_m)


def _corrected(columns: RangeColumns, grouped: Epochs, arguments: PositionArguments) -> ObservedEpochs:
    rows = grouped.source_row
    numbers = {name: column[rows] for name, column in columns.numbers.items()}
    klobuchar = None
    if arguments.klobuchar_alpha is not None and arguments.klobuchar_beta is not None:
        klobuchar = Klobuchar(_four(arguments.klobuchar_alpha), _four(arguments.klobuchar_beta))
    weights = arguments.weights or ("strength" if "cn0_dbhz" in numbers else "elevation")
    return correct_ranges(
        grouped.satellites_m,
        grouped.pseudoranges_m,
        time_gps=_gps_times(grouped.time, len(grouped), dated=klobuchar is not None),
        offsets=grouped.offsets,
        satellite_clock_s=numbers.get("satellite_clock_s"),
        group_delay_s=numbers.get("group_delay_s"),
        system=grouped.system,
        satellite=grouped.satellite,
        rotated=arguments.rotated,
        klobuchar=klobuchar,
        troposphere=arguments.troposphere is not False,
        frequency_hz=numbers.get("frequency_hz"),
        second_m=numbers.get("second_m"),
        second_hz=numbers.get("second_hz"),
        cn0_dbhz=grouped.cn0_dbhz,
        range_rate_mps=grouped.range_rate_mps,
        velocities_mps=grouped.satellite_velocity_mps,
        clock_drift=numbers.get("clock_drift"),
        accuracy_m=numbers.get("accuracy_m"),
        sigma_m=grouped.sigma_m,
        weights=weights,
        mask_deg=mask_of(arguments),
    )


def _gps_times(times: Times, epochs: int, *, dated: bool) -> TimeArray:
    """GPS times of the epochs; only the ionosphere looks at them, so that without it any will do."""
    if not dated:
        return np.full(epochs, GPS_EPOCH, dtype="datetime64[ns]")
    return utc_to_gps(np.asarray(times, dtype="datetime64[ns]"))


def _four(coefficients: list[float]) -> tuple[float, float, float, float]:
    first, second, third, fourth = coefficients
    return first, second, third, fourth
