"""How a track leaves Python."""

import json
from dataclasses import replace

import numpy as np
import pytest

from estimators import NoticeCode, Track, clean_trajectory
from estimators.geodesy.plane import Plane
from estimators.notices import NOTICE_MEANINGS, TRACK_NOTICES
from estimators.presentation.text import WIDTH
from estimators.trajectories.presentation.words import ADVICE
from tests.trajectories.drives import MUNICH, drive, with_bursts, with_spikes

TRACK = with_bursts(with_spikes(drive(8), share=0.05)).clean()


def test_the_dict_is_json_and_has_a_row_per_row() -> None:
    answer = TRACK.to_dict()
    assert json.loads(json.dumps(answer, allow_nan=False)) == answer
    assert {len(column) for column in answer["points"].values() if column is not None} == {len(TRACK)}
    assert "points" not in TRACK.to_dict(points=False)


def test_datetimes_are_iso_8601_in_the_dict() -> None:
    moments = np.datetime64("2026-03-01T10:00:00") + np.arange(10).astype("timedelta64[s]")
    track = clean_trajectory(moments, 48.0 + 1e-4 * np.arange(10), np.full(10, 11.0))
    assert isinstance(track, Track)
    assert track.to_dict()["points"]["time"][1] == "2026-03-01T10:00:01.000Z"


def test_the_frame_has_a_row_per_row() -> None:
    frame = TRACK.to_frame()
    assert len(frame) == len(TRACK)
    assert list(frame["reason"]) == TRACK.points.reason


def test_a_track_across_the_antimeridian_is_cut_there() -> None:
    plane = Plane(-17.8, 180.0)
    t = np.arange(100.0)
    rng = np.random.default_rng(0)
    east = np.column_stack([20.0 * t - 1000.0, np.zeros(100)]) + rng.normal(size=(100, 2))
    track = clean_trajectory(t, *plane.locate(east))
    assert isinstance(track, Track)
    line = track.to_geojson()["features"][0]
    assert line["geometry"]["type"] == "MultiLineString"
    west, rest = line["geometry"]["coordinates"]
    assert west[-1][0] == 180.0
    assert rest[0][0] == -180.0
    assert west[-1][1] == rest[0][1]
    assert all(longitude > 179.0 for longitude, _ in west)
    assert all(longitude < -179.0 for longitude, _ in rest)
    assert [len(part) for part in line["properties"]["coordTimes"]] == [len(west), len(rest)]


def test_geojson_points_carry_their_labels() -> None:
    features = TRACK.to_geojson(points=True)["features"]
    assert len(features) == 1 + len(TRACK)
    assert [item["properties"]["reason"] for item in features[1:]] == TRACK.points.reason
    assert features[0]["geometry"]["type"] == "LineString"


def test_the_summary_fits_80_columns_and_tells_what_matters() -> None:
    text = TRACK.summary()
    assert max(map(len, text.splitlines())) <= WIDTH
    assert f"{int(TRACK.points.inlier.sum())} of {len(TRACK)} follow the track" in text
    assert "Distance" in text


def test_the_notebook_table_is_escaped_html() -> None:
    table = replace(TRACK, method="<script>")._repr_html_()
    assert table.startswith("<table")
    assert "Track by &lt;script&gt;" in table
    assert "<script" not in table


def _codes(*columns: object, **settings: object) -> set[NoticeCode]:
    found = clean_trajectory(*columns, **settings)  # type: ignore[arg-type]
    assert isinstance(found, Track)
    return {item.code for item in found.notices}


def _with_rows(change: str) -> set[NoticeCode]:
    made = drive(3)
    t, fixes = made.t.copy(), made.fixes.copy()
    if change == "jump":
        t[100:150] -= 20.0
    if change == "stale":
        fixes[100:140] = fixes[100]
    if change == "gap":
        t[200:] += 3600.0
    lat, lon = MUNICH.locate(fixes)
    if change == "invalid":
        lat[5] = np.nan
    return _codes(t, lat, lon)


def _drifting() -> set[NoticeCode]:
    rng = np.random.default_rng(0)
    t = np.arange(900.0)
    slow = np.zeros((900, 2))
    for k in range(1, 900):
        slow[k] = 0.905 * slow[k - 1] + 3.4 * rng.normal(size=2)
    return _codes(t, *MUNICH.locate(np.column_stack([15.0 * t, 0.0 * t]) + slow + rng.normal(size=(900, 2))))


def _sparse() -> set[NoticeCode]:
    made = drive(1, n=6000)
    some = slice(None, None, 30)
    return _codes(made.t[some], *MUNICH.locate(made.fixes[some]))


CASES = {
    NoticeCode.few_fixes: lambda: _codes([0.0], [48.0], [11.0]),
    NoticeCode.drift_unobservable: _drifting,
    NoticeCode.sampling_too_sparse: _sparse,
    NoticeCode.mostly_faulty: lambda: {
        item.code for item in with_spikes(drive(1), share=0.45).clean().notices
    },
    NoticeCode.clock_jumped: lambda: _with_rows("jump"),
    NoticeCode.stale_positions: lambda: _with_rows("stale"),
    NoticeCode.long_gaps: lambda: _with_rows("gap"),
    NoticeCode.invalid_rows: lambda: _with_rows("invalid"),
}


@pytest.mark.parametrize("code", sorted(TRACK_NOTICES))
def test_every_notice_of_tracks_occurs_and_says_what_to_do(code: NoticeCode) -> None:
    assert code in CASES[code]()
    assert ADVICE[code].endswith(".")
    assert NOTICE_MEANINGS[code].endswith(".")


def test_a_good_track_has_no_notices() -> None:
    assert drive(1).clean().notices == ()
