import gzip
from pathlib import Path

import numpy as np
import pytest

from estimators import accuracy_of_ellipse
from estimators.adapters.tracks import RowFault, read_track
from estimators.arrays import InputError


def test_columns_are_known_by_their_usual_names() -> None:
    track = read_track(
        b"Device ID;Timestamp;Latitude;LONGITUDE;Altitude;Accuracy;Speed;Heading\n"
        b"bus 7;2021-07-28 07:00:00;50.5;7.25;99;12;3;361\n"
        b"bus 3;2021-07-28 07:00:01;50.5;7.25;99;12;3;90\n"
    )
    assert track.device_names() == ["bus 7", "bus 3"]
    assert (track.lat[0], track.lon[0]) == (50.5, 7.25)
    assert track.height_m is not None
    assert track.accuracy_m is not None
    assert track.bearing_deg is not None
    assert (track.height_m[0], track.accuracy_m[0]) == (99.0, 12.0)
    assert np.isnan(track.bearing_deg).tolist() == [True, False]


@pytest.mark.parametrize(
    "header",
    [
        "argos:semi-major,argos:semi-minor,argos:orientation",
        "Error Semi-major axis,Error Semi-minor axis,Error Ellipse orientation",
        "smaj,smin,eor",
        "semi_major,semi_minor,ellipse_orientation",
    ],
)
def test_error_ellipses_are_known_by_the_names_that_wildlife_trackers_write(header: str) -> None:
    track = read_track(f"date,lat,lon,{header}\n2021-07-28 07:00:00,50,7,900,40,135\n".encode())
    assert track.ellipse_major_m is not None
    assert track.ellipse_minor_m is not None
    assert track.ellipse_bearing_deg is not None
    found = (track.ellipse_major_m[0], track.ellipse_minor_m[0], track.ellipse_bearing_deg[0])
    assert found == (900.0, 40.0, 135.0)


def test_the_radius_of_a_row_is_its_accuracy_or_the_circle_of_its_ellipse() -> None:
    track = read_track(
        b"t,lat,lon,accuracy,smaj,smin\n0,50,7,12,90,40\n1,50,7,,90,40\n2,50,7,,90,\n3,50,7,8,,\n"
    )
    assert track.radius_m is not None
    circle = accuracy_of_ellipse([90.0], [40.0])[0]
    np.testing.assert_array_equal(track.radius_m, [12.0, circle, np.nan, 8.0])


def test_a_track_without_accuracies_and_ellipses_has_no_radii() -> None:
    assert read_track(b"t,lat,lon,smaj\n0,50,7,90\n").radius_m is None


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "|"])
def test_the_delimiter_is_told_by_the_header(delimiter: str) -> None:
    lines = ["time,lat,lon", "0,50.5,7.5", "1,51.5,8.5"]
    track = read_track("\n".join(lines).replace(",", delimiter).encode())
    assert track.lat.tolist() == [50.5, 51.5]


def test_a_comma_may_be_the_decimal_sign_where_it_is_not_the_delimiter() -> None:
    assert read_track(b"time;lat;lon\n0;50,5;-7,25\n").lon.tolist() == [-7.25]


def test_every_row_stays_and_tells_its_fault() -> None:
    track = read_track(
        b"time,lat,lon\n2021-07-28T07:00:00Z,50,7\n,50,7\nnoon,50,7\n"
        b"2021-07-28T07:00:03Z,91,7\n2021-07-28T07:00:04Z,,7\n2021-07-28T07:00:05Z,x,7\n2021-07-28T07:00:06Z\n"
        b"2021-07-28T07:00:07Z,inf,7\n2021-02-30T07:00:08Z,50,7\n"
    )
    assert [RowFault(code).name for code in track.fault] == [
        "none",
        "time_missing",
        "time_unreadable",
        "position_unreadable",
        "position_missing",
        "position_unreadable",
        "position_missing",
        "position_unreadable",
        "time_unreadable",
    ]
    assert (np.isnan(track.lat) == np.isnan(track.lon)).all()


def test_longitudes_to_360_are_brought_to_180() -> None:
    assert read_track(b"t,lat,lon\n0,0,359\n1,0,180\n2,0,-180\n").lon.tolist() == [-1.0, 180.0, -180.0]


