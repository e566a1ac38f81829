import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.adapters.tracks import Cleaned, Recording, read_track, write_csv, write_geojson, write_gpx
from estimators.adapters.tracks.antimeridian import cut_line
from estimators.arrays import InputError

START = np.datetime64("2021-07-28T07:00:00", "ns")


def recording(lat: list[float], lon: list[float], **columns: Any) -> Recording:
    n = len(lat)
    time = START + np.arange(n) * np.timedelta64(1_000_000_000, "ns")
    return Recording("csv", time, np.array(lat), np.array(lon), np.isnan(lat).astype(np.uint8), **columns)


def cleaned(track: Recording) -> Cleaned:
    n = len(track)
    return Cleaned(
        track.lat + 1e-4,
        track.lon,
        inlier=np.arange(n) % 2 == 0,
        probability=np.linspace(0.0, 1.0, n),
        reason=["ok" if row % 2 == 0 else "spike" for row in range(n)],
        others={"speed_mps": np.full(n, 1.25), "heading_deg": np.full(n, np.nan)},
    )


def features(pieces: Any) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(b"".join(pieces))["features"]
    return found


def test_a_table_shows_cleaned_and_recorded_positions_side_by_side() -> None:
    track = recording([50.0, 50.5], [7.0, 7.0])
    assert b"".join(write_csv(track, cleaned(track))).decode().splitlines() == [
        "time,lat,lon,raw_lat,raw_lon,inlier,probability,reason,speed_mps,heading_deg",
        "2021-07-28T07:00:00Z,50.0001000,7.0000000,50.0000000,7.0000000,true,0,ok,1.25,",
        "2021-07-28T07:00:01Z,50.5001000,7.0000000,50.5000000,7.0000000,false,1,spike,1.25,",
    ]


def test_times_go_out_in_the_zone_in_which_they_came() -> None:
    body = b"time,lat,lon\n2021-07-28T16:00:00.250+09:00,35,139\n2021-07-28T02:30:00-04:30,35,139\n"
    times = [line.split(b",")[0] for line in b"".join(write_csv(read_track(body))).splitlines()[1:]]
    assert times == [b"2021-07-28T16:00:00.250+09:00", b"2021-07-28T02:30:00.000-04:30"]


def test_a_device_whose_name_is_a_formula_is_no_formula_in_a_table() -> None:
    track = recording([50.0], [7.0], devices=('=HYPERLINK("x")',))
    assert b'"\'=HYPERLINK(""x"")"' in b"".join(write_csv(track))


def test_gpx_has_flags_and_recorded_positions_in_extensions() -> None:
    track = recording([50.0, 50.5], [7.0, 7.0], height_m=np.array([99.5, np.nan]))
    text = b"".join(write_gpx(track, cleaned(track))).decode()
    assert '<trkpt lat="50.0001000" lon="7.0000000"><ele>99.5</ele><time>2021-07-28T07:00:00Z</time>' in text
    assert "<pl:raw_lat>50.0000000</pl:raw_lat>" in text
    assert (
        "<pl:inlier>false</pl:inlier><pl:probability>1</pl:probability><pl:reason>spike</pl:reason>" in text
    )


def test_gpx_keeps_devices_and_segments_that_are_interleaved() -> None:
    track = recording(
        [50.0, 51.0, 50.1, 51.1, 50.2],
        [7.0] * 5,
        device=np.array([0, 1, 0, 1, 0]),
        devices=("a", "b <&>\x00"),
        segment=np.array([0, 1, 0, 1, 2]),
    )
    back = read_track(b"".join(write_gpx(track)))
    assert back.lat.tolist() == [50.0, 50.1, 50.2, 51.0, 51.1]
    assert back.device_names() == ["a", "a", "a", "b <&>", "b <&>"]
    assert back.segment is not None
    assert back.segment.tolist() == [0, 0, 1, 2, 2]


def test_gpx_cannot_hold_plain_numbers_as_times() -> None:
    with pytest.raises(InputError, match="write CSV"):
        write_gpx(read_track(b"t,lat,lon\n0,50,7\n"))


def test_a_line_is_cut_at_the_antimeridian() -> None:
    (line,) = features(write_geojson(recording([10.0, 11.0, 12.0], [179.0, -179.0, -178.0])))
    assert line["geometry"] == {
        "type": "MultiLineString",
        "coordinates": [[[179.0, 10.0], [180.0, 10.5]], [[-180.0, 10.5], [-179.0, 11.0], [-178.0, 12.0]]],
    }
    assert line["properties"]["coordTimes"] == [
        ["2021-07-28T07:00:00.000Z", "2021-07-28T07:00:00.500Z"],
        ["2021-07-28T07:00:00.500Z", "2021-07-28T07:00:01.000Z", "2021-07-28T07:00:02.000Z"],
    ]


