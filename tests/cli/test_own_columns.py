"""``plumbline fit --column``: further columns of the model linear."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from estimators import RobustOptions, fit_trend
from service.cli import app

ROWS = np.arange(40)
HEAT = np.sin(1.7 * ROWS).round(6)
WIND = (ROWS % 7).astype(float)
VALUE = (3.0 + 0.5 * ROWS + 2.0 * HEAT + 0.1 * np.random.default_rng(2).normal(size=40)).round(6)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "river.csv"
    columns = zip(ROWS.tolist(), HEAT.tolist(), WIND.tolist(), VALUE.tolist(), strict=True)
    path.write_text("hour,heat,wind,level\n" + "".join(f"{t},{h},{w},{y}\n" for t, h, w, y in columns))
    return path


def fit(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["fit", *map(str, arguments)])


def test_columns_are_named_and_are_no_guess_for_the_value(table: Path) -> None:
    result = fit(table, "--json", "--model", "linear", "--column", "heat", "--column", 3, "--since", 5)
    trend = fit_trend(ROWS[5:], VALUE[5:], model="linear", columns={"heat": HEAT[5:], "wind": WIND[5:]})
    assert json.loads(result.stdout) == json.loads(json.dumps(trend.to_dict()))
    assert "value from column 'level'" in " ".join(result.stderr.split())


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--column", "cold"), "there is no column 'cold' for --column"),
        (("--column", "heat", "--column", "heat"), "column 'heat' has another role already"),
        (("--column", "heat", "--value", "heat"), "column 'heat' has another role already"),
        (("--column", "heat", "--model", "line"), "--column: has no meaning for the model line"),
    ],
)
def test_columns_that_cannot_be_used_end_with_a_sentence(
    table: Path, arguments: tuple[object, ...], sentence: str
) -> None:
    result = fit(table, "--model", "linear", *arguments)
    assert result.exit_code == 2
    assert sentence in " ".join(result.stderr.split())


def test_the_help_tells_how_often_the_library_fits_again() -> None:
    shown = " ".join(CliRunner().invoke(app, ["fit", "--help"], env={"COLUMNS": "300"}).stdout.split())
    assert f"fit again. Default: {RobustOptions().resamples}." in shown
