"""Files cleaned piece by piece are those written as a whole."""

from __future__ import annotations

import doctest
import io
import itertools
import json
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, NoFit, Track, clean_trajectory
from estimators.adapters.tracks import (
    Cleaned,
    Recording,
    clean_file,
    clean_recording,
    cleaning,
    gpx_writer,
    read_track,
    spool,
    stream_track,
    streaming,
    write_csv,
    write_geojson,
    write_gpx,
    written_columns,
)
from estimators.adapters.tracks.spool import open_spool

ROWS = 300
SPACE = "{http://www.topografix.com/GPX/1/1}"


@pytest.fixture(autouse=True)
def _short_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cleaning, "_PIECE_ROWS", 64)
    monkeypatch.setattr(spool, "PIECE_ROWS", 50)


def table(devices: int = 1, *, shuffled: bool = False) -> bytes:
    rng = np.random.default_rng(0)
    lines = []
    for row in range(ROWS):
        moment = np.datetime64("2024-05-01T10:00:00") + np.timedelta64(row, "s")
        lat, lon = 48.0 + 1e-4 * row + 2e-5 * rng.normal(), 11.0 + 2e-5 * rng.normal()
        height = 500.0 + rng.normal()
        lines.append(f"{moment}Z,{lat:.7f},{lon:.7f},{height:.1f},bus {row % devices},{row // 100}")
    lines[7] = lines[7].replace("Z,", "Z,9")
    if shuffled:
        lines = [lines[place] for place in rng.permutation(ROWS)]
    return "\n".join(["time,lat,lon,height,device,segment", *lines]).encode()


def whole(recording: Recording) -> Cleaned:
    track = clean_trajectory(recording.time, recording.lat, recording.lon, height_m=recording.height_m)
    assert isinstance(track, Track)
    points = track.points
    others = {
        "residual_m": points.residual_m,
        "sigma_m": track.sigma_m,
        "speed_mps": track.speed_mps,
        "speed_sigma_mps": track.speed_sigma_mps,
        "heading_deg": track.heading_deg,
        "heading_sigma_deg": track.heading_sigma_deg,
    }
    return Cleaned(
        track.lat_deg, track.lon_deg, track.height_m, points.inlier, points.probability, points.reason, others
    )


def streamed(body: bytes, form: str) -> bytes:
    recording = read_track(body)
    return b"".join(stream_track(recording, clean_recording(recording), form))


@pytest.mark.parametrize("shuffled", [False, True])
def test_pieces_make_the_file_that_the_whole_makes(shuffled: bool) -> None:
    body = table(shuffled=shuffled)
    recording = read_track(body)
    assert streamed(body, "csv") == b"".join(write_csv(recording, whole(recording)))
    assert streamed(body, "geojson") == b"".join(write_geojson(recording, whole(recording), points=True))


def test_gpx_in_pieces_is_gpx_as_a_whole() -> None:
    recording = read_track(table())
    assert streamed(table(), "gpx") == b"".join(write_gpx(recording, whole(recording)))


def test_gpx_has_a_track_for_each_device_and_a_segment_for_each_piece_of_it() -> None:
    tracks = ElementTree.fromstring(streamed(table(devices=3), "gpx").decode()).findall(f"{SPACE}trk")
    assert [track.findtext(f"{SPACE}name") for track in tracks] == ["bus 0", "bus 1", "bus 2"]
    assert [len(track.findall(f"{SPACE}trkseg")) for track in tracks] == [3, 3, 3]


@pytest.mark.parametrize("form", ["parquet", "arrow"])
def test_tables_in_pieces_hold_what_csv_holds(form: str) -> None:
    found = as_table(streamed(table(devices=2), form), form)
    header, *lines = streamed(table(devices=2), "csv").decode().splitlines()
    names, cells = header.split(","), [line.split(",") for line in lines]
    assert found.column_names == names
    assert found.num_rows == len(lines) == ROWS
    assert found.column("reason").to_pylist() == [row[names.index("reason")] for row in cells]
    known = [float(row[names.index("lat")]) for row in cells]
    np.testing.assert_allclose(found.column("lat").to_numpy(), known, atol=1e-7)
    assert found.column("raw_lat").null_count == 1