@given(st.lists(st.tuples(st.floats(-180.0, 180.0), st.floats(-90.0, 90.0)), min_size=2, max_size=12))
def test_no_piece_of_a_line_makes_more_than_half_a_turn(positions: list[tuple[float, float]]) -> None:
    pieces = cut_line(np.array(positions))
    assert all(len(piece) >= 2 for piece in pieces[:-1])
    for piece in pieces:
        assert (np.abs(piece[:, 0]) <= 180.0).all()
        assert (np.abs(np.diff(piece[:, 0])) <= 180.0).all()
    kept = np.vstack([piece[(k > 0) : len(piece) - (k + 1 < len(pieces))] for k, piece in enumerate(pieces)])
    np.testing.assert_array_equal(kept, np.array(positions))


def test_lines_are_in_order_of_time_and_without_rows_that_have_no_position() -> None:
    track = recording([50.0, np.nan, 52.0], [7.0, np.nan, 9.0])
    backward = Recording("csv", track.time[::-1].copy(), track.lat, track.lon, track.fault)
    (line,) = features(write_geojson(backward))
    assert line["geometry"]["coordinates"] == [[9.0, 52.0], [7.0, 50.0]]


def test_a_segment_of_one_fix_is_a_point() -> None:
    track = recording([50.0, 51.0, 52.0], [7.0] * 3, segment=np.array([0, 0, 1]), devices=("a",))
    point, line = features(write_geojson(track))
    assert point["geometry"] == {"type": "Point", "coordinates": [7.0, 52.0]}
    assert point["properties"] == {"device": "a", "time": "2021-07-28T07:00:02Z"}
    assert line["geometry"]["type"] == "LineString"


def test_points_are_one_feature_per_row_also_where_there_is_no_position() -> None:
    track = recording([50.0, np.nan], [7.0, np.nan], height_m=np.array([5.0, np.nan]))
    first, second = features(write_geojson(track, cleaned(track), points=True))
    assert first["geometry"] == {"type": "Point", "coordinates": [7.0, 50.0001, 5.0]}
    assert first["properties"]["inlier"] is True
    assert second["geometry"] is None
    assert second["properties"] == {
        "time": "2021-07-28T07:00:01Z",
        "raw_lat": None,
        "raw_lon": None,
        "inlier": False,
        "probability": 1,
        "reason": "spike",
        "speed_mps": 1.25,
        "heading_deg": None,
    }


def test_columns_of_another_length_are_refused() -> None:
    with pytest.raises(InputError, match="has 1 rows where the recording has 2"):
        write_csv(recording([50.0, 51.0], [7.0, 7.0]), Cleaned(np.zeros(1), np.zeros(1)))
    with pytest.raises(InputError, match="lon: has 2 rows where lat has 1"):
        Cleaned(np.zeros(1), np.zeros(2))


DEGREES = st.integers(-(10**9), 10**9)
ROWS = st.lists(
    st.tuples(DEGREES, DEGREES, st.integers(0, 2**53), st.integers(-720, 840), st.sampled_from("abc")),
    min_size=1,
    max_size=30,
)


def track_of(rows: list[tuple[int, int, int, int, str]]) -> Recording:
    names = sorted({row[4] for row in rows})
    return Recording(
        "csv",
        np.array([row[2] for row in rows], dtype="datetime64[ns]"),
        np.array([row[0] * 9e-8 for row in rows]),
        np.array([row[1] * 1.8e-7 for row in rows]),
        np.zeros(len(rows), dtype=np.uint8),
        utc_offset_minutes=np.array([row[3] for row in rows], dtype=np.int16),
        device=np.array([names.index(row[4]) for row in rows]) if len(names) > 1 else None,
        devices=tuple(names),
    )


@settings(deadline=None)
@given(ROWS)
def test_what_is_written_in_input_order_is_read_back(rows: list[tuple[int, int, int, int, str]]) -> None:
    track = track_of(rows)
    for body in (b"".join(write_csv(track)), b"".join(write_geojson(track, points=True))):
        back = read_track(body)
        np.testing.assert_array_equal(back.time, track.time)
        np.testing.assert_allclose(back.lat, track.lat, rtol=0, atol=5.1e-11)
        np.testing.assert_allclose(back.lon, track.lon, rtol=0, atol=5.1e-11)
        assert track.utc_offset_minutes is not None
        offsets = np.zeros(len(rows)) if back.utc_offset_minutes is None else back.utc_offset_minutes
        np.testing.assert_array_equal(offsets, track.utc_offset_minutes)
        assert back.device_names() == track.device_names()


@settings(deadline=None)
@given(ROWS)
def test_gpx_is_read_back_device_by_device(rows: list[tuple[int, int, int, int, str]]) -> None:
    track = track_of(rows)
    order = np.arange(len(rows)) if track.device is None else np.argsort(track.device, kind="stable")
    back = read_track(b"".join(write_gpx(track)))
    np.testing.assert_array_equal(back.time, track.time[order])
    np.testing.assert_allclose(back.lat, track.lat[order], rtol=0, atol=5.1e-11)
    assert back.device_names() == [track.device_names()[row] for row in order]


@settings(deadline=None)
@given(ROWS)
def test_the_same_track_gives_the_same_bytes(rows: list[tuple[int, int, int, int, str]]) -> None:
    for write in (write_csv, write_gpx, write_geojson):
        first, second = track_of(rows), track_of(rows)
        assert b"".join(write(first, cleaned(first))) == b"".join(write(second, cleaned(second)))
