from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.codecs.table import TableError, read_delimiter, read_table

FINITE = st.floats(allow_nan=False, allow_infinity=False)
ROWS = st.lists(st.tuples(FINITE, FINITE), min_size=2, max_size=30)


@given(ROWS, st.sampled_from(",;\t|"), st.booleans(), st.booleans())
def test_what_is_written_is_read_back_whatever_separates_it(
    rows: list[tuple[float, float]], delimiter: str, header: bool, quoted: bool
) -> None:
    text = io.StringIO()
    writer = csv.writer(text, delimiter=delimiter, quoting=csv.QUOTE_ALL if quoted else csv.QUOTE_MINIMAL)
    writer.writerows([("time", "value")] * header + rows)
    columns = read_table(text.getvalue().encode()).columns
    np.testing.assert_array_equal(columns.time, [time for time, _ in rows])
    np.testing.assert_array_equal(columns.value, [value for _, value in rows])


@given(st.binary(max_size=300) | st.text('0123456789-+.,;\t "#e\nNaT:Zx', max_size=300).map(str.encode))
def test_any_bytes_are_read_or_refused_in_a_sentence(body: bytes) -> None:
    try:
        columns = read_table(body).columns
    except TableError as refusal:
        sentence, rows = str(refusal), (0, 0)
    else:
        sentence, rows = "read", (columns.time.size, columns.value.size)
    assert sentence
    assert rows[0] == rows[1]


@pytest.mark.parametrize("cell", ["", "NA", "NaN", "nan", "null", "NULL", "None", "N/A", "#N/A", "  "])
def test_the_usual_spellings_of_nothing_are_missing(cell: str) -> None:
    values = read_table(f"time,value\n1,2\n2,{cell}\n3,4\n".encode()).columns.value
    np.testing.assert_array_equal(values, [2.0, np.nan, 4.0])


def test_missing_times_are_kept_as_missing() -> None:
    columns = read_table(b"time,value\n2024-05-01,2\n,3\n2024-05-03,4\n").columns
    assert np.isnat(columns.time).tolist() == [False, True, False]


def test_times_with_offsets_are_read_in_utc() -> None:
    times = read_table(
        b"time,value\n2024-05-01T02:00:00+02:00,1\n2024-05-01T00:00:01Z,2\n2024-05-01 00:00:02,3\n"
    ).columns.time
    assert (times - np.datetime64("2024-05-01")).astype(np.int64).tolist() == [0, 10**9, 2 * 10**9]


def test_a_month_is_its_first_day() -> None:
    times = read_table(b"month,value\n1958-03,315.71\n1958-04,317.45\n").columns.time
    assert times.astype("datetime64[D]").astype(str).tolist() == ["1958-03-01", "1958-04-01"]


def test_dates_without_hyphens_are_dates_and_that_is_told() -> None:
    table = read_table(b"day,value\n20240131,1\n20240201,2\n")
    assert table.columns.time.astype("datetime64[D]").astype(str).tolist() == ["2024-01-31", "2024-02-01"]
    assert "Read column 'day' as dates without hyphens." in table.remarks


def test_years_are_plain_numbers() -> None:
    table = read_table(b"Source,Year,Mean\nGISTEMP,1880,-0.17\nGISTEMP,1881,-0.09\n")
    assert table.columns.time.tolist() == [1880, 1881]
    assert table.columns.form.kind == "number"
    assert table.remarks == ("Took time from column 'Year', value from column 'Mean'.",)


def test_large_integer_times_stay_exact() -> None:
    times = read_table(b"time,value\n9007199254740993,1\n9007199254740995,2\n").columns.time
    assert times.tolist() == [9007199254740993, 9007199254740995]


def test_numbers_since_1970_become_points_in_time_in_their_unit() -> None:
    columns = read_table(b"t,v\n1700000000123,1\n1700000000456,2\n", time_unit="ms").columns
    assert str(columns.time[0]) == "2023-11-14T22:13:20.123000000"
    assert columns.form.unit == "ms"


def test_without_a_header_columns_go_by_position() -> None:
    table = read_table(b"x,1,10\ny,2,20\n", time="2", value="3")
    assert table.columns.value.tolist() == [10.0, 20.0]
    assert (table.time_name, table.value_name) == ("column 2", "column 3")


def test_a_column_that_only_numbers_the_rows_is_not_taken_for_the_time() -> None:
    table = read_table(b'"","when","level"\n"1",1960,0.7\n"2",1961,0.6\n')
    assert (table.time_name, table.value_name) == ("when", "level")


def test_a_column_of_dates_is_the_time_wherever_it_stands() -> None:
    table = read_table(b"level,day\n3.5,2024-05-01\n3.6,2024-05-02\n")
    assert (table.time_name, table.value_name) == ("day", "level")


def test_columns_asked_for_are_found_in_any_case() -> None:
    assert read_table(b"a,Year,MEAN\n5,1880,1\n6,1881,2\n", time="year", value="mean").value_name == "MEAN"


def test_a_column_called_weight_is_taken_as_in_the_service() -> None:
    weight = read_table(b"time,value,weight\n1,2,1\n2,3,0.5\n").columns.weight
    assert weight is not None
    assert weight.tolist() == [1.0, 0.5]


