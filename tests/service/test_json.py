from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.codecs.columns import Columns, TimeForm
from service.codecs.json import read_json
from service.codecs.limits import check_columns
from service.errors import Problem
from service.schemas.options import FitArguments, TrendQuery
from tests.service.series import attempt

FINITE = st.floats(allow_nan=False, allow_infinity=False)
INT64 = st.integers(-(2**63), 2**63 - 1)


def read(**fields: object) -> tuple[Columns, FitArguments]:
    return read_json(json.dumps(fields).encode(), TrendQuery())


@given(st.lists(st.one_of(st.none(), FINITE), min_size=1, max_size=30))
def test_values_arrive_bit_by_bit_with_null_as_nan(values: list[float | None]) -> None:
    columns, _ = read(time=list(range(len(values))), value=values)
    expected = np.array([np.nan if value is None else value for value in values])
    assert columns.value.tobytes() == expected.tobytes()


@given(st.lists(INT64, min_size=1, max_size=30))
def test_integer_times_stay_integers(times: list[int]) -> None:
    columns, _ = read(time=times, value=[0.0] * len(times))
    assert columns.time.dtype == np.int64
    assert columns.time.tolist() == times


@given(st.lists(st.integers(-(9 * 10**18), 9 * 10**18), min_size=1, max_size=10))
def test_epoch_nanoseconds_are_exact_in_and_out(times: list[int]) -> None:
    columns, _ = read(time=times, value=[0.0] * len(times), time_unit="ns")
    assert columns.time.astype("datetime64[ns]").astype(np.int64).tolist() == times
    assert list(columns.form.render(columns.time)) == times


@pytest.mark.parametrize(("unit", "number"), [("s", 1.5), ("ms", 1500), ("us", 1.5e6), ("ns", 1_500_000_000)])
def test_epoch_numbers_are_read_in_their_unit(unit: str, number: float) -> None:
    columns, _ = read(time=[number], value=[0.0], time_unit=unit)
    assert columns.time[0] == np.datetime64("1970-01-01T00:00:01.5", "ns")
    assert columns.form == TimeForm("epoch", unit)  # type: ignore[arg-type]


@given(st.integers(-(2**31), 2**31), st.integers(0, 999_999))
def test_fractional_epoch_seconds_lose_no_more_than_their_own_rounding(whole: int, micro: int) -> None:
    number = whole + micro / 1e6
    columns, _ = read(time=[number], value=[0.0], time_unit="s")
    exact = int(np.floor(number)) * 10**9 + round((number - np.floor(number)) * 1e9)
    assert int(columns.time.astype("datetime64[ns]").astype(np.int64)[0]) == exact


def test_missing_times_are_taken_in_every_form() -> None:
    for times, unit in (
        ([1, None], None),
        ([1.5, None], "s"),
        ([1, None], "ms"),
        (["2024-01-01", None], None),
    ):
        columns, _ = read(time=times, value=[0.0, 0.0], **({"time_unit": unit} if unit else {}))
        rendered = columns.form.render(columns.time)
        assert np.isnan(columns.time).tolist() == [False, True]
        assert rendered[1] is None or np.isnan(rendered[1])


def test_epoch_nanoseconds_stay_exact_beside_missing_times() -> None:
    times = [1_714_564_800_000_000_001, None, 1_714_564_800_000_000_003]
    columns, _ = read(time=times, value=[0.0] * 3, time_unit="ns")
    assert list(columns.form.render(columns.time)) == times


def test_weights_and_prediction_times_are_read() -> None:
    columns, _ = read(time=[0, 1], value=[0.0, 1.0], weight=[1, 2.5], predict=[2, 3])
    assert columns.weight is not None
    assert columns.predict is not None
    assert columns.weight.tolist() == [1.0, 2.5]
    assert columns.predict.tolist() == [2, 3]


def test_optional_columns_may_be_null() -> None:
    columns, _ = read(time=[0, 1], value=[0.0, 1.0], weight=None, predict=None)
    assert columns.weight is None
    assert columns.predict is None


def test_arguments_default_and_nest() -> None:
    _, arguments = read(time=[0], value=[0.0], level=0.9, options={"confidence": 0.5})
    assert (arguments.level, arguments.options.confidence, arguments.seed) == (0.9, 0.5, 0)


@pytest.mark.parametrize("value", [b"[1,2,3]", b'{"a":[1]}', b"[[[[]]]]", b"null", b"7", b"[1,", b"{", b'"'])
@pytest.mark.parametrize("field", ["time", "value", "weight", "predict", "options", "level", "model"])
def test_a_field_of_another_shape_is_a_problem_of_that_field(field: str, value: bytes) -> None:
    body = b'{"time":[1,2],"value":[1,2]}'
    fields = json.loads(body)
    fields.pop(field, None)
    text = json.dumps(fields).encode()[:-1] + b',"' + field.encode() + b'":' + value + b"}"
    outcome = attempt(lambda: check_columns(read_json(text, TrendQuery())[0], 100))
    if isinstance(outcome, Problem):
        assert outcome.kind.status in (400, 422)
    else:
        assert (field, value) in {("weight", b"null"), ("predict", b"null"), ("predict", b"[1,2,3]")}


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(body: bytes) -> None:
    with pytest.raises(Problem) as caught:
        read_json(body, TrendQuery())
    assert caught.value.kind.status in (400, 422)


@given(st.binary(max_size=40), st.integers(0, 60), st.integers(0, 20))
def test_a_damaged_body_is_read_or_refused(noise: bytes, start: int, length: int) -> None:
    whole = b'{"time": ["2024-01-01", null], "value": [1.5, null], "options": {"confidence": 0.9}}'
    damaged = whole[:start] + noise + whole[start + length :]
    outcome = attempt(lambda: read_json(damaged, TrendQuery())[0])
    if isinstance(outcome, Problem):
        assert outcome.kind.status in (400, 422)
    else:
        assert outcome.time.ndim == 1