def test_plain_seconds_stay_numbers() -> None:
    assert read_track(b"t,lat,lon\n0.5,50,7\n1.5,50,7\n").time.tolist() == [0.5, 1.5]


def test_a_time_of_another_size_than_the_rest_is_unreadable() -> None:
    track = read_track(b"t,lat,lon\n0,50,7\n1,50,7\n1627455600123,50,7\n")
    assert track.fault.tolist() == [RowFault.none, RowFault.none, RowFault.time_unreadable]


def test_milliseconds_since_1970_are_told_by_their_size() -> None:
    track = read_track(b"timestamp,lat,lon\n1627455600123,50,7\n")
    assert track.time[0] == np.datetime64("2021-07-28T07:00:00.123")


def test_nanoseconds_since_1970_are_not_rounded() -> None:
    track = read_track(b"timestamp,lat,lon\n1627455600000000001,50,7\n")
    assert track.time[0] == np.datetime64("2021-07-28T07:00:00.000000001")


def test_a_unit_makes_numbers_points_in_time() -> None:
    track = read_track(b"t,lat,lon\n1627455600.25,50,7\n", time_unit="s")
    assert track.time[0] == np.datetime64("2021-07-28T07:00:00.25")


def test_dates_and_clocks_in_columns_of_their_own_are_put_together() -> None:
    track = read_track(b"Date,Time,Latitude,Longitude\n2021-07-28,07:00:01,50,7\n2021-07-28,,50,7\n")
    assert track.time[0] == np.datetime64("2021-07-28T07:00:01")
    assert track.fault.tolist() == [RowFault.none, RowFault.time_missing]


def test_dates_alone_are_times() -> None:
    assert read_track(b"date,lat,lon\n2021-07-28,50,7\n").time[0] == np.datetime64("2021-07-28")


def test_unusual_names_can_be_said() -> None:
    track = read_track(
        b"zeit,breite,laenge\n0,50,7\n", columns={"time": "zeit", "lat": "breite", "lon": "laenge"}
    )
    assert track.lat.tolist() == [50.0]


def test_a_column_that_is_not_there_is_refused() -> None:
    with pytest.raises(InputError, match="no column 'zeit'"):
        read_track(b"t,lat,lon\n0,50,7\n", columns={"time": "zeit"})


def test_a_file_is_read_in_pieces_and_comes_out_whole(tmp_path: Path) -> None:
    n = 150_001
    path = tmp_path / "long.csv"
    path.write_text("time,lat,lon,user\n" + "".join(f"{row},50.{row % 10},7,{row % 3}\n" for row in range(n)))
    track = read_track(path)
    np.testing.assert_array_equal(track.time, np.arange(n))
    assert track.device is not None
    np.testing.assert_array_equal(track.device, np.arange(n) % 3)


def test_gzip_and_utf_16_are_unpacked() -> None:
    text = "time,lat,lon,device\n0,50,7,Zürich\n"
    assert read_track(gzip.compress(text.encode("utf-16"))).devices == ("Zürich",)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"", "is empty"),
        (b" \n\n", "is empty"),
        (b"time,lat,lon\n", "no rows"),
        (b"lat,lon\n50,7\n", "no column for time"),
        (b"1,50,7\n2,50,7\n", "no column for time, lat, lon"),
        (b'time,lat,lon\n0,50,"7\n', "cannot be read as CSV"),
        (b"time,lat,lon\n,50,7\n", "no point of the track has a time"),
        (b"%PDF-1.4", "is a PDF document"),
        (b"\x00\x01\x02", "of no known format"),
    ],
)
def test_what_is_no_table_of_fixes_is_refused_with_a_reason(body: bytes, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_track(body)


def test_a_file_over_the_limit_is_refused_while_it_is_unpacked() -> None:
    bomb = gzip.compress(b"time,lat,lon\n" + b"0,50,7\n" * 100_000)
    with pytest.raises(InputError, match="more than 100000 bytes"):
        read_track(bomb, most_bytes=100_000)


def test_a_path_that_cannot_be_opened_is_named_as_such(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        read_track(tmp_path / "nowhere.gpx")
