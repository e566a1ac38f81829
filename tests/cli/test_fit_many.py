from __future__ import annotations

import csv
import io
import json
import os
import pty
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from typer.testing import CliRunner, Result

from estimators import RobustOptions, Trend, fit_trend
from service.cli import app
from tests.project.tree import ROOT
from tests.service.tables import as_csv, as_file, as_json, as_parquet, as_stream, long_table

TABLE = long_table().rename_columns(["sensor", "time", "value"])
ENDINGS = (".csv", ".parquet", ".arrow", ".arrows", ".json", ".ndjson")


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "in.csv"
    path.write_bytes(as_csv(TABLE))
    return path


def fit_many(*arguments: object, stdin: bytes | None = None) -> Result:
    return CliRunner().invoke(app, ["fit-many", *map(str, arguments)], input=stdin)


def rows_of(path: Path) -> list[dict[str, object]]:
    """Rows of an output in any format; a CSV's cells stay text."""
    if path.suffix == ".csv":
        return list(csv.DictReader(io.StringIO(path.read_text())))
    if path.suffix == ".parquet":
        return list(pq.read_table(path).to_pylist())
    if path.suffix == ".arrow":
        return list(pa.ipc.open_file(path.read_bytes()).read_all().to_pylist())
    if path.suffix == ".arrows":
        return list(pa.ipc.open_stream(path.read_bytes()).read_all().to_pylist())
    if path.suffix == ".json":
        columns = json.loads(path.read_text())["columns"]
        return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    return [json.loads(line) for line in path.read_text().splitlines()]


def error_of(result: Result, code: int = 2) -> str:
    assert result.exit_code == code, result.output
    assert result.stdout == ""
    last = result.stderr.splitlines()[-1]
    assert last.startswith("plumbline: ")
    assert last.endswith(".")
    return last


@pytest.mark.parametrize("ending", ENDINGS)
def test_the_ending_says_how_the_output_is_written(table: Path, tmp_path: Path, ending: str) -> None:
    output = tmp_path / f"out{ending}"
    result = fit_many(table, "-o", output, "--by", "sensor")
    assert result.exit_code == 0, result.output
    assert result.stderr == f"Wrote 5 series to {output}.\n"
    rows = rows_of(output)
    assert [row["series"] for row in rows] == list(dict.fromkeys(TABLE["sensor"].to_pylist()))
    for row in rows:
        mine = TABLE.filter(pa.compute.equal(TABLE["sensor"], row["series"]))
        trend = fit_trend(mine["time"].to_numpy(), mine["value"].to_numpy())
        assert isinstance(trend, Trend)
        assert float(str(row["slope"])) == trend.parameters["slope"].value


@pytest.mark.parametrize("write", [as_csv, as_parquet, as_stream, as_file, as_json])
def test_the_format_of_the_input_is_told_by_its_content(table: Path, tmp_path: Path, write: object) -> None:
    source = tmp_path / "without_an_ending"
    source.write_bytes(write(TABLE))  # type: ignore[operator]
    expected = fit_many(table, "-o", "-", "--by", "sensor")
    assert fit_many(source, "-o", "-", "--by", "sensor").stdout == expected.stdout
    assert fit_many("-", "-o", "-", "--by", "sensor", stdin=source.read_bytes()).stdout == expected.stdout


def test_columns_and_arguments_are_options(tmp_path: Path) -> None:
    source = tmp_path / "in.csv"
    header = b"name;when;level\n"
    source.write_bytes(header + as_csv(TABLE).split(b"\n", 1)[1].replace(b",", b";"))
    output = tmp_path / "out.ndjson"
    named = ("--by", "name", "--time", "when", "--value", "level", "--time-unit", "s")
    result = fit_many(source, "-o", output, *named, "--method", "theil-sen", "--threshold", "2")
    assert result.exit_code == 0, result.output
    assert {row["threshold"] for row in rows_of(output)} == {2.0}
    assert {row["origin"] for row in rows_of(output)} == {0}


