import json
from typing import Any

import numpy as np
import pytest

from estimators.adapters.tracks import RowFault, read_track
from estimators.arrays import InputError

TIMES = ["2021-07-28T07:00:00Z", "2021-07-28T07:00:01Z"]
LINE = {"type": "LineString", "coordinates": [[7.0, 50.0, 99.0], [7.1, 50.1, 98.0]]}


def feature(geometry: Any, **properties: Any) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def read(document: Any) -> Any:
    return read_track(json.dumps(document).encode())


@pytest.mark.parametrize(
    "properties", [{"coordTimes": TIMES}, {"times": TIMES}, {"coordinateProperties": {"times": TIMES}}]
)
def test_times_of_a_line_stand_where_converters_put_them(properties: dict[str, Any]) -> None:
    track = read(feature(LINE, **properties))
    assert track.lon.tolist() == [7.0, 7.1]
    assert track.height_m.tolist() == [99.0, 98.0]
    assert track.time[1] == np.datetime64("2021-07-28T07:00:01")


def test_lines_of_a_multi_line_are_segments_and_features_devices() -> None:
    multi = {"type": "MultiLineString", "coordinates": [LINE["coordinates"], LINE["coordinates"]]}
    features = [
        feature(multi, coordTimes=[TIMES, TIMES], name="a"),
        feature(LINE, coordTimes=TIMES, name="b"),
    ]
    track = read({"type": "FeatureCollection", "features": features})
    assert track.segment.tolist() == [0, 0, 1, 1, 2, 2]
    assert track.device_names() == ["a"] * 4 + ["b"] * 2


def test_one_list_of_times_is_cut_as_the_lines_are() -> None:
    multi = {"type": "MultiLineString", "coordinates": [LINE["coordinates"], LINE["coordinates"]]}
    assert len(read(feature(multi, coordTimes=TIMES + TIMES))) == 4


def test_points_are_rows_with_their_properties() -> None:
    rows = [
        feature({"type": "Point", "coordinates": [7.0, 50.0]}, time=TIMES[0], speed=1.5, device="a"),
        feature({"type": "Point", "coordinates": [7.0, "x"]}, time=TIMES[1], speed=None, device="b"),
        feature(None, time=5, device="a"),
    ]
    track = read({"type": "FeatureCollection", "features": rows})
    assert track.device_names() == ["a", "b", "a"]
    assert track.speed_mps[0] == 1.5
    assert track.fault.tolist() == [
        RowFault.none,
        RowFault.position_unreadable,
        RowFault.position_missing,
    ]
    assert np.isnat(track.time[2])


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ([], "not GeoJSON"),
        ({"type": "FeatureCollection", "features": 5}, "features are not a list"),
        ({"type": "FeatureCollection", "features": []}, "without lines or points"),
        (feature({"type": "Polygon", "coordinates": []}), "without lines or points"),
        (feature(LINE), "coordTimes: is missing"),
        (feature(LINE, coordTimes=TIMES[:1]), "one time for each position"),
        (feature(LINE, coordTimes=["noon", "night"]), "no point of the track has a time"),
    ],
)
def test_geojson_without_a_track_says_what_is_wrong(document: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read(document)


@pytest.mark.parametrize("body", [b'{"type": "Feature"', b'{"a":' * 100_000, b'{"type": "\xff"}'])
def test_json_that_cannot_be_read_is_refused(body: bytes) -> None:
    with pytest.raises(InputError, match="not valid JSON"):
        read_track(body)
