"""Which column of a table is which: the usual names of times, coordinates and the rest, :func:`find_columns`.

Names are compared without case, blanks and punctuation; units are those of the column's name (a ``speed``
is in m/s), and a name that says another unit (``speed_kmh``) is not taken. Of several candidates the first
in the list is taken, so that ``timestamp`` goes before ``t``, and ``latitude`` before ``y``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from estimators.arrays import InputError

NAMES: dict[str, tuple[str, ...]] = {
    "time": (
        *("time", "timestamp", "datetime", "timeutc", "utctime", "utc", "when", "gpstime", "recordedat"),
        *("basedatetime", "fixtime", "timestamputc", "timestampms", "epochms", "epoch", "unixtime"),
        *("unix", "times", "ts", "t"),
    ),
    "date": ("date", "day", "dateutc", "utcdate", "gpsdate"),
    "lat": ("lat", "latitude", "latdeg", "latitudedeg", "gpslat", "gpslatitude", "positionlat", "y"),
    "lon": (
        *("lon", "longitude", "lng", "long", "londeg", "longitudedeg", "gpslon", "gpslng"),
        *("gpslongitude", "positionlong", "x"),
    ),
    "device": (
        *("device", "deviceid", "devicename", "vehicle", "vehicleid", "vessel", "mmsi", "imei", "tracker"),
        *("trackerid", "user", "userid", "uid", "taxiid"),
    ),
    "segment": ("segment", "segmentid", "trajectory", "trajectoryid", "track", "trackid", "trip", "tripid"),
    "height_m": (
        *("heightm", "height", "altitude", "altitudem", "alt", "ele", "elevation", "elevationm"),
        *("enhancedaltitude", "z"),
    ),
    "accuracy_m": (
        *("accuracym", "accuracy", "acc", "accm", "horizontalaccuracy", "haccuracy", "hacc", "gpsaccuracy"),
        *("horizontalaccuracym", "accuracymeters"),
    ),
    "ellipse_major_m": (
        *("ellipsemajorm", "semimajorm", "semimajor", "semimajoraxis", "errorsemimajoraxis"),
        *("argossemimajor", "smaj"),
    ),
    "ellipse_minor_m": (
        *("ellipseminorm", "semiminorm", "semiminor", "semiminoraxis", "errorsemiminoraxis"),
        *("argossemiminor", "smin"),
    ),
    "ellipse_bearing_deg": (
        *("ellipsebearingdeg", "ellipseorientation", "errorellipseorientation", "argosorientation", "eor"),
    ),
    "speed_mps": ("speedmps", "speed", "speedms", "gpsspeed", "velocity", "enhancedspeed"),
    "bearing_deg": ("bearingdeg", "bearing", "course", "heading", "headingdeg", "cog", "courseoverground"),
    "hdop": ("hdop",),
    "satellites": ("satellites", "sat", "sats", "numsatellites", "numsats", "nsat", "ns"),
}
"""Columns of a recording and the names under which files hold them, most telling first."""

_PLACES = {alias: (column, rank) for column, aliases in NAMES.items() for rank, alias in enumerate(aliases)}
_PUNCTUATION = re.compile(r"[\W_]+")


class ColumnError(InputError):
    """A table lacks columns; for callers who must not repeat what stands in its header.

    Parameters
    ----------
    field, message : str
    columns : tuple of str
        What is missing, as in :data:`NAMES`.
    """

    def __init__(self, field: str, message: str, columns: tuple[str, ...]) -> None:
        super().__init__(field, message)
        self.columns = columns


def find_columns(names: Sequence[str]) -> dict[str, str]:
    """Name in the file of each column that can be told.

    Parameters
    ----------
    names : sequence of str

    Returns
    -------
    dict of str to str
        Keys as in :data:`NAMES`. Any name that ends in "timestamp" is a time where nothing better is.

    Examples
    --------
    >>> find_columns(["ID", "ais_pos_timestamp", "Longitude", "Latitude"])
    {'time': 'ais_pos_timestamp', 'lon': 'Longitude', 'lat': 'Latitude'}
    """
    best: dict[str, tuple[int, str]] = {}
    for name in names:
        plain = _PUNCTUATION.sub("", name).lower()
        column, rank = _PLACES.get(plain, ("time", 1000) if plain.endswith("timestamp") else ("", 0))
        if column and (column not in best or rank < best[column][0]):
            best[column] = (rank, name)
    return {column: name for column, (_, name) in best.items()}
