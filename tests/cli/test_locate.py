"""``plumbline locate`` on tables and on recorded files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from estimators import locate as locate_epoch
from service.cli import app
from tests.service.ranges import LIAR, NAMES, as_csv, epoch, epochs


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
