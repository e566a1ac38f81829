from __future__ import annotations

import io
import json
import struct
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from rich.console import Console
from typer.testing import CliRunner, Result

import estimators
from estimators import kernels
from estimators.trends.presentation.report import describe
from service.cli import app
from service.cli.tables import show_report
from tests.trends.made import daily, made_trend

NOISE = np.random.default_rng(11).normal(0, 0.05, 20).round(3)
LEVELS = (1 + 0.5 * np.arange(20) + NOISE + np.isin(np.arange(20), (4, 11)) * 9).round(3)
TABLE = "day,level\n" + "".join(f"{day},{level}\n" for day, level in enumerate(LEVELS))


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "levels.csv"
    path.write_text(TABLE)
    return path


def fit(*arguments: object, stdin: str | bytes | None = None) -> Result:
    return CliRunner().invoke(app, ["fit", *map(str, arguments)], input=stdin)


def error_of(result: Result, code: int = 2) -> str:
    """One sentence on standard error, and nothing on standard output."""
    assert result.exit_code == code, result.output
    assert result.stdout == ""
    assert result.stderr.startswith("plumbline: ")
    assert result.stderr.count("\n") == 1
    assert result.stderr.rstrip().endswith(".")
    return result.stderr


def test_a_file_is_answered_with_the_summary_in_the_names_of_its_columns(table: Path) -> None:
    result = fit(table)
    assert result.exit_code == 0
    assert "level = " in result.stdout
    assert "· day" in result.stdout
    assert "18 of 20 follow the trend" in result.stdout
    assert result.stderr == "Took time from column 'day', value from column 'level'.\n"


def test_standard_input_is_read(table: Path) -> None:
    assert fit("-", stdin=TABLE).stdout == fit(table).stdout


def test_json_is_what_the_library_answers(table: Path) -> None:
    printed = json.loads(fit(table, "--json", "--predict", "30", "--level", "0.9").stdout)
    rows = [line.split(",") for line in TABLE.splitlines()[1:]]
    time, value = [int(t) for t, _ in rows], [float(v) for _, v in rows]
    assert printed == estimators.fit_trend(time, value, predict=[30], level=0.9).to_dict()


def test_json_is_to_the_byte_what_the_service_answers(table: Path) -> None:
    from fastapi.testclient import TestClient

    from service.main import create_app
    from service.settings import Settings

    for _ in kernels.warm():
        continue
    with TestClient(create_app(Settings(log_level="error"))) as client:
        answer = client.post(
            "/v1/trends",
            params={"time_column": "day", "value_column": "level"},
            content=TABLE,
            headers={"Content-Type": "text/csv"},
        )
    assert answer.status_code == 200
    assert fit(table, "--json").stdout_bytes == answer.content + b"\n"


def test_csv_has_one_row_per_input_row(table: Path) -> None:
    lines = fit(table, "--csv").stdout.splitlines()
    assert lines[0].startswith("time,value,fit,")
    assert len(lines) == 21
    assert [line.rpartition(",")[2] for line in lines[1:]].count("outlier") == 2


def test_arguments_of_the_fit_reach_the_library(table: Path) -> None:
    answer = json.loads(fit(table, "--json", "--threshold", "0.25", "--seed", "3", "--level", "0.8").stdout)
    assert answer["consensus"]["threshold"] == 0.25
    assert answer["consensus"]["threshold_source"] == "given"
    assert answer["consensus"]["seed"] == 3
    assert answer["uncertainty"]["level"] == 0.8


def test_predictions_may_be_repeated_and_are_dates_where_times_are() -> None:
    body = "day,level\n" + "".join(f"2024-05-{d:02},{d + 0.1 * (d % 3)}\n" for d in range(1, 20))
    result = fit("-", "--json", "--predict", "2024-06-01", "--predict", "2025", stdin=body)
    assert json.loads(result.stdout)["prediction"]["time"] == ["2024-06-01T00:00:00Z", "2025-01-01T00:00:00Z"]


def test_predictions_of_epoch_numbers_are_numbers_or_dates() -> None:
    body = "".join(f"{1_700_000_000 + 60 * k},{k + 0.1 * (k % 3)}\n" for k in range(20))
    result = fit(
        "-", "--json", "--time-unit", "s", "--predict", "1700003600", "--predict", "2023-11-15", stdin=body
    )
    assert json.loads(result.stdout)["prediction"]["time"] == [1_700_003_600, 1_700_006_400]


def test_since_and_until_cut_the_series(table: Path) -> None:
    points = json.loads(fit(table, "--json", "--since", "5", "--until", "15.5").stdout)["points"]
    assert points["time"] == list(range(5, 16))


def test_a_png_is_written_where_asked(table: Path, tmp_path: Path) -> None:
    result = fit(table, "--plot", tmp_path / "trend.png")
    assert result.exit_code == 0
    assert struct.unpack(">II", (tmp_path / "trend.png").read_bytes()[16:24]) == (800, 450)
    assert "trend.png" in result.stderr


