"""``plumbline locate`` on tables and on recorded files."""

from __future__ import annotations

import json
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner, Result

from estimators import locate as locate_epoch
from service.cli import app
from tests.service.ranges import LIAR, NAMES, as_csv, epoch, epochs
from tests.service.tables import as_file, as_parquet, as_stream


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "ranges.csv"
    path.write_text(as_csv(epoch()))
    return path


def locate(*arguments: object, stdin: str | None = None) -> Result:
    return CliRunner().invoke(app, ["locate", *map(str, arguments)], input=stdin)


def error_of(result: Result, code: int = 2) -> str:
    """One sentence on standard error, and nothing on standard output."""
    assert result.exit_code == code, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("plumbline: ")
    assert result.stderr.rstrip().endswith(".")
    return result.stderr


def test_a_table_is_answered_with_the_summary(table: Path) -> None:
    fields = epoch()
    rows = list(zip(fields["x_m"], fields["y_m"], fields["z_m"], strict=True))
    fix = locate_epoch(rows, fields["pseudorange_m"], satellite=NAMES)
    assert locate(table, "--rotated").stdout == f"{fix.summary()}\n"


def test_standard_input_is_read(table: Path) -> None:
    assert locate("-", "--rotated", stdin=as_csv(epoch())).stdout == locate(table, "--rotated").stdout


def test_json_tells_which_satellite_lies(table: Path) -> None:
    answer = json.loads(locate(table, "--rotated", "--format", "json", "--method", "glrt").stdout)
    assert answer["method"] == "glrt"
    assert answer["satellites"]["status"][LIAR] == "excluded"


def test_epochs_of_a_table_are_solved_as_the_motion_says(tmp_path: Path) -> None:
    path = tmp_path / "epochs.csv"
    path.write_text(as_csv(epochs()))
    answer = json.loads(locate(path, "--rotated", "--format", "json", "--motion", "static").stdout)
    assert answer["motion"] == "static"
    assert len(answer["fixes"]["time"]) == 3


@pytest.mark.parametrize(
    ("kind", "start"), [("csv", b"satellite,"), ("geojson", b"{"), ("svg", b"<?xml"), ("png", b"\x89PNG")]
)
def test_every_format_is_written_to_the_file(table: Path, tmp_path: Path, kind: str, start: bytes) -> None:
    out = tmp_path / f"answer.{kind}"
    result = locate(table, "--rotated", "--format", kind, "-o", out)
    assert result.exit_code == 0, result.stderr
    assert out.read_bytes().startswith(start)
    assert result.stdout == ""


def test_a_mask_leaves_low_satellites_out(table: Path) -> None:
    answer = json.loads(locate(table, "--rotated", "--format", "json", "--mask", 30).stdout)
    assert "masked" in answer["satellites"]["status"]


def test_whether_positions_are_rotated_has_to_be_said(table: Path) -> None:
    assert "--rotated" in error_of(locate(table))


def test_too_few_satellites_end_the_command_with_code_1(tmp_path: Path) -> None:
    path = tmp_path / "few.csv"
    path.write_text("\n".join(as_csv(epoch()).splitlines()[:4]) + "\n")
    assert "at least 4 are needed" in error_of(locate(path, "--rotated"), code=1)


def test_a_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    assert "no such file" in error_of(locate(tmp_path / "none.csv", "--rotated"))


def test_an_unknown_method_is_told_with_the_known(table: Path) -> None:
    assert "p-ransac" in error_of(locate(table, "--rotated", "--method", "wishes"))


def test_a_column_that_lacks_is_named(tmp_path: Path) -> None:
    path = tmp_path / "ranges.csv"
    path.write_text("x_m,y_m\n1,2\n")
    assert "pseudorange_m" in error_of(locate(path, "--rotated"))


def test_a_rinex_file_asks_for_its_navigation_file(tmp_path: Path) -> None:
    path = tmp_path / "day.rnx"
    path.write_text("     3.04           OBSERVATION DATA    M                   RINEX VERSION / TYPE\n")
    assert "--nav" in error_of(locate(path))
    nav = tmp_path / "none.nav"
    assert "no such file" in error_of(locate(path, "--nav", nav))


