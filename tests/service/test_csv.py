from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators import Trend, fit_trend
from service.codecs.columns import Columns, TimeForm
from service.codecs.csv import HEADER, read_csv, write_csv
from service.errors import Problem
from service.schemas.options import AnswerQuery, TrendQuery
from tests.service.series import attempt, contaminated

FINITE = st.floats(allow_nan=False, allow_infinity=False)


def read(text: str, **query: object) -> Columns:
    columns, _ = read_csv(text.encode(), TrendQuery.model_validate(query))
    return columns


@given(st.lists(FINITE, min_size=1, max_size=30))
def test_values_arrive_bit_by_bit(values: list[float]) -> None:
    columns = read("time,value\n" + "".join(f"{k},{value!r}\n" for k, value in enumerate(values)))
    assert columns.value.tobytes() == np.array(values).tobytes()


@pytest.mark.parametrize("cell", ["", "NA", "nan", "NaN", "null", "None", " ", "n/a"])
def test_the_usual_spellings_of_not_available_are_missing(cell: str) -> None:
    columns = read(f"time,value\n1,{cell}\n2,7\n")
    assert np.isnan(columns.value).tolist() == [True, False]


@pytest.mark.parametrize(
    "cell", ["inf", "-Infinity", "1e999", "1_000", "0x10", "١", "1,5", "true", "--1", "1e"]
)
def test_a_cell_that_is_no_number_is_refused_with_its_row(cell: str) -> None:
    with pytest.raises(Problem) as caught:
        read(f'time,value\n1,2\n2,"{cell}"\n')
    assert (caught.value.errors[0].field, caught.value.errors[0].row) == ("value", 1)


def test_columns_are_found_by_name_in_any_order() -> None:
    columns = read(
        "w,Mean,Year\n1,0.5,1970\n2,0.6,1971\n", time_column="Year", value_column="Mean", weight_column="w"
    )
    assert columns.time.tolist() == [1970, 1971]
    assert columns.value.tolist() == [0.5, 0.6]
    assert columns.weight is not None
    assert columns.weight.tolist() == [1.0, 2.0]


def test_a_column_named_weight_is_used() -> None:
    assert read("time,value,weight\n1,2,3\n").weight is not None
    assert read("time,value\n1,2\n").weight is None


def test_quotes_blanks_byte_order_marks_and_windows_line_ends_are_taken() -> None:
    columns = read('\ufeff"time", value\r\n"1", 2.5\r\n\r\n 2 ,"3.5"\r\n')
    assert (columns.time.tolist(), columns.value.tolist()) == ([1, 2], [2.5, 3.5])


def test_times_may_be_iso_text_or_epoch_numbers() -> None:
    iso = read("time,value\n2024-05-01T14:00+02:00,1\n,2\n")
    assert iso.form == TimeForm("iso")
    assert np.isnan(iso.time).tolist() == [False, True]
    epoch = read("time,value\n1714564800000000001,1\nNA,2\n", time_unit="ns")
    assert int(epoch.time.astype("datetime64[ns]").astype(np.int64)[0]) == 1714564800000000001


def test_prediction_times_are_repeated_or_separated_by_commas() -> None:
    columns = read("time,value\n1,2\n", predict=["3,4", "5"])
    assert columns.predict is not None
    assert columns.predict.tolist() == [3, 4, 5]


@given(st.binary(max_size=100))
def test_any_bytes_are_read_or_refused(body: bytes) -> None:
    with pytest.raises(Problem) as caught:
        read_csv(body, TrendQuery())
    assert caught.value.kind.status in (400, 422)


@given(st.text("time,value\n0123456789-:TZ .eE+\"'\0", max_size=80))
def test_any_table_is_read_or_refused(rows: str) -> None:
    outcome = attempt(lambda: read("time,value\n" + rows))
    if isinstance(outcome, Problem):
        assert outcome.kind.status in (400, 422)
    else:
        assert outcome.time.size == outcome.value.size


@pytest.fixture(scope="module")
def table() -> tuple[Trend, Columns, list[dict[str, str]]]:
    times, values = contaminated()
    values[5] = np.nan
    columns = Columns(np.array(times), np.array(values), None, None, TimeForm("number"))
    trend = fit_trend(columns.time, columns.value)
    assert isinstance(trend, Trend)
    text = write_csv(trend, columns, AnswerQuery()).decode()
    return trend, columns, list(csv.DictReader(io.StringIO(text)))


def test_the_answer_has_one_row_per_input_row(table: tuple[Trend, Columns, list[dict[str, str]]]) -> None:
    _, columns, rows = table
    assert len(rows) == columns.time.size
    assert tuple(rows[0]) == HEADER


def test_the_answer_reads_back_as_the_same_numbers(
    table: tuple[Trend, Columns, list[dict[str, str]]],
) -> None:
    trend, columns, rows = table
    bands = trend.predict(columns.time)
    expected = {
        "time": columns.time,
        "value": columns.value,
        "fit": bands.value,
        "confidence_low": bands.confidence_low,
        "prediction_high": bands.prediction_high,
        "probability": trend.points.probability,
        "residual": trend.points.residual,
    }
    for name, column in expected.items():
        read_back = np.array([float(row[name]) if row[name] else np.nan for row in rows])
        np.testing.assert_array_equal(read_back, column)
    assert [row["inlier"] for row in rows] == [str(flag).lower() for flag in trend.points.inlier.tolist()]
    assert [row["reason"] for row in rows] == trend.points.reason


def test_a_missing_value_is_an_empty_cell(table: tuple[Trend, Columns, list[dict[str, str]]]) -> None:
    _, _, rows = table
    assert (rows[5]["value"], rows[5]["residual"], rows[5]["reason"]) == ("", "", "missing")
