"""``plumbline fit --regime --reach --horizon``."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import estimators
from service.cli import app

ROWS = np.arange(120)
LEVEL = (
    np.where(ROWS < 70, 0.5 * ROWS, 0.25 * (ROWS - 70)) + np.random.default_rng(1).normal(size=120)
).round(3)


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "disk.csv"
    path.write_text(
        "hour,used\n" + "".join(f"{t},{y}\n" for t, y in zip(ROWS.tolist(), LEVEL.tolist(), strict=True))
    )
    return path


def fit(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["fit", *map(str, arguments)])


def test_the_present_regime_and_the_time_to_a_value_are_told(table: Path) -> None:
    result = fit(table, "--regime", "last", "--reach", 30, "--horizon", 200)
    told = " ".join(result.stdout.split())
    assert "Regimes 2; the present one since 70; before: 0 to 69, slope 0.49" in told
    assert "Reaches 30 1" in told
    assert "by 200 with probability" in told


def test_the_json_is_what_the_library_answers(table: Path) -> None:
    printed = json.loads(
        fit(table, "--json", "--regime", "last", "--reach", 30, "--reach", 1, "--horizon", 200).stdout
    )
    trend = estimators.fit_trend(ROWS, LEVEL, regime="last", reach=[30.0, 1.0], horizon=200)
    assert printed == json.loads(json.dumps(trend.to_dict()))


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--reach", 30, "--horizon", 5), "--horizon: must not lie before the last time of the data."),
        (("--horizon", 200), "--horizon: is for values to reach; give them in reach."),
        (("--reach", 30, "--horizon", "soon"), "--horizon 'soon'"),
        (("--reach", "nan"), "--reach: must be finite"),
    ],
)
def test_a_question_that_cannot_be_asked_ends_with_a_sentence(
    table: Path, arguments: tuple[object, ...], sentence: str
) -> None:
    result = fit(table, *arguments)
    assert result.exit_code == 2
    assert sentence in result.stderr