def test_recorded_rinex_is_located_with_its_navigation_file(gnss_data: Path) -> None:
    folder = gnss_data / "esbc_2020_177"
    result = locate(
        folder / "ESBC00DNK_20201770000_120S.rnx.gz",
        "--nav", folder / "ESBC00DNK_R_20201770000_01D_MN.rnx.gz",
        "--format", "json",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    answer = json.loads(result.stdout)
    assert answer["motion"] == "static"
    assert answer["fixes"]["lat_deg"][0] == pytest.approx(55.494, abs=1e-3)


def test_a_recorded_phone_log_is_told_by_its_content(gnss_data: Path) -> None:
    folder = gnss_data / "google_2016_06_30"
    result = locate(
        folder / "pseudoranges_log_2016_06_30_21_26_07.txt.gz",
        "--nav", folder / "hour1820.16n",
        "--format", "geojson",
    )  # fmt: skip
    assert result.exit_code == 0, result.stderr
    longitude, latitude, _ = json.loads(result.stdout)["features"][0]["geometry"]["coordinates"]
    assert (longitude, latitude) == pytest.approx((-122.08, 37.42), abs=0.05)


def test_the_motion_and_its_window_are_those_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "epochs.csv"
    path.write_text(as_csv(epochs(5)))
    asked = ("--motion", "moving", "--window-s", 90, "--causal", "--surroundings", "city")
    answer = json.loads(locate(path, "--rotated", "--format", "json", *asked).stdout)
    assert (answer["motion"], answer["window_s"], answer["causal"]) == ("moving", 90.0, True)
    assert answer["surroundings"] == "city"


def test_settings_are_given_by_name(table: Path) -> None:
    result = locate(table, "--rotated", "--format", "json", "--option", "fault_prior=0.01")
    assert json.loads(result.stdout)["integrity"]["fault_prior"] == 0.01
    assert "alert_m" in error_of(locate(table, "--rotated", "--option", "wishes=1"))
    assert "fault_prior" in error_of(locate(table, "--rotated", "--option", "fault_prior=2"))


@pytest.mark.parametrize("kind", ["arrow", "stream", "parquet"])
def test_binary_tables_are_told_by_their_content(table: Path, tmp_path: Path, kind: str) -> None:
    columns = pa.table({name: column for name, column in epoch().items() if isinstance(column, list)})
    path = tmp_path / "ranges"
    path.write_bytes({"arrow": as_file, "stream": as_stream, "parquet": as_parquet}[kind](columns))
    assert locate(path, "--rotated").stdout == locate(table, "--rotated").stdout


def test_a_row_per_epoch_is_written_as_parquet(tmp_path: Path) -> None:
    path, out = tmp_path / "epochs.csv", tmp_path / "fixes.parquet"
    path.write_text(as_csv(epochs()))
    result = locate(path, "--rotated", "--format", "parquet", "--rows", "epochs", "-o", out)
    assert result.exit_code == 0, result.stderr
    assert pq.read_table(out)["time"].to_pylist() == [0.0, 30.0, 60.0]


def test_a_binary_answer_wants_a_file(table: Path) -> None:
    assert "--output" in error_of(locate(table, "--rotated", "--format", "arrow"))


def test_raw_ranges_are_corrected(tmp_path: Path) -> None:
    fields = epoch(0.0)
    plain, shifted = tmp_path / "plain.csv", tmp_path / "shifted.csv"
    plain.write_text(as_csv(fields))
    delayed = [value - 299792458.0 * 1e-6 for value in fields["pseudorange_m"]]
    shifted.write_text(as_csv(fields | {"pseudorange_m": delayed, "satellite_clock_s": [1e-6] * 9}))
    asked = ("--rotated", "--raw", "--no-troposphere", "--mask", 5, "--format", "json")
    positions = [json.loads(locate(path, *asked).stdout)["position"] for path in (plain, shifted)]
    assert positions[1]["ecef_m"] == pytest.approx(positions[0]["ecef_m"], abs=1e-4)


def test_figures_are_drawn_as_asked_for(table: Path, tmp_path: Path) -> None:
    out = tmp_path / "errors.svg"
    asked = ("--rotated", "--format", "svg", "--figure", "stanford", "-o", out)
    assert "truth_lat_deg" in error_of(locate(table, *asked))
    assert "latitude, longitude and height" in error_of(locate(table, *asked, "--truth", "52.5,13.4"))
    result = locate(table, *asked, "--truth", "52.5,13.4,80")
    assert result.exit_code == 0, result.stderr
    assert "0 of 1 errors exceed their level" in out.read_text()


def test_pictures_have_the_size_asked_for(table: Path, tmp_path: Path) -> None:
    out = tmp_path / "residuals.png"
    asked = (
        "--figure",
        "residuals",
        "--width-px",
        400,
        "--height-px",
        300,
        "--theme",
        "dark",
        "--title",
        "t",
    )
    result = locate(table, "--rotated", "--format", "png", *asked, "-o", out)
    assert result.exit_code == 0, result.stderr
    content = out.read_bytes()
    assert (int.from_bytes(content[16:20]), int.from_bytes(content[20:24])) == (400, 300)


def test_systems_of_recorded_files_are_those_asked_for(gnss_data: Path) -> None:
    folder = gnss_data / "google_2016_06_30"
    result = locate(
        folder / "pseudoranges_log_2016_06_30_21_26_07.txt.gz",
        "--nav", folder / "hour1820.16n",
        "--systems", "G", "--ionosphere", "none", "--format", "json",
    )  # fmt: skip
    assert set(json.loads(result.stdout)["satellites"]["system"]) == {"G"}
