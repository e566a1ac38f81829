"""``plumbline clean`` on files of tracks."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner, Result

import estimators
from estimators import clean_trajectory
from estimators.adapters.tracks import read_track
from service.cli import app
from tests.service.fixes import SPIKE, N, as_csv, as_gpx, clock, two_walks, walk


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "walk.csv"
    path.write_bytes(as_csv(walk()))
    return path


@pytest.fixture
def tour(tmp_path: Path) -> Path:
    path = tmp_path / "tour.gpx"
    path.write_bytes(as_gpx(walk(time=clock())))
    return path


def clean(*arguments: object, stdin: bytes | None = None) -> Result:
    return CliRunner().invoke(app, ["clean", *map(str, arguments)], input=stdin)


def done(result: Result) -> str:
    assert result.exit_code == 0, result.stderr
    return result.stdout


def error_of(result: Result, code: int = 2) -> str:
    """One sentence on standard error, and nothing on standard output."""
    assert result.exit_code == code, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("plumbline: ")
    assert result.stderr.rstrip().endswith(".")
    return result.stderr


def test_a_track_is_answered_with_the_summary(table: Path) -> None:
    fields = walk()
    track = clean_trajectory(fields["time"], fields["lat"], fields["lon"])
    assert done(clean(table)) == f"{track.summary()}\n"


def test_standard_input_is_read(table: Path) -> None:
    assert done(clean("-", stdin=table.read_bytes())) == done(clean(table))
    answer = json.loads(done(clean("-", table, "--to", "json", stdin=table.read_bytes())))
    assert [item["device"] for item in answer["tracks"]] == ["standard input", "walk.csv"]
    assert "once" in error_of(clean("-", "-"))


def test_json_tells_which_fix_lies(table: Path) -> None:
    asked = ("--to", "json", "--method", "speed-gate", "--max-speed-mps", 30, "--sigma-m", 4, "--level", 0.5)
    answer = json.loads(done(clean(table, *asked)))
    assert (answer["method"], answer["level"], answer["noise"]["source"]) == ("speed-gate", 0.5, "given")
    assert answer["points"]["reason"][SPIKE] == "spike"


@pytest.mark.parametrize(
    ("ending", "start"),
    [
        ("json", b"{"),
        ("geojson", b'{"type":"FeatureCollection"'),
        ("gpx", b"<?xml"),
        ("csv", b"time,lat,lon,"),
        ("arrow", b"\xff\xff\xff\xff"),
        ("parquet", b"PAR1"),
        ("txt", b"Track by auto"),
    ],
)
def test_the_ending_of_the_output_says_what_is_written(
    tour: Path, tmp_path: Path, ending: str, start: bytes
) -> None:
    out = tmp_path / f"clean.{ending}"
    assert done(clean(tour, "-o", out)) == ""
    assert out.read_bytes().startswith(start)


def test_what_is_asked_for_takes_precedence_over_the_ending(tour: Path, tmp_path: Path) -> None:
    out = tmp_path / "clean.txt"
    done(clean(tour, "--to", "csv", "-o", out))
    assert out.read_bytes().startswith(b"time,lat,lon,")


def test_a_cleaned_file_is_a_track_again(tour: Path, tmp_path: Path) -> None:
    out = tmp_path / "clean.gpx"
    done(clean(tour, "-o", out))
    track = read_track(out)
    assert track.utc_offset_minutes is not None
    assert (len(track), set(track.utc_offset_minutes.tolist())) == (N, {120})
    assert abs(track.lat[SPIKE] - walk()["lat"][SPIKE]) > 0.005


def test_points_of_geojson_have_their_labels(tour: Path) -> None:
    features = json.loads(done(clean(tour, "--to", "geojson", "--points")))["features"]
    assert features[SPIKE]["properties"]["reason"] == "spike"


def test_several_files_are_tracks_of_their_own(table: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.csv"
    other.write_bytes(as_csv(two_walks()))
    answer = json.loads(done(clean(table, other, "--to", "json")))
    assert [item["device"] for item in answer["tracks"]] == ["walk.csv", "other.csv: van", "other.csv: bus"]


def test_the_summaries_of_several_tracks_are_told_apart(tmp_path: Path) -> None:
    path = tmp_path / "fleet.csv"
    path.write_bytes(as_csv(two_walks()))
    told = done(clean(path))
    assert told.startswith("van\nTrack by auto\n")
    assert "\n\nbus\nTrack by auto\n" in told


def test_columns_are_those_that_are_named(tmp_path: Path) -> None:
    fields = walk()
    path = tmp_path / "fleet.csv"
    renamed = {"moment": [1000 * t for t in fields["time"]], "north": fields["lat"], "east": fields["lon"]}
    path.write_bytes(as_csv(renamed | {"who": ["a", "b"] * (N // 2)}))
    asked = ("--time", "moment", "--lat", "north", "--lon", "east", "--device", "who", "--time-unit", "ms")
    answer = json.loads(done(clean(path, "--to", "json", *asked)))
    assert [item["device"] for item in answer["tracks"]] == ["a", "b"]
    assert answer["tracks"][0]["track"]["points"]["time"][:2] == [0, 2000]


def test_heights_and_accuracies_are_taken_from_the_columns_named(tmp_path: Path) -> None:
    path = tmp_path / "walk.csv"
    path.write_bytes(as_csv(walk(up=[7.0] * N, radius=[5.0 + k % 3 for k in range(N)])))
    answer = json.loads(done(clean(path, "--height", "up", "--accuracy", "radius", "--to", "json")))
    assert answer["points"]["height_m"] == pytest.approx([7.0] * N)
    assert answer["noise"] != json.loads(done(clean(path, "--to", "json")))["noise"]


def test_a_device_without_a_track_is_remarked_on(tmp_path: Path) -> None:
    fields = two_walks()
    for name, more in (("time", [7, 7]), ("lat", [1.0, 2.0]), ("lon", [3.0, 4.0]), ("device", ["x", "x"])):
        fields[name] += more
    path = tmp_path / "fleet.csv"
    path.write_bytes(as_csv(fields))
    result = clean(path)
    assert "Track by auto" in done(result)
    assert "x has no track: all fixes have the same time" in result.stderr


@pytest.mark.parametrize("device", ["", "a"])
def test_fixes_that_give_no_track_end_the_command_with_code_1(tmp_path: Path, device: str) -> None:
    path = tmp_path / "still.csv"
    columns = {"time": [0, 0], "lat": [1, 3], "lon": [2, 4]} | ({"device": [device] * 2} if device else {})
    path.write_bytes(as_csv(columns))
    assert "the same time" in error_of(clean(path), code=1)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    assert "no such file" in error_of(clean(tmp_path / "none.gpx"))
    assert "directory" in error_of(clean(tmp_path))


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("--method", "wishes"), "speed-gate"),
        (("--level", "2"), "level"),
        (("--sigma-m", "-1"), "sigma_m"),
        (("--to", "gpx"), "time_unit"),
        (("--to", "parquet"), "--output"),
        (("--output", "no/such/folder.csv"), "no directory"),
        (("--lat", "latitude_of_fix"), "no column"),
    ],
)
def test_what_cannot_be_done_is_told_before_the_work(
    table: Path, arguments: tuple[str, ...], word: str
) -> None:
    assert word in error_of(clean(table, *arguments))


def test_columns_are_for_tables_only(tour: Path) -> None:
    assert "tables" in error_of(clean(tour, "--device", "who"))


def test_an_entity_bomb_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.gpx"
    path.write_bytes(b'<!DOCTYPE gpx [<!ENTITY a "aaaa">]><gpx><trk><name>&a;</name></trk></gpx>')
    assert "DOCTYPE" in error_of(clean(path))


def test_sentences_with_wrong_checksums_are_remarked_on(tmp_path: Path) -> None:
    good = "$GPGGA,{0:06d},4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,"
    lines = [f"{text}*{_checksum(text):02X}" for text in (good.format(k) for k in range(5))]
    date = "$GPZDA,000000,01,05,2024,00,00"
    lines = [f"{date}*{_checksum(date):02X}", *lines, f"{good.format(9)}*00"]
    path = tmp_path / "log.nmea"
    path.write_text("\r\n".join(lines) + "\r\n")
    result = clean(path, "--to", "json")
    assert json.loads(done(result))["left_out"] == 1
    assert "checksum is wrong: 1" in result.stderr


def _checksum(sentence: str) -> int:
    total = 0
    for letter in sentence[1:].encode():
        total ^= letter
    return total


def test_binary_answers_have_the_rows_of_the_file(table: Path, tmp_path: Path) -> None:
    done(clean(table, "-o", tmp_path / "a.parquet"))
    done(clean(table, "-o", tmp_path / "a.arrow"))
    parquet = pq.read_table(tmp_path / "a.parquet")
    assert parquet["time"].to_pylist() == [float(k) for k in range(N)]
    assert pa.ipc.open_stream((tmp_path / "a.arrow").read_bytes()).read_all().equals(parquet)


def test_the_methods_are_those_of_the_library(table: Path) -> None:
    for name in estimators.track_methods():
        assert done(clean(table, "--method", name)).startswith(f"Track by {name}\n")


@pytest.mark.parametrize(("ending", "start"), [("svg", b"<?xml"), ("png", b"\x89PNG")])
def test_a_picture_is_written_beside_the_answer(
    table: Path, tmp_path: Path, ending: str, start: bytes
) -> None:
    result = clean(table, "--plot", tmp_path / f"map.{ending}")
    assert done(result) == done(clean(table))
    assert f"Wrote {tmp_path / f'map.{ending}'}." in result.stderr
    assert (tmp_path / f"map.{ending}").read_bytes().startswith(start)


def test_figure_and_theme_choose_another_picture(table: Path, tmp_path: Path) -> None:
    asked: list[tuple[str, ...]] = [(), ("--figure", "error"), ("--theme", "dark")]
    for place, more in enumerate(asked):
        done(clean(table, "--plot", tmp_path / f"{place}.svg", *more))
    assert len({(tmp_path / f"{place}.svg").read_bytes() for place in range(3)}) == 3


@pytest.mark.parametrize(("path", "word"), [("map.gif", ".png or .svg"), ("nowhere/map.png", "nowhere")])
def test_a_picture_that_cannot_be_written_is_refused_before_the_work(
    table: Path, tmp_path: Path, path: str, word: str
) -> None:
    assert word in error_of(clean(table, "--plot", tmp_path / path))


def test_a_picture_of_several_tracks_is_refused(table: Path, tmp_path: Path) -> None:
    assert "one track" in error_of(clean(table, table, "--plot", tmp_path / "map.png"))
