"""Forms of the answers about tracks: GPX, GeoJSON and tables, from a real server."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from estimators.adapters.tracks import read_track
from service.schemas.tracks import TrackFeaturesAnswer
from tests.service.fixes import SPIKE, N, as_csv, as_gpx, clock, two_walks, walk
from tests.service.server import Server, serve
from tests.service.track_files import post, timed_walk


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serve() as running:
        yield running


def test_a_cleaned_gpx_holds_the_smoothed_track_with_its_labels(server: Server) -> None:
    response = post(server, as_gpx(timed_walk(), name="Tour"), "application/gpx+xml", format="gpx")
    assert response.headers["content-type"] == "application/gpx+xml"
    track = read_track(response.content)
    answer = post(server, as_gpx(timed_walk()), "application/gpx+xml").json()
    assert track.devices == ("Tour",)
    assert track.lat.tolist() == pytest.approx(answer["points"]["lat_deg"], abs=1e-7)
    assert response.text.count("<pl:reason>spike</pl:reason>") == 1
    assert clock()[0] in response.text


def test_geojson_is_a_line_with_its_times_or_a_point_per_fix(server: Server) -> None:
    body = as_csv(timed_walk())
    line = post(server, body, "text/csv", format="geojson").json()
    TrackFeaturesAnswer.model_validate(line)
    assert line["features"][0]["geometry"]["type"] == "LineString"
    assert line["features"][0]["properties"]["coordTimes"] == clock()
    points = post(server, body, "text/csv", format="geojson", points=True).json()
    TrackFeaturesAnswer.model_validate(points)
    assert [item["properties"]["time"] for item in points["features"]] == clock()
    assert points["features"][SPIKE]["properties"]["reason"] == "spike"


def test_a_line_over_the_antimeridian_is_cut(server: Server) -> None:
    fields = timed_walk()
    fields["lon"] = [(180.0 - 1e-3 + 5e-5 * k + 180.0) % 360.0 - 180.0 for k in range(N)]
    (feature,) = post(server, as_csv(fields), "text/csv", format="geojson").json()["features"]
    assert feature["geometry"]["type"] == "MultiLineString"
    assert feature["geometry"]["coordinates"][0][-1][0] == 180.0


def test_tables_have_a_row_per_fix_in_the_order_they_came(server: Server) -> None:
    fields = two_walks() | {"height": [5.0 + 0.1 * k for k in range(2 * N)], "accuracy": [4.0] * (2 * N)}
    body = as_csv(fields)
    lines = list(csv.DictReader(io.StringIO(post(server, body, "text/csv", format="csv").text)))
    arrow = pa.ipc.open_stream(post(server, body, "text/csv", format="arrow").content).read_all()
    parquet = pq.read_table(io.BytesIO(post(server, body, "text/csv", format="parquet").content))
    assert arrow.column_names == parquet.column_names == list(lines[0])
    assert [line["device"] for line in lines] == fields["device"] == arrow["device"].to_pylist()
    assert arrow["reason"].to_pylist() == [line["reason"] for line in lines]
    assert arrow["raw_lat"].to_pylist() == fields["lat"]
    assert parquet["lat"].to_pylist() == arrow["lat"].to_pylist()
    assert [float(line["lat"]) for line in lines] == pytest.approx(arrow["lat"].to_pylist(), abs=1e-7)


def test_rows_of_a_device_without_a_track_say_why_in_a_table(server: Server) -> None:
    fields = two_walks()
    for name, more in (("time", [7, 7]), ("lat", [1.0, 2.0]), ("lon", [3.0, 4.0]), ("device", ["x", "x"])):
        fields[name] += more
    text = post(server, as_csv(fields), "text/csv", format="csv").text
    last = list(csv.DictReader(io.StringIO(text)))[-1]
    assert (last["reason"], last["lat"], last["raw_lat"]) == ("constant_time", "", "2.0000000000")


@pytest.mark.parametrize(("zone", "name"), [("+02:00", "+02:00"), ("Z", "UTC")])
def test_times_in_arrow_keep_the_zone_that_all_share(server: Server, zone: str, name: str) -> None:
    body = as_csv(walk(time=clock(zone=zone)))
    answer = pa.ipc.open_stream(post(server, body, "text/csv", format="arrow").content).read_all()
    assert answer.schema.field("time").type == pa.timestamp("ns", name)


def test_mixed_zones_stand_beside_the_times_in_arrow(server: Server) -> None:
    times = [
        text if k % 2 else text.replace("T12", "T10").replace("+02:00", "Z") for k, text in enumerate(clock())
    ]
    body = as_csv(walk(time=times))
    answer = pa.ipc.open_stream(post(server, body, "text/csv", format="arrow").content).read_all()
    assert answer["utc_offset_minutes"].to_pylist()[:2] == [0, 120]


def test_the_form_of_numbers_since_1970_is_kept_in_every_table(server: Server) -> None:
    times = [1_714_564_800_000 + 1_000 * k for k in range(N)]
    body = as_csv(walk(time=times))
    asked = {"time_unit": "ms"}
    lines = list(csv.DictReader(io.StringIO(post(server, body, "text/csv", format="csv", **asked).text)))
    assert [int(line["time"]) for line in lines] == times
    arrow = pa.ipc.open_stream(post(server, body, "text/csv", format="arrow", **asked).content).read_all()
    assert arrow["time"].to_pylist() == times
    line = post(server, body, "text/csv", format="geojson", **asked).json()
    assert line["features"][0]["properties"]["coordTimes"] == times


@pytest.mark.parametrize("form", ["json", "csv", "geojson", "gpx", "arrow", "parquet"])
def test_a_missing_time_leaves_its_row_without_a_place_in_every_form(server: Server, form: str) -> None:
    fields = walk(time=[None if k == 4 else 1_714_564_800_000 + 1_000 * k for k in range(N)])
    response = post(server, as_csv(fields), "text/csv", format=form, time_unit="ms")
    assert response.status_code == 200
    assert b"NaN" not in response.content
    assert b"nan" not in response.content
    if form == "csv":
        line = list(csv.DictReader(io.StringIO(response.text)))[4]
        assert (line["time"], line["lat"], line["reason"]) == ("", "", "invalid")
