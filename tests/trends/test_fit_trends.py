"""``fit_trends``: what goes in, what comes out, and how it is followed and ended."""

from __future__ import annotations

import json
import threading
from typing import Any

import numpy as np
import pandas as pd
import pytest

from estimators import InputError, NoFit, Trend, fit_trends, methods, models
from estimators.consensus.cancellation import Cancelled, cancelled_by
from tests.trends.batches import assert_equal, assert_row, assert_same_as_alone
from tests.trends.contaminated import contaminated, fitted


def batch(count: int, n: int = 40) -> tuple[np.ndarray, np.ndarray]:
    """Common times and values of shape (count, n)."""
    t = np.arange(float(n))
    return t, np.array([0.1 * k * t + contaminated(n, 0.2, k, slope=0.0).y for k in range(count)])


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("values", {"values": ["a", "b", "c", "d"]}),
        ("values", {"values": [True, False, True, True]}),
        ("values", {"values": [[1.0, 2.0], [3.0]], "offsets": None}),
        ("offsets", {"offsets": None}),
        ("offsets", {"offsets": [0, 3]}),
        ("offsets", {"offsets": [1, 4]}),
        ("offsets", {"offsets": [0, 3, 2, 4]}),
        ("offsets", {"offsets": []}),
        ("offsets", {"offsets": [0.0, 4.0]}),
        ("t", {"t": [0.0, 1.0]}),
        ("t", {"t": ["2024-01-01"] * 4}),
        ("t", {"t": [True] * 4}),
        ("weights", {"weights": [1.0]}),
        ("weights", {"weights": ["a"] * 4}),
        ("names", {"names": ["a"]}),
        ("names", {"names": ["a", "a"]}),
        ("names", {"names": [1, 2]}),
        ("threads", {"threads": 0}),
        ("threads", {"threads": 1.5}),
        ("threads", {"threads": True}),
        ("method", {"method": "ransack"}),
        ("model", {"model": "circle"}),
        ("level", {"level": 1.0}),
        ("seed", {"seed": -1}),
        ("threshold", {"threshold": 0.0}),
        ("sigma", {"sigma": np.nan}),
        ("options", {"options": {}}),
        ("uncertainty", {"uncertainty": "none of them"}),
        ("weights", {"weights": [1.0] * 4, "method": "theil-sen"}),
    ],
)
def test_an_argument_that_cannot_be_used_is_named(field: str, arguments: dict[str, Any]) -> None:
    usual: dict[str, Any] = {"t": [0.0, 1.0, 0.0, 1.0], "values": [1.0, 2.0, 3.0, 4.0], "offsets": [0, 2, 4]}
    given = usual | arguments
    with pytest.raises(InputError) as caught:
        fit_trends(given.pop("t"), given.pop("values"), given.pop("offsets"), **given)
    assert caught.value.field == field


@pytest.mark.parametrize("name", ["predict", "y", "colour"])
def test_an_argument_that_is_none_is_refused_as_python_does(name: str) -> None:
    with pytest.raises(TypeError, match=name):
        fit_trends([0.0, 1.0], [[1.0, 2.0]], **{name: 1})


def test_settings_are_looked_at_even_without_series() -> None:
    assert len(fit_trends([], [], [0])) == 0
    with pytest.raises(InputError, match="level"):
        fit_trends([], [], [0], level=2.0)


def test_a_series_with_unusable_values_has_a_reason_and_the_others_are_answered() -> None:
    t, values = batch(4)
    values[1, 7] = 1e70
    weights = np.ones_like(values)
    weights[2, 3] = -1.0
    table = fit_trends(t, values, weights=weights)
    assert table.fitted.tolist() == [True, False, False, True]
    assert table.reason == ("", "invalid_input", "invalid_input", "")
    assert "row 7" in table.message[1]
    assert "weights" in table.message[2]
    assert isinstance(table[1], NoFit)


@pytest.mark.parametrize(
    ("t", "y", "reason"),
    [
        ([], [], "no_data"),
        ([3.0], [1.0], "too_few_points"),
        ([2.0, 2.0, 2.0], [1.0, 2.0, 3.0], "constant_time"),
        ([1.0, 2.0, 3.0], [np.nan] * 3, "no_data"),
    ],
)
def test_a_series_that_holds_no_line_says_why(t: list[float], y: list[float], reason: str) -> None:
    good_t, good_y = np.arange(9.0), 2.0 * np.arange(9.0)
    times, values = np.concatenate([good_t, t, good_t]), np.concatenate([good_y, y, good_y])
    table = fit_trends(times, values, [0, 9, 9 + len(t), 18 + len(t)])
    assert table.reason == ("", reason, "")
    assert table.message[1].endswith(".")


def test_a_hundred_thousand_series_of_one_point_are_answered() -> None:
    count = 100_000
    table = fit_trends(np.arange(float(count)), np.ones(count), np.arange(count + 1))
    assert set(table.reason) == {"too_few_points"}
    assert_same_as_alone(fit_trends([4.0], [1.0], [0, 1]), np.array([4.0]), np.array([1.0]), np.array([0, 1]))


def test_other_models_and_uncertainties_are_fitted_one_by_one() -> None:
    t, values = batch(3)
    table = fit_trends(t, values, uncertainty="hac")
    for k, row in enumerate(values):
        alone = fitted(t, row, uncertainty="hac")
        assert_row(table, k, alone)
        assert_equal(table[k], alone)


