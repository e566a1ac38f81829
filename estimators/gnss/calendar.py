"""Time scales of satellite navigation, as nanoseconds of ``numpy.datetime64``.

GPS time, Galileo's and QZSS's count the same seconds since 1980-01-06; BeiDou time is 14 s behind; GLONASS
time is UTC(SU) + 3 h; UTC falls behind GPS time by a leap second now and then (IERS Bulletin C; the last one
at the end of 2016).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from estimators.arrays import IntArray

TimeArray = NDArray[np.datetime64]

GPS_EPOCH = np.datetime64("1980-01-06", "ns")
BEIDOU_BEHIND_S = 14
"""BeiDou time began at 2006-01-01 00:00:00 UTC, when GPS time was 14 s ahead (BeiDou ICD, 3.3)."""
WEEK_S = 604800
WEEK_NS = WEEK_S * 1_000_000_000
_LEAPS = np.array(
    [
        "1981-07-01",
        "1982-07-01",
        "1983-07-01",
        "1985-07-01",
        "1988-01-01",
        "1990-01-01",
        "1991-01-01",
        "1992-07-01",
        "1993-07-01",
        "1994-07-01",
        "1996-01-01",
        "1997-07-01",
        "1999-01-01",
        "2006-01-01",
        "2009-01-01",
        "2012-07-01",
        "2015-07-01",
        "2017-01-01",
    ],
    dtype="datetime64[ns]",
)
"""UTC from which one more leap second counts (IERS Bulletin C)."""
_LEAPS_GPS = _LEAPS + np.arange(1, _LEAPS.size + 1) * np.timedelta64(1, "s")


def gps_to_utc(time: TimeArray) -> TimeArray:
    """UTC of instants in GPS time.

    Parameters
    ----------
    time : ndarray of datetime64[ns]

    Examples
    --------
    >>> str(gps_to_utc(np.array(["2020-06-25T00:00:00"], dtype="datetime64[ns]"))[0])[:19]
    '2020-06-24T23:59:42'
    """
    return np.asarray(time - np.searchsorted(_LEAPS_GPS, time, side="right") * np.timedelta64(1, "s"))


def utc_to_gps(time: TimeArray) -> TimeArray:
    """GPS time of instants in UTC; an instant within a leap second is not told from the one after.

    Parameters
    ----------
    time : ndarray of datetime64[ns]

    Examples
    --------
    >>> str(utc_to_gps(np.array(["2016-06-30T21:26:07"], dtype="datetime64[ns]"))[0])[:19]
    '2016-06-30T21:26:24'
    """
    return np.asarray(time + np.searchsorted(_LEAPS, time, side="right") * np.timedelta64(1, "s"))


def gps_nanoseconds(time: TimeArray) -> IntArray:
    """Nanoseconds since the beginning of GPS time.

    Parameters
    ----------
    time : ndarray of datetime64[ns]
        GPS time.
    """
    return np.asarray((time - GPS_EPOCH).astype(np.int64))


def of_week(week: int, seconds: float) -> int:
    """Nanoseconds since the beginning of GPS time of a week and the seconds in it, counted in GPS time.

    Examples
    --------
    >>> of_week(1, 0.5)
    604800500000000
    """
    return week * WEEK_NS + round(seconds * 1e9)