def test_points_label_every_row(table: Path, tmp_path: Path) -> None:
    output = tmp_path / "out.csv"
    assert fit_many(table, "-o", output, "--by", "sensor", "--points").exit_code == 0
    rows = rows_of(output)
    assert sorted(int(str(row["row"])) for row in rows) == list(range(TABLE.num_rows))
    assert {row["reason"] for row in rows} == {"ok", "outlier"}


def test_positions_become_a_map(tmp_path: Path) -> None:
    source, output = tmp_path / "in.parquet", tmp_path / "out.geojson"
    places = {
        "north": pa.array(np.full(TABLE.num_rows, 47.5)),
        "east": pa.array(np.full(TABLE.num_rows, 8.5)),
    }
    placed = TABLE.append_column("north", places["north"]).append_column("east", places["east"])
    source.write_bytes(as_parquet(placed))
    named = ("--by", "sensor", "--lat", "north", "--lon", "east")
    assert fit_many(source, "-o", output, *named).exit_code == 0
    features = json.loads(output.read_text())["features"]
    assert [feature["geometry"]["coordinates"] for feature in features] == [[8.5, 47.5]] * 5


def test_a_map_without_positions_is_refused_and_nothing_is_written(table: Path, tmp_path: Path) -> None:
    output = tmp_path / "out.geojson"
    assert "lat and lon" in error_of(fit_many(table, "-o", output, "--by", "sensor"))
    assert [path.name for path in tmp_path.iterdir()] == ["in.csv"]


def test_series_without_a_trend_are_counted(tmp_path: Path) -> None:
    source, output = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_bytes(as_csv(TABLE) + b"lonely,1,1\n")
    result = fit_many(source, "-o", output, "--by", "sensor")
    assert result.exit_code == 0
    assert result.stderr == f"Wrote 6 series to {output}, 1 of them without a trend.\n"


def test_no_trend_at_all_is_written_and_ends_with_1(tmp_path: Path) -> None:
    source, output = tmp_path / "in.csv", tmp_path / "out.csv"
    source.write_text("sensor,time,value\na,1,1\nb,1,1\n")
    assert "no series has a trend" in error_of(fit_many(source, "-o", output, "--by", "sensor"), code=1)
    assert [row["reason"] for row in rows_of(output)] == ["too_few_points"] * 2


def test_an_output_keeps_the_usual_permissions_and_replaces_what_was_there(
    table: Path, tmp_path: Path
) -> None:
    output = tmp_path / "out.csv"
    output.write_text("old")
    fit_many(table, "-o", output, "--by", "sensor")
    ordinary = tmp_path / "ordinary"
    ordinary.touch()
    assert stat.S_IMODE(output.stat().st_mode) == stat.S_IMODE(ordinary.stat().st_mode)
    assert len(rows_of(output)) == 5


