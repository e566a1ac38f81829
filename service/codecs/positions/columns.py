"""What every input format becomes: :class:`RangeColumns`, or a :class:`Recording` of files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from service.codecs.arguments import validated
from service.codecs.columns import TimeForm, Times
from service.codecs.limits import Limits
from service.errors import invalid_value
from service.schemas.positions import PositionArguments

PLACES = ("x_m", "y_m", "z_m")
VELOCITIES = ("vx_mps", "vy_mps", "vz_mps")
REQUIRED = (*PLACES, "pseudorange_m")
NUMBERS = (*REQUIRED, "sigma_m", "cn0_dbhz", "range_rate_mps", *VELOCITIES)
WORDS = ("system", "satellite")
FIELDS = (*NUMBERS, *WORDS, "time")
#: Columns that only raw pseudoranges have.
RAW_NUMBERS = (
    "satellite_clock_s",
    "group_delay_s",
    "clock_drift",
    "accuracy_m",
    "frequency_hz",
    "second_m",
    "second_hz",
)

_FOR_MANY = "is for many epochs; send the column time with it"
_FOR_RAW = "is for raw pseudoranges; send raw=true with it"
_SAY_ROTATED = (
    "say whether satellite positions are turned for the Earth's rotation while the signal travelled (true) "
    "or as they were when it was sent (false)"
)
_LONGEST_WORD = 100
#: Metres, hertz and metres per second of satellites lie below by far; squares of more may overflow.
_LARGEST = 1e30
_STRONGEST_DBHZ = 80.0

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RangeColumns:
    """Pseudoranges as they came, one entry per row.

    Attributes
    ----------
    numbers : dict of str to ndarray of float64, shape (rows,)
        By name, those of :data:`NUMBERS` and :data:`RAW_NUMBERS` that were sent; NaN where missing.
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
        return np.column_stack([self.numbers[name] for name in PLACES])

    @property
    def velocities_mps(self) -> Floats | None:
        """Velocities of the satellites, shape (rows, 3)."""
        if VELOCITIES[0] not in self.numbers:
            return None
        return np.column_stack([self.numbers[name] for name in VELOCITIES])


@dataclass(frozen=True, slots=True)
class Recording:
    """Files as receivers write them.

    Attributes
    ----------
    observations : bytes
        RINEX observations or an Android GnssLogger log, told by content.
    navigation : sequence of bytes or Path
        RINEX navigation files.
    """

    observations: bytes
    navigation: Sequence[bytes | Path]


def table_arguments(given: dict[str, Any]) -> PositionArguments:
    """Validate the arguments of a table.

    Raises
    ------
    Problem
        Naming every argument that is wrong.
    """
    if given.get("rotated") is None:
        raise invalid_value("rotated", _SAY_ROTATED)
    return validated(PositionArguments, given)


def checked_words(words: list[str], name: str) -> list[str]:
    """Refuse names that nobody can read or that go on for pages."""
    for row, word in enumerate(words):
        if not 0 < len(word) <= _LONGEST_WORD or not word.isprintable():
            raise invalid_value(name, f"expected 1 to {_LONGEST_WORD} printable characters", row)
    return words


def check_ranges(columns: RangeColumns, arguments: PositionArguments, limits: Limits) -> None:
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
    limits.check_points(max(lengths.values()))
    for name, length in lengths.items():
        if length != rows:
            raise invalid_value(name, f"{length} entries for {rows} pseudoranges; send one per pseudorange")
    for name, column in columns.numbers.items():
        beyond = np.abs(column) > _LARGEST
        if np.any(beyond):
            raise invalid_value(
                name,
                f"is beyond ±{_LARGEST:g}, which no range and no satellite reaches; check its unit",
                int(np.argmax(beyond)),
            )
    strength = columns.numbers.get("cn0_dbhz")
    if strength is not None and np.any((strength < 0.0) | (strength > _STRONGEST_DBHZ)):
        row = int(np.argmax((strength < 0.0) | (strength > _STRONGEST_DBHZ)))
        raise invalid_value("cn0_dbhz", f"must lie between 0 and {_STRONGEST_DBHZ:g} dB-Hz", row)
    _check_company(columns, arguments)
    if columns.time is None:
        for name in ("motion", "window_s", "surroundings", "time_unit"):
            if getattr(arguments, name) is not None:
                raise invalid_value(name, _FOR_MANY)
        if arguments.causal:
            raise invalid_value("causal", _FOR_MANY)
        return
    missing = np.isnat(columns.time) if columns.time.dtype.kind == "M" else np.isnan(columns.time)
    if np.any(missing):
        raise invalid_value("time", "is missing; every row needs its epoch", int(np.argmax(missing)))


def _check_company(columns: RangeColumns, arguments: PositionArguments) -> None:
    """Refuse columns and arguments that mean nothing without others."""
    numbers = columns.numbers
    present = [name for name in VELOCITIES if name in numbers]
    if 0 < len(present) < len(VELOCITIES):
        raise invalid_value(present[0], "a velocity has vx_mps, vy_mps and vz_mps; send all three or none")
    if "range_rate_mps" in numbers and columns.time is None:
        raise invalid_value("range_rate_mps", _FOR_MANY)
    if "range_rate_mps" in numbers and not present:
        raise invalid_value(
            "range_rate_mps", "needs the velocities of the satellites, vx_mps, vy_mps, vz_mps"
        )
    if not arguments.raw:
        for name in RAW_NUMBERS:
            if name in numbers:
                raise invalid_value(name, _FOR_RAW)
        for name in ("klobuchar_alpha", "klobuchar_beta", "troposphere", "weights"):
            if getattr(arguments, name) is not None:
                raise invalid_value(name, _FOR_RAW)
    if (arguments.klobuchar_alpha is None) != (arguments.klobuchar_beta is None):
        absent = "klobuchar_beta" if arguments.klobuchar_beta is None else "klobuchar_alpha"
        raise invalid_value(absent, "the ionosphere needs the coefficients alpha and beta; send both")
    if arguments.klobuchar_alpha is not None and (columns.form is None or columns.form.kind == "number"):
        raise invalid_value(
            "time", "the ionosphere follows the time of day; send ISO 8601, or numbers with time_unit"
        )