def test_an_svg_carries_the_names_of_the_columns(table: Path, tmp_path: Path) -> None:
    fit(table, "--plot", tmp_path / "trend.svg", "--theme", "dark")
    root = ET.parse(tmp_path / "trend.svg").getroot()
    texts = {"".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")}
    assert {"day", "level", "inliers (18)", "outliers (2)"} <= texts


def test_a_terminal_gets_the_same_words_in_colour() -> None:
    trend = made_trend(
        daily(30), np.zeros(30), slope=1e-6, level=2.0, outliers=(3,), predict=daily(1, "2025-01-01")
    )
    report = describe(trend, time_name="[bold]time", value_name="level")
    shown = io.StringIO()
    show_report(Console(file=shown, force_terminal=True, width=80, color_system="standard"), report)
    plain = io.StringIO()
    show_report(Console(file=plain, width=80), report)
    assert "\x1b[" in shown.getvalue()
    words = " ".join(plain.getvalue().split())
    for text in (report.title, report.equation, *(label for label, _ in report.facts)):
        assert text in words
    for row in report.estimates:
        assert row.value in words


def test_markup_in_a_column_name_is_printed_as_it_is() -> None:
    trend = made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0)
    shown = io.StringIO()
    show_report(Console(file=shown, width=80), describe(trend, value_name="[red]y[/red]"))
    assert "[red]y[/red]" in shown.getvalue()


def test_too_little_data_is_code_1_with_the_reason() -> None:
    result = fit("-", stdin="time,value\n1,2\n")
    assert result.exit_code == 1
    assert "no trend (too_few_points)" in result.stderr


def test_too_little_data_as_json_still_carries_the_reason() -> None:
    result = fit("-", "--json", stdin="time,value\n1,2\n")
    assert result.exit_code == 1
    assert json.loads(result.stdout)["reason"] == "too_few_points"


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    assert "nothing.csv: there is no such file" in error_of(fit(tmp_path / "nothing.csv"))


def test_a_directory_is_refused(tmp_path: Path) -> None:
    assert "is a directory" in error_of(fit(tmp_path))


def test_a_binary_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "noise.csv"
    path.write_bytes(bytes(range(256)))
    assert "not text" in error_of(fit(path))


def test_a_cell_that_is_no_number_is_named_by_line_and_column() -> None:
    sentence = error_of(fit("-", stdin="time,value\n1,2\n2,abc\n3,4\n"))
    assert "standard input: line 3, column 'value': 'abc' is not a number" in sentence


def test_an_unknown_column_lists_the_columns(table: Path) -> None:
    assert "the columns are: 'day', 'level'" in error_of(fit(table, "--value", "depth"))


def test_an_unknown_method_lists_the_methods_and_the_nearest(table: Path) -> None:
    sentence = error_of(fit(table, "--method", "theil-san"))
    assert "did you mean theil-sen?" in sentence
    assert "auto" in sentence


def test_an_unknown_model_lists_the_models(table: Path) -> None:
    assert "the models are: line" in error_of(fit(table, "--model", "cubic"))


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (("--level", "1.5"), "--level"),
        (("--threshold", "-1"), "--threshold"),
        (("--sigma", "nan"), "--sigma"),
        (("--predict", "2030-01-01"), "--predict '2030-01-01'"),
        (("--predict", "nan"), "--predict 'nan'"),
        (("--since", "yesterday"), "--since 'yesterday'"),
        (("--since", "100"), "--since"),
        (("--delimiter", "abc"), "'abc'"),
        (("--plot", "trend.gif"), ".png or .svg"),
        (("--plot", "nowhere/trend.png"), "nowhere"),
        (("--json", "--csv"), "--csv"),
    ],
)
def test_an_option_that_cannot_be_used_is_named(table: Path, arguments: tuple[str, ...], named: str) -> None:
    result = fit(table, *arguments)
    assert result.exit_code == 2, result.output
    assert named in result.stderr
    assert result.stdout == ""


def test_predictions_for_dates_say_what_a_date_looks_like() -> None:
    sentence = error_of(fit("-", "--predict", "tomorrow", stdin="2024-05-01,1\n2024-05-02,2\n2024-05-03,3\n"))
    assert "--predict 'tomorrow'" in sentence
    assert "2030-01-31" in sentence


def test_an_unknown_option_is_code_2(table: Path) -> None:
    assert fit(table, "--bogus").exit_code == 2


def test_a_season_and_a_degree_can_be_asked_for(tmp_path: Path) -> None:
    path = tmp_path / "tides.csv"
    hours = np.arange(96)
    values = (2.0 + 0.05 * hours + 3.0 * np.sin(2 * np.pi * hours / 12)).round(4)
    path.write_text("t,level\n" + "".join(f"{t},{y}\n" for t, y in zip(hours, values, strict=True)))
    told = json.loads(fit(path, "--model", "linear", "--degree", 2, "--seasonal", 12, "--json").stdout)
    assert told["seasons"][0]["period"] == 12.0
    assert told["parameters"]["season_1_amplitude"]["value"] == pytest.approx(3.0, abs=0.01)
    found = fit(path, "--seasonal", "auto")
    assert "season of 12" in found.stdout
    assert "--degree" in error_of(fit(path, "--degree", 2))
