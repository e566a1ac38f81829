from __future__ import annotations

import datetime as dt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.codecs.times import parse_iso
from service.errors import Problem
from tests.service.series import attempt

MOMENTS = st.builds(
    lambda moment, minutes: (
        moment if minutes is None else moment.replace(tzinfo=dt.timezone(dt.timedelta(minutes=minutes)))
    ),
    st.datetimes(dt.datetime(1678, 1, 2), dt.datetime(2261, 12, 30)),
    st.one_of(st.none(), st.integers(-23 * 60 - 59, 23 * 60 + 59)),
)


def nanoseconds(moment: dt.datetime) -> int:
    aware = moment.replace(tzinfo=dt.UTC) if moment.tzinfo is None else moment
    return (aware - dt.datetime(1970, 1, 1, tzinfo=dt.UTC)) // dt.timedelta(microseconds=1) * 1000


@given(st.lists(MOMENTS, min_size=1, max_size=20))
def test_iso_text_with_and_without_offsets_is_read_exactly(moments: list[dt.datetime]) -> None:
    parsed = parse_iso([moment.isoformat() for moment in moments], "time")
    assert parsed.astype(np.int64).tolist() == [nanoseconds(moment) for moment in moments]


@given(st.integers(-(9 * 10**18), 9 * 10**18), st.integers(0, 9))
def test_fractions_are_read_to_the_nanosecond(moment: int, digits: int) -> None:
    unit = 10 ** (9 - digits)
    rounded = moment // unit * unit
    text = str(np.datetime64(rounded, "ns"))
    text = text[: 20 + digits] if digits else text[:19]
    assert parse_iso([text + "Z"], "time").astype(np.int64)[0] == rounded


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("2024-02-29", "2024-02-29T00:00:00"),
        ("2024-05-01T14:00", "2024-05-01T14:00:00"),
        ("2024-05-01 14:00:00", "2024-05-01T14:00:00"),
        ("2024-05-01t14:00:00z", "2024-05-01T14:00:00"),
        ("2024-05-01T14:00:00+0200", "2024-05-01T12:00:00"),
        ("2024-05-01T14:00:00-02", "2024-05-01T16:00:00"),
        ("2024-05-01T14:00:00,5Z", "2024-05-01T14:00:00.5"),
        ("2000-03-01T00:30:00+01:00", "2000-02-29T23:30:00"),
    ],
)
def test_common_ways_to_write_a_time_are_read(text: str, expected: str) -> None:
    assert parse_iso([text], "time")[0] == np.datetime64(expected, "ns")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "tomorrow",
        "2024",
        "2024-13-01",
        "2024-00-01",
        "2023-02-29",
        "1900-02-29",
        "2024-04-31",
        "2024-05-01T24:00:00",
        "2024-05-01T12:60",
        "2024-06-30T23:59:60Z",
        "2024-05-01T12:00:00+24:00",
        "2024-05-01T12:00:00.1234567890",
        "2024-05-01T12:00:00Zulu",
        "2024-05-01\0",
        "2024-05-01" + "0" * 100,
        "２０２４-05-01",
        "1492-10-12",
        "2999-01-01",
        "20240501T120000Z",
    ],
)
def test_a_text_that_is_no_time_is_refused_with_its_row(text: str) -> None:
    with pytest.raises(Problem) as caught:
        parse_iso(["2024-05-01", None, text, "2024-05-02"], "time")
    assert (caught.value.errors[0].field, caught.value.errors[0].row) == ("time", 2)


def test_missing_times_stay_missing_and_rows_keep_their_places() -> None:
    parsed = parse_iso([None, "2024-05-01T00:00:00.25Z", None, "2024-05-01"], "time")
    assert np.isnat(parsed).tolist() == [True, False, True, False]
    assert parsed[1] - parsed[3] == np.timedelta64(250, "ms")


def test_the_first_bad_row_is_named_when_layouts_are_mixed() -> None:
    texts = ["2024-05-01", "2024-05-01T00:00Z", "x", "2024-05-01 00:00", "yy"]
    with pytest.raises(Problem) as caught:
        parse_iso(texts, "time")
    assert caught.value.errors[0].row == 2


@given(st.text(max_size=30))
def test_any_text_is_either_read_or_refused(text: str) -> None:
    outcome = attempt(lambda: parse_iso([text], "time"))
    if isinstance(outcome, Problem):
        assert outcome.errors[0].row == 0
    else:
        assert not np.isnat(outcome[0])