@pytest.mark.parametrize("model", list(models()))
def test_every_model_is_fitted_with_the_parameters_it_has(model: str) -> None:
    t, values = batch(3)
    table = fit_trends(t, 60.0 + values, model=model)
    for k, row in enumerate(60.0 + values):
        alone = fitted(t, row, model=model)
        assert set(alone.parameters) <= set(table.parameters)
        assert all(table.parameters[name].value[k] == one.value for name, one in alone.parameters.items())
    assert not any(np.isnan(one.value).all() for one in table.parameters.values())


def test_named_arguments_at_their_defaults_change_nothing() -> None:
    t, values = batch(3)
    assert fit_trends(t, values, uncertainty="effective-n").to_dict() == fit_trends(t, values).to_dict()


def test_pandas_columns_are_taken() -> None:
    values = batch(3, 30)[1]
    times = pd.date_range("2024-01-01", periods=90, freq="h", tz="Europe/Berlin")
    frame = pd.DataFrame({"time": times, "value": values.ravel()})
    table = fit_trends(frame["time"], frame["value"], pd.Series([0, 30, 60, 90]))
    assert_row(table, 1, fitted(frame["time"][30:60], frame["value"][30:60]))
    assert table.origin.dtype == np.dtype("datetime64[ns]")


def test_a_table_is_read_by_number_from_both_ends() -> None:
    t, values = batch(3)
    table = fit_trends(t, values)
    assert_equal(table[-1], table[2])
    assert [isinstance(one, Trend) for one in table] == [True] * 3
    for k in (3, -4):
        with pytest.raises(IndexError, match="3 series"):
            table[k]


def test_a_frame_has_a_row_per_series() -> None:
    t, values = batch(3)
    values[1] = np.nan
    frame = fit_trends(t, values, names=["a", "b", "c"]).to_frame()
    assert frame.index.tolist() == ["a", "b", "c"]
    assert frame["slope"].notna().tolist() == [True, False, True]
    assert frame.loc["b", "reason"] == "no_data"
    assert frame.loc["b", "notices"] == "missing_values"
    assert (frame["slope_low"] < frame["slope"]).tolist() == [True, False, True]
    assert fit_trends(t, values).to_frame().index.tolist() == [0, 1, 2]


@pytest.mark.parametrize("dated", [False, True])
def test_a_dict_is_json_with_null_where_there_is_nothing(dated: bool) -> None:
    t, values = batch(3)
    values[1] = np.inf
    times: Any = np.datetime64("2024-01-01", "s") + t.astype("timedelta64[h]") if dated else t
    answer = json.loads(json.dumps(fit_trends(times, values).to_dict(points=True), allow_nan=False))
    assert answer["fitted"] == [True, False, True]
    assert answer["origin"] == (
        ["2024-01-01T00:00:00Z", None, "2024-01-01T00:00:00Z"] if dated else [0.0, None, 0.0]
    )
    assert answer["parameters"]["slope"]["value"][1] is None
    assert answer["points"]["offsets"] == [0, 40, 80, 120]
    assert answer["points"]["reason"][40] == "invalid"


@pytest.mark.parametrize("method", ["auto", "msac", "ols"])
def test_rows_that_are_not_kept_change_no_number(method: str) -> None:
    t, values = batch(5)
    values[2, 3] = np.nan
    kept, bare = (fit_trends(t, values, method=method, threshold=4.0, points=keep) for keep in (True, False))
    assert bare.to_dict() == kept.to_dict()
    with pytest.raises(InputError, match="points=True"):
        _ = bare.points


@pytest.mark.parametrize("threads", [1, 2])
def test_progress_is_told_from_the_calling_thread(threads: int) -> None:
    count = 3000
    told: list[tuple[int, int, int]] = []
    values = np.tile(2.0 * np.arange(5.0), (count, 1))
    fit_trends(
        np.arange(5.0),
        values,
        method="msac",
        threshold=1.0,
        threads=threads,
        progress=lambda done, total: told.append((done, total, threading.get_ident())),
    )
    done, totals, threads_told = zip(*told, strict=True)
    assert list(done) == sorted(set(done))
    assert (done[-1], set(totals), set(threads_told)) == (count, {count}, {threading.get_ident()})
    assert len(done) > 1


@pytest.mark.parametrize("threads", [1, 2])
def test_an_exception_from_progress_ends_the_work(threads: int) -> None:
    told = []

    def stop(done: int, total: int) -> None:
        told.append((done, total))
        raise KeyboardInterrupt

    values = np.tile(2.0 * np.arange(5.0), (5000, 1))
    with pytest.raises(KeyboardInterrupt):
        fit_trends(np.arange(5.0), values, method="msac", threshold=1.0, threads=threads, progress=stop)
    assert len(told) == 1


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("method", ["auto", "msac", "ols"])
def test_the_callers_flag_ends_the_work_in_every_thread(method: str, threads: int) -> None:
    t, values = batch(2000, 12)
    flag = np.zeros(1, dtype=np.uint8)

    def cancel(done: int, total: int) -> None:
        assert 0 < done <= total
        flag[0] = 1

    with cancelled_by(flag), pytest.raises(Cancelled):
        fit_trends(t, values, method=method, threshold=4.0, threads=threads, progress=cancel)


@pytest.mark.parametrize("method", list(methods()))
def test_every_method_fits_many(method: str) -> None:
    t, values = batch(3)
    assert fit_trends(t, values, method=method).fitted.all()


def test_the_input_is_not_changed() -> None:
    t, values = batch(4)
    values[1, 5] = np.nan
    values[2] = values[2, ::-1]
    kept = t.copy(), values.copy()
    fit_trends(t, values, weights=np.ones_like(values))
    np.testing.assert_array_equal(t, kept[0])
    np.testing.assert_array_equal(values, kept[1])