def test_semicolons_come_with_decimal_commas() -> None:
    assert read_table(b"Tag;Wert\n2024-05-01;1,5\n2024-05-02;-,25\n").columns.value.tolist() == [1.5, -0.25]


def test_runs_of_blanks_separate_cells_where_nothing_else_does() -> None:
    assert read_table(b"  1971.875   2.308\n  1972.31    3.55\n").columns.value.tolist() == [2.308, 3.55]


def test_comments_blank_lines_and_empty_cells_at_the_end_are_left_out() -> None:
    body = b"# station 7\n\ntime,value\n1,2,\n  # a gap\n2,3,,\n\n"
    assert read_table(body).columns.value.tolist() == [2.0, 3.0]


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "latin-1"])
def test_the_encodings_of_spreadsheets_are_read(encoding: str) -> None:
    table = read_table("Zeit\tTür\r\n1\t2\r\n2\t3\r\n".encode(encoding))
    assert table.value_name == "Tür"
    assert table.columns.value.tolist() == [2.0, 3.0]


def test_infinities_are_passed_on_to_be_labelled_invalid() -> None:
    assert read_table(b"time,value\n1,inf\n2,-Infinity\n3,1\n").columns.value.tolist() == [
        np.inf,
        -np.inf,
        1.0,
    ]


@pytest.mark.parametrize(
    ("body", "line", "column"),
    [
        (b"time,value\n1,2\n2,x\n3,4\n", 3, "'value'"),
        (b"# note\n\ntime,value\n1,2\n\n2,1_000\n3,4\n", 6, "'value'"),
        (b"time,value\n2024-05-01,2\n2024-05-32,3\n2024-06-01,3\n", 3, "'time'"),
        (b'time,note,value\n1,"two\nlines",2\n2,a,1e999\n3,a,4\n', 4, "'value'"),
        (b"time,value,weight\n1,2,1\n2,3,-1\n", 3, "'weight'"),
        (b"time,value\n1,2\n2,3,5\n", 3, None),
        (b"time,value\n1,2\n2\n", 3, None),
        (b'time,value\n1,2\n2,"3\n', 3, None),
    ],
)
def test_an_error_names_line_and_column(body: bytes, line: int, column: str | None) -> None:
    with pytest.raises(TableError) as caught:
        read_table(body)
    assert (caught.value.line, caught.value.column) == (line, column)
    assert f"line {line}" in str(caught.value)


@pytest.mark.parametrize(
    ("body", "what"),
    [
        (b"", "empty"),
        (b" \n ", "empty"),
        (b"# only this\n", "comments"),
        (b"PK\x03\x04rest", "Excel"),
        (b"\x1f\x8brest", "gzip"),
        (b"PAR1rest", "Parquet"),
        (b"1,2\0\n", "not text"),
        (b"one\n1\n2\n", "no column of numbers is left"),
        (b"who,what\na,b\nc,d\n", "no column holds times or numbers"),
    ],
)
def test_what_is_no_table_is_named(body: bytes, what: str) -> None:
    with pytest.raises(TableError, match=what):
        read_table(body)


def test_an_unknown_column_is_answered_with_the_columns_there_are() -> None:
    with pytest.raises(TableError, match=r"did you mean 'Year'\?\); the columns are: 'Year', 'Mean'"):
        read_table(b"Year,Mean\n1,2\n3,4\n", time="Yaer")


def test_a_name_given_twice_has_to_be_told_apart_by_position() -> None:
    with pytest.raises(TableError, match="--value 2 or --value 3"):
        read_table(b"t,v,v\n1,2,3\n4,5,6\n", value="v")
    assert read_table(b"t,v,v\n1,2,3\n4,5,6\n", value="3").columns.value.tolist() == [3.0, 6.0]


def test_one_column_cannot_be_time_and_value() -> None:
    with pytest.raises(TableError, match="cannot be both"):
        read_table(b"t,v\n1,2\n3,4\n", time="t", value="t")


def test_a_header_that_does_not_match_the_rows_is_not_trusted() -> None:
    body = b"Date,Decimal,Average\n1958-03,1958.2,315.7,314.4\n1958-04,1958.3,317.4,315.2\n"
    with pytest.raises(TableError, match="names 3 columns but the rows have 4"):
        read_table(body)
    assert read_table(body, time="1", value="3").columns.value.tolist() == [315.7, 317.4]


def test_a_time_unit_is_refused_for_dates() -> None:
    with pytest.raises(TableError, match="leave it out"):
        read_table(b"t,v\n2024-05-01,1\n2024-05-02,2\n", time_unit="s")


@pytest.mark.parametrize(("given", "meant"), [("tab", "\t"), ("\\t", "\t"), (";", ";"), ("space", " ")])
def test_delimiters_are_named_or_given(given: str, meant: str) -> None:
    assert read_delimiter(given) == meant


@pytest.mark.parametrize("given", ["", "ab", "x", "\n", '"'])
def test_what_cannot_separate_cells_is_refused(given: str) -> None:
    with pytest.raises(TableError):
        read_delimiter(given)
