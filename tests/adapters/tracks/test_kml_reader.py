import io
import zipfile

import numpy as np
import pytest

from estimators.adapters.tracks import read_track
from estimators.arrays import InputError

HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?><kml xmlns="http://www.opengis.net/kml/2.2" '
    'xmlns:gx="http://www.google.com/kml/ext/2.2"><Document><Placemark><name>walk</name>'
)
TAIL = "</Placemark></Document></kml>"
TRACK = (
    "<gx:Track><when>2010-05-28T02:02:09Z</when><when>2010-05-28T02:02:35Z</when>"
    "<gx:coord>-122.207881 37.371915 156.0</gx:coord><gx:coord>-122.205712 37.373288 152.0</gx:coord>"
    '<ExtendedData><SchemaData><gx:SimpleArrayData name="speed"><gx:value>1.5</gx:value>'
    "<gx:value>2.5</gx:value></gx:SimpleArrayData></SchemaData></ExtendedData></gx:Track>"
)


def test_a_kml_track_gives_positions_heights_and_arrays_of_what_else_was_measured() -> None:
    track = read_track((HEAD + TRACK + TAIL).encode())
    assert track.form == "kml"
    assert track.lat.tolist() == [37.371915, 37.373288]
    assert track.lon.tolist() == [-122.207881, -122.205712]
    assert track.height_m is not None
    assert track.speed_mps is not None
    assert track.height_m.tolist() == [156.0, 152.0]
    assert track.speed_mps.tolist() == [1.5, 2.5]
    assert track.devices == ("walk",)
    assert track.time[1] - track.time[0] == np.timedelta64(26, "s")


def test_tracks_of_a_multi_track_are_segments() -> None:
    track = read_track((HEAD + f"<gx:MultiTrack>{TRACK}{TRACK}</gx:MultiTrack>" + TAIL).encode())
    assert track.segment is not None
    assert track.segment.tolist() == [0, 0, 1, 1]


def test_the_kml_in_a_kmz_archive_is_read() -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("files/icon.png", b"picture")
        archive.writestr("doc.kml", HEAD + TRACK + TAIL)
    assert len(read_track(packed.getvalue())) == 2


def test_times_and_coordinates_of_different_number_are_refused() -> None:
    uneven = TRACK.replace("<when>2010-05-28T02:02:35Z</when>", "")
    with pytest.raises(InputError, match="1 times and 2 coordinates"):
        read_track((HEAD + uneven + TAIL).encode())


def test_kml_with_a_plain_line_is_no_track() -> None:
    line = "<LineString><coordinates>7,50 8,50</coordinates></LineString>"
    with pytest.raises(InputError, match="without a gx:Track"):
        read_track((HEAD + line + TAIL).encode())
