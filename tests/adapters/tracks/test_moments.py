import datetime as dt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.adapters.tracks.moments import parse_moments
from estimators.arrays import InputError

ZONES = st.integers(-14 * 60, 14 * 60).map(lambda minutes: dt.timezone(dt.timedelta(minutes=minutes)))


@given(st.lists(st.datetimes(dt.datetime(1700, 1, 1), dt.datetime(2200, 1, 1), timezones=ZONES), min_size=1))
def test_times_with_zones_are_what_python_reads(times: list[dt.datetime]) -> None:
    moments, offsets, unreadable = parse_moments([time.isoformat() for time in times])
    expected = [time.astimezone(dt.UTC).replace(tzinfo=None) for time in times]
    assert moments.astype("datetime64[us]").tolist() == expected
    assert offsets.tolist() == [round(time.utcoffset().total_seconds() / 60) for time in times]  # type: ignore[union-attr]
    assert not unreadable.any()


@given(st.lists(st.text(max_size=60)))
def test_any_text_is_a_time_or_missing_or_unreadable(texts: list[str]) -> None:
    moments, offsets, unreadable = parse_moments(texts)
    assert moments.shape == offsets.shape == unreadable.shape == (len(texts),)
    assert not unreadable[~np.isnat(moments)].any()


@pytest.mark.parametrize(
    ("texts", "expected"),
    [
        (["03/04/2021 10:00", "31/04/2021", "13/04/2021"], ["2021-04-03T10:00", "NaT", "2021-04-13T00:00"]),
        (["03/04/2021", "03/14/2021"], ["2021-03-04", "2021-03-14"]),
        (["2008/12/11 04:42:14.5+00"], ["2008-12-11T04:42:14.5"]),
        (["2016-12-31 23:59:60 UTC"], ["2017-01-01T00:00:00"]),
    ],
)
def test_usual_forms_that_are_not_iso_are_read(texts: list[str], expected: list[str]) -> None:
    moments, _, _ = parse_moments(texts)
    np.testing.assert_array_equal(moments, np.array(expected, dtype="datetime64[ns]"))


def test_days_that_cannot_be_told_from_months_are_refused() -> None:
    with pytest.raises(InputError, match="days cannot be told from months"):
        parse_moments(["03/04/2021", "05/06/2021"])