def test_devices_come_one_after_the_other_with_their_facts() -> None:
    cleaned = clean_recording(read_track(table(devices=3)))
    devices = [name for part, _ in cleaned for name in part.device_names()]
    assert devices == ["bus 0"] * (ROWS // 3) + ["bus 1"] * (ROWS // 3) + ["bus 2"] * (ROWS // 3)
    assert list(cleaned.facts) == ["bus 0", "bus 1", "bus 2"]
    rows = [found.rows for found in cleaned.facts.values() if not isinstance(found, NoFit)]
    assert rows == [ROWS // 3] * 3


def test_a_file_keeps_the_order_of_the_rows_whatever_their_devices() -> None:
    sink = io.BytesIO()
    clean_file(table(devices=3), sink)
    devices = [line.split(",")[1] for line in sink.getvalue().decode().splitlines()[1:]]
    assert devices == ["bus 0", "bus 1", "bus 2"] * (ROWS // 3)


@settings(max_examples=25, deadline=None)
@given(data=st.data(), size=st.integers(1, 40))
def test_a_spool_gives_any_rows_what_was_said_of_them(data: st.DataObject, size: int) -> None:
    rows = np.array(data.draw(st.permutations(range(size))))
    cuts = sorted(data.draw(st.sets(st.integers(1, size), max_size=4)) | {size})
    asked = np.array(data.draw(st.lists(st.integers(0, size - 1), max_size=60)), dtype=np.int64)
    with open_spool(size) as kept:
        for first, stop in itertools.pairwise([0, *cuts]):
            some = rows[first:stop]
            said = {"other": -1.0 * some}
            words = [f"word {row % 3}" for row in some]
            kept.put(some, Cleaned(1.0 * some, 2.0 * some, inlier=some % 2 == 0, reason=words, others=said))
        found = kept.take(asked)
    assert found.reason == [f"word {row % 3}" for row in asked]
    assert found.inlier is not None
    assert found.height_m is None
    np.testing.assert_array_equal(found.inlier, asked % 2 == 0)
    for column, factor in ((found.lat, 1.0), (found.lon, 2.0), (found.others["other"], -1.0)):
        np.testing.assert_array_equal(column, factor * asked)


def test_heights_of_one_device_are_a_column_of_all() -> None:
    lines = [f"{row},{48 + 1e-4 * row},11,{'a' if row % 2 else 'b'}," for row in range(40)]
    lines[31] += "500"
    sink = io.BytesIO()
    clean_file("\n".join(["t,lat,lon,device,height", *lines]).encode(), sink)
    header, *rows = [line.split(",") for line in sink.getvalue().decode().splitlines()]
    assert header.count("height_m") == header.count("raw_height_m") == 1
    assert {row[1] for row in rows if row[header.index("height_m")]} == {"a"}


@pytest.mark.parametrize("form", ["parquet", "arrow"])
@pytest.mark.parametrize(("zone", "name"), [("+02:00", "+02:00"), ("Z", "UTC"), ("-03:30", "-03:30")])
def test_tables_keep_the_zone_that_all_times_share(form: str, zone: str, name: str) -> None:
    found = as_table(streamed(table().replace(b"Z,", f"{zone},".encode()), form), form)
    assert str(found.schema.field("time").type) == f"timestamp[ns, tz={name}]"


@pytest.mark.parametrize("form", ["parquet", "arrow"])
def test_tables_tell_zones_that_differ_row_by_row(form: str) -> None:
    found = as_table(streamed(table().replace(b"Z,", b"+05:45,", 100), form), form)
    assert found.column("utc_offset_minutes").to_pylist()[:101] == [345] * 100 + [0]


def as_table(content: bytes, form: str) -> pa.Table:
    source = pa.BufferReader(content)
    return pq.read_table(source) if form == "parquet" else pa.ipc.open_stream(source).read_all()


def test_a_device_without_a_track_keeps_its_rows_and_says_why() -> None:
    sink = io.BytesIO()
    facts = clean_file(b"t,lat,lon,device\n0,50,7,a\n1,50,7.0001,a\n0,95,7,b\n", sink)
    assert isinstance(facts["b"], NoFit)
    assert sink.getvalue().decode().splitlines()[-1].split(",")[1:4] == ["b", "", ""]


def test_a_file_is_cleaned_into_another(tmp_path: Path) -> None:
    source, made = tmp_path / "in.parquet", tmp_path / "out.geojson"
    source.write_bytes(streamed(table(), "parquet"))
    with made.open("wb") as sink:
        facts = clean_file(source, sink, "geojson", columns={"lat": "raw_lat", "lon": "raw_lon"})
    assert len(json.loads(made.read_bytes())["features"]) == ROWS
    (found,) = facts.values()
    assert not isinstance(found, NoFit)
    assert found.rows == ROWS


def test_parquet_is_read_from_its_path_as_from_its_bytes(tmp_path: Path) -> None:
    path = tmp_path / "track.parquet"
    path.write_bytes(streamed(table(devices=2), "parquet"))
    by_path, by_bytes = read_track(path), read_track(path.read_bytes())
    np.testing.assert_array_equal(by_path.time, by_bytes.time)
    np.testing.assert_array_equal(by_path.lat, by_bytes.lat)
    assert by_path.device_names() == by_bytes.device_names()


def test_a_damaged_parquet_file_is_refused_by_its_path_too(tmp_path: Path) -> None:
    path = tmp_path / "track.parquet"
    path.write_bytes(streamed(table(), "parquet")[:-40])
    with pytest.raises(InputError, match="damaged"):
        read_track(path)


def test_a_form_that_is_not_streamed_is_named() -> None:
    with pytest.raises(InputError) as caught:
        streamed(table(), "kml")
    assert caught.value.field == "form"


def test_gpx_refuses_plain_numbers_in_pieces_too() -> None:
    with pytest.raises(InputError):
        streamed(b"t,lat,lon\n0,50,7\n1,50,7.0001\n", "gpx")


@pytest.mark.parametrize("module", [cleaning, gpx_writer, spool, streaming, written_columns])
def test_the_examples_are_true(module: ModuleType) -> None:
    found = doctest.testmod(module)
    assert found.attempted > 0
    assert found.failed == 0