WRONG = {
    "no such file": (["nowhere.csv", "-o", "out.csv", "--by", "sensor"], "No such file"),
    "a directory": ([".", "-o", "out.csv", "--by", "sensor"], "is a directory"),
    "an unknown ending": (["in.csv", "-o", "out.xlsx", "--by", "sensor"], "--output out.xlsx"),
    "no directory": (["in.csv", "-o", "nowhere/out.csv", "--by", "sensor"], "there is no directory nowhere"),
    "no such column": (["in.csv", "-o", "out.csv", "--by", "name"], "--by: the table has no column"),
    "an unknown method": (
        ["in.csv", "-o", "out.csv", "--by", "sensor", "--method", "magic"],
        "--method: must be one of",
    ),
    "a level of 2": (["in.csv", "-o", "out.csv", "--by", "sensor", "--level", "2"], "--level:"),
    "text as value": (
        ["in.csv", "-o", "out.csv", "--by", "time", "--time", "value", "--value", "sensor"],
        "the value column, row 0: expected a number",
    ),
    "a column in two roles": (["in.csv", "-o", "out.csv", "--by", "time"], "--time: this column has another"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_call_ends_with_one_sentence(
    table: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    arguments, told = WRONG[name]
    assert told in error_of(fit_many(*arguments))
    assert [path.name for path in tmp_path.iterdir()] == [table.name]


@pytest.mark.parametrize("content", [b"", b" \n", b"PAR1", b"ARROW1", b"\xff\xff\xff\xff", b"{", b"sensor\n"])
def test_a_broken_input_ends_with_one_sentence(tmp_path: Path, content: bytes) -> None:
    source = tmp_path / "in"
    source.write_bytes(content)
    error_of(fit_many(source, "-o", tmp_path / "out.csv", "--by", "sensor"))


def test_a_terminal_sees_a_bar_and_the_output_is_the_same(table: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "service.cli", "fit-many", str(table), "--by", "sensor", "-o"]
    control, terminal = pty.openpty()
    with subprocess.Popen(
        [*command, str(tmp_path / "seen.csv")],
        cwd=ROOT,
        env=os.environ | {"TERM": "xterm", "COLUMNS": "200"},
        stderr=terminal,
    ) as process:
        os.close(terminal)
        shown = b""
        try:
            while piece := os.read(control, 4096):
                shown += piece
        except OSError:
            pass  # How a terminal ends on Linux.
        assert process.wait(timeout=120) == 0
    os.close(control)
    assert b"Fitting" in shown
    fit_many(table, "-o", tmp_path / "unseen.csv", "--by", "sensor")
    assert (tmp_path / "seen.csv").read_bytes() == (tmp_path / "unseen.csv").read_bytes()


def test_every_question_of_a_single_fit_can_be_asked_of_many(tmp_path: Path) -> None:
    rows = np.arange(60.0)
    value = 0.2 * rows + 4.0 * np.sin(2.0 * np.pi * rows / 12.0) + np.random.default_rng(4).normal(size=60)
    source, output = tmp_path / "in.csv", tmp_path / "out.ndjson"
    source.write_bytes(as_csv(pa.table({"sensor": ["a"] * 60, "time": rows, "value": value})))
    asked = ("--model", "linear", "--degree", 2, "--seasonal", 12, "--harmonics", 1, "--reach", 40)
    made = ("--uncertainty", "bootstrap", "--resamples", 99, "--horizon", 300, "--noise", "auto")
    result = fit_many(source, "-o", output, "--by", "sensor", *asked, *made)
    assert result.exit_code == 0, result.output
    (row,) = rows_of(output)
    trend = fit_trend(
        rows,
        value,
        model="linear",
        degree=2,
        seasonal=[12.0],
        harmonics=1,
        reach=[40.0],
        horizon=300.0,
        uncertainty="bootstrap",
        options=RobustOptions(resamples=99),
    )
    assert isinstance(trend, Trend)
    for name, estimate in trend.parameters.items():
        assert (row[name], row[f"{name}_low"]) == (estimate.value, estimate.low)
    assert row["model"] == "linear"
    assert row["crossing_1_time"] == trend.crossings[0].time
    assert row["crossing_1_probability"] == trend.crossings[0].probability


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--reach", 40, "--horizon", "soon"), "--horizon 'soon': the times of the table are plain numbers"),
        (("--horizon", 40), "--horizon: is for values to reach"),
        (("--harmonics", 2), "--harmonics: goes with seasonal"),
        (("--resamples", 3), "--resamples: Input should be greater than or equal to 99"),
        (("--seasonal", "fortnight"), "--seasonal: Input should be"),
    ],
)
def test_a_question_that_makes_no_sense_ends_with_a_sentence(
    table: Path, tmp_path: Path, arguments: tuple[object, ...], sentence: str
) -> None:
    result = fit_many(table, "-o", tmp_path / "out.csv", "--by", "sensor", *arguments)
    assert sentence in " ".join(error_of(result).split())


def test_a_series_of_one_row_is_a_row_with_its_reason(tmp_path: Path) -> None:
    source, output = tmp_path / "in.parquet", tmp_path / "out.parquet"
    count = 5_000
    source.write_bytes(
        as_parquet(pa.table({"sensor": range(count), "time": [0.0] * count, "value": [1.0] * count}))
    )
    result = fit_many(source, "-o", output, "--by", "sensor")
    assert "no series has a trend" in error_of(result, code=1)
    rows = rows_of(output)
    assert len(rows) == count
    assert {row["reason"] for row in rows} == {"too_few_points"}
