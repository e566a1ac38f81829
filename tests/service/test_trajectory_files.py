"""Track files as bodies and as uploads, to a real server; recorded ones are read where they are."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx2
import pyarrow as pa
import pytest

from estimators.adapters.tracks import read_track
from estimators.consensus.cancellation import Cancelled
from service.codecs.batch.registry import ARROW_FILE, ARROW_STREAM, PARQUET
from service.codecs.limits import Limits
from service.errors import ProblemType
from service.schemas.tracks import TrackAnswer, TracksAnswer
from service.trajectories.files import read_files
from tests.adapters.tracks.fit_files import activity
from tests.service.fixes import SPIKE, N, as_csv, as_geojson, as_gpx, as_kml, clock, two_walks, walk
from tests.service.problems import refused
from tests.service.server import Server, serve
from tests.service.tables import as_file, as_parquet, as_stream
from tests.service.track_files import post, timed_walk, upload

BODY_LIMIT = 1_200_000


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with serve(max_body_bytes=BODY_LIMIT, max_points=10_000) as running:
        yield running


def table(fields: dict[str, Any]) -> pa.Table:
    return pa.table(fields)


BODIES = {
    "csv": ("text/csv", lambda: as_csv(timed_walk())),
    "gpx 1.0": ("application/gpx+xml", lambda: as_gpx(timed_walk(), version="1.0")),
    "gpx 1.1": ("application/gpx+xml", lambda: as_gpx(timed_walk())),
    "kml": ("application/vnd.google-earth.kml+xml", lambda: as_kml(timed_walk())),
    "geojson": ("application/geo+json", lambda: json.dumps(as_geojson(timed_walk())).encode()),
    "arrow stream": (ARROW_STREAM, lambda: as_stream(table(timed_walk()))),
    "arrow file": (ARROW_FILE, lambda: as_file(table(timed_walk()))),
    "parquet": (PARQUET, lambda: as_parquet(table(timed_walk()))),
    "told by content": ("application/octet-stream", lambda: as_gpx(timed_walk())),
    "gzip": ("application/octet-stream", lambda: gzip.compress(as_gpx(timed_walk()))),
}


@pytest.mark.parametrize("form", BODIES)
def test_a_track_is_answered_the_same_in_whatever_format_it_comes(server: Server, form: str) -> None:
    media_type, body = BODIES[form]
    answer = post(server, body(), media_type).json()
    plain = httpx2.post(f"{server.url}/v1/trajectories", json=timed_walk()).json()
    TrackAnswer.model_validate(answer)
    assert answer["points"]["reason"] == plain["points"]["reason"]
    assert answer["points"]["time"] == clock()
    assert answer["points"]["lat_deg"] == pytest.approx(plain["points"]["lat_deg"], abs=1e-9)


@pytest.mark.parametrize("form", BODIES)
def test_an_upload_is_answered_as_the_body_is(server: Server, form: str) -> None:
    media_type, body = BODIES[form]
    assert upload(server, ("track", body())).content == post(server, body(), media_type).content


def test_a_fit_file_is_read(server: Server) -> None:
    answer = post(server, activity(20), "application/vnd.ant.fit").json()
    TrackAnswer.model_validate(answer)
    assert answer["n"] == 20


def test_arguments_come_in_the_query(server: Server) -> None:
    answer = post(server, as_csv(walk()), "text/csv", method="kalman", level=0.5, sigma_m=7).json()
    assert (answer["method"], answer["level"], answer["noise"]["source"]) == ("kalman", 0.5, "given")


def test_columns_of_other_names_are_told_by_the_query(server: Server) -> None:
    fields = {**walk(), "who": ["a"] * N}
    renamed = {"moment": fields["time"], "north": fields["lat"], "east": fields["lon"], "who": fields["who"]}
    asked = {"time_column": "moment", "lat_column": "north", "lon_column": "east", "device_column": "who"}
    (only,) = post(server, as_csv(renamed), "text/csv", **asked).json()["tracks"]
    assert (only["device"], only["track"]["points"]["reason"][SPIKE]) == ("a", "spike")


@pytest.mark.parametrize("form", ["csv", "parquet"])
def test_a_column_that_is_named_and_not_there_is_refused(server: Server, form: str) -> None:
    media_type, body = BODIES[form]
    response = post(server, body(), media_type, lat_column="north")
    refused(response, ProblemType.invalid_value, "lat_column")


@pytest.mark.parametrize(
    "body", [b"secret,lat,lon\n1,2,3\n", as_parquet(pa.table({"secret": [1], "lat": [2.0], "lon": [3.0]}))]
)
def test_a_table_without_a_column_is_refused_without_repeating_its_header(
    server: Server, body: bytes
) -> None:
    response = post(server, body, "application/octet-stream")
    assert "has no column for time" in refused(response, ProblemType.invalid_value, "body")["detail"]
    assert "secret" not in response.text


def test_arguments_of_tables_are_refused_with_other_files(server: Server) -> None:
    body = as_gpx(timed_walk())
    for asked in ({"time_unit": "s"}, {"device_column": "who"}):
        refused(
            post(server, body, "application/gpx+xml", **asked), ProblemType.invalid_value, next(iter(asked))
        )


def test_several_files_are_tracks_of_their_own(server: Server) -> None:
    files = [("a.gpx", as_gpx(timed_walk())), ("b.csv", as_csv(two_walks() | {"time": clock(2 * N)}))]
    answer = upload(server, *files).json()
    TracksAnswer.model_validate(answer)
    assert [item["device"] for item in answer["tracks"]] == ["a.gpx", "b.csv: van", "b.csv: bus"]
    assert answer["tracks"][0]["track"] == upload(server, files[0]).json()
    assert answer["tracks"][1]["row"][0] == N


def test_files_of_one_name_are_told_apart_by_their_number(server: Server) -> None:
    answer = upload(server, ("a.gpx", as_gpx(timed_walk())), ("a.gpx", as_gpx(timed_walk()))).json()
    assert [item["device"] for item in answer["tracks"]] == ["a.gpx (1)", "a.gpx (2)"]


def test_files_with_and_without_points_in_time_are_not_mixed(server: Server) -> None:
    response = upload(server, ("a.csv", as_csv(walk())), ("b.gpx", as_gpx(timed_walk())))
    refused(response, ProblemType.invalid_value, "time")


def test_the_file_of_several_that_is_at_fault_is_told_by_its_number(server: Server) -> None:
    response = upload(server, ("a.gpx", as_gpx(timed_walk())), ("b.gpx", b"<gpx></gpx>"))
    assert "file 2" in refused(response, ProblemType.invalid_value, "file")["detail"]


def test_parts_of_other_names_are_refused(server: Server) -> None:
    response = upload(server, ("a.gpx", as_gpx(timed_walk())), part="track")
    refused(response, ProblemType.invalid_value, "track")


BOMB = (
    b'<?xml version="1.0"?><!DOCTYPE gpx [<!ENTITY a "aaaaaaaaaa">'
    + b"".join(b'<!ENTITY %c "%b">' % (98 + k, b"&%c;" % (97 + k) * 10) for k in range(9))
    + b"]><gpx><trk><name>&j;</name></trk></gpx>"
)
OUTSIDE = b'<!DOCTYPE gpx [<!ENTITY x SYSTEM "file:///etc/passwd">]><gpx><trk><name>&x;</name></trk></gpx>'


@pytest.mark.parametrize("body", [BOMB, OUTSIDE], ids=["bomb", "external entity"])
def test_documents_with_entities_are_refused(server: Server, body: bytes) -> None:
    by_body = post(server, body, "application/gpx+xml")
    assert "DOCTYPE" in refused(by_body, ProblemType.invalid_value, "body")["detail"]
    assert "root:" not in by_body.text
    assert "DOCTYPE" in refused(upload(server, ("a.gpx", body)), ProblemType.invalid_value, "file")["detail"]


@pytest.mark.parametrize(
    ("body", "field", "word"),
    [
        (b"<gpx></gpx>", "body", "no track points"),
        (b'<gpx><trk><trkseg><trkpt lat="1" lon="2"/></trkseg></trk></gpx>', "time", "no point of the track"),
        (b"<gpx><trk>", "body", "not well-formed"),
        (b"<html></html>", "body", "neither GPX nor KML"),
        (b"\x1f\x8bbroken", "body", "damaged"),
        (b"PAR1broken", "body", "damaged"),
        (b"%PDF-1.4", "body", "PDF"),
        (b"\x00\x01" * 50, "body", "no known format"),
        (b"hello", "body", "no column"),
        (b"time,lat,lon\n", "body", "no rows"),
        (b'{"type": "Polygon", "coordinates": []}', "body", "GeoJSON"),
    ],
)
def test_a_file_that_holds_no_track_is_refused(server: Server, body: bytes, field: str, word: str) -> None:
    response = post(server, body, "application/octet-stream")
    assert word in refused(response, ProblemType.invalid_value, field)["detail"]


def test_rows_that_cannot_be_read_stay_with_their_reason(server: Server) -> None:
    fields = timed_walk()
    fields["lat"][3], fields["lat"][5], fields["time"][7], fields["lon"][9] = 91, "NaN", "soon", ""
    answer = post(server, as_csv(fields), "text/csv").json()
    TrackAnswer.model_validate(answer)
    assert [k for k, word in enumerate(answer["points"]["reason"]) if word == "invalid"] == [3, 5, 7, 9]
    assert answer["points"]["time"][7] is None


def test_a_file_that_unpacks_to_too_much_is_refused(server: Server) -> None:
    bomb = gzip.compress(b"time,lat,lon\n" + b"0,48.0,11.0\n" * (5 * BODY_LIMIT // 12))
    assert len(bomb) < BODY_LIMIT // 4
    response = post(server, bomb, "application/octet-stream")
    refused(response, ProblemType.body_too_large, None)
    assert response.json()["limit"] == 4 * BODY_LIMIT


def test_an_upload_above_the_limit_of_bodies_is_refused(server: Server) -> None:
    refused(upload(server, ("a.csv", b"x" * (BODY_LIMIT + 1))), ProblemType.body_too_large, None)


def test_reading_ends_when_nobody_waits_any_more() -> None:
    def check() -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        read_files([as_csv(walk())], columns={}, time_unit=None, limits=Limits(), check=check, field="body")


def test_more_rows_than_the_limit_are_refused(server: Server) -> None:
    body = b"time,lat,lon\n" + b"0,48.0,11.0\n" * 10_001
    refused(post(server, body, "text/csv"), ProblemType.too_many_points, None)


def test_content_that_is_encoded_on_the_way_is_refused(server: Server) -> None:
    headers = {"content-type": "text/csv", "content-encoding": "gzip"}
    body = gzip.compress(as_csv(walk()))
    response = httpx2.post(f"{server.url}/v1/trajectories", content=body, headers=headers)
    refused(response, ProblemType.unsupported_media_type, None)


RECORDED = [
    "geolife_small.csv",
    "gnss_lib_py_pixel6.nmea",
    "gpxpy_cerknicko-jezero.gpx",
    "gpxpy_korita-zbevnica.gpx",
    "liverpool_bus_route14.csv",
    "tracklib_sep_FC_telephone.gpx",
]


@pytest.mark.parametrize("name", RECORDED)
def test_a_recorded_track_has_a_label_for_every_row(server: Server, track_files: Path, name: str) -> None:
    content = (track_files / name).read_bytes()
    answer = upload(server, (name, content)).json()
    (TracksAnswer if "tracks" in answer else TrackAnswer).model_validate(answer)
    parts = [item["track"] or item["refusal"] for item in answer.get("tracks", [{"track": answer}])]
    assert sum(len(part["points"]["reason"]) for part in parts) == len(read_track(content))


def test_a_recorded_track_without_times_is_refused(server: Server, track_files: Path) -> None:
    content = (track_files / "gpxpy_track-with-extremes.gpx").read_bytes()
    refused(upload(server, ("a.gpx", content)), ProblemType.invalid_value, "time")
