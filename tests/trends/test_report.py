from __future__ import annotations

from html import escape
from html.parser import HTMLParser

import numpy as np
import pytest

from estimators.notices import NOTICE_MEANINGS, POSITION_NOTICES, TRACK_NOTICES, NoticeCode, notice
from estimators.presentation.text import WIDTH
from estimators.trends.presentation.layout import to_html, to_text
from estimators.trends.presentation.report import describe
from estimators.trends.trend import RunnerUp
from tests.trends.made import daily, made_trend

DAY = 86400.0


def yearly() -> np.ndarray:
    return np.array([f"{year}-01-01" for year in range(1990, 2020)], dtype="datetime64[ns]")


def flat(text: str) -> str:
    return " ".join(text.split())


def test_a_series_of_years_is_told_per_year_and_per_second() -> None:
    text = made_trend(yearly(), np.zeros(30), slope=0.02 / (365.25 * DAY), level=0.3).summary()
    assert "y = 0.300 + 0.0200 · (years since 1990-01-01)" in text
    assert "slope per year" in text
    assert "slope per second" in text


def test_a_series_of_days_is_told_per_day() -> None:
    text = made_trend(daily(10), np.zeros(10), slope=-1.5 / DAY, level=3.0).summary()
    assert "y = 3.000 - 1.500 · (days since 2024-01-01)" in text


def test_a_short_series_is_told_per_second_once() -> None:
    time = np.datetime64("2024-01-01", "ns") + np.arange(10) * np.timedelta64(1, "s")
    text = made_trend(time, np.zeros(10), slope=2.0, level=3.0).summary()
    assert text.count("slope per second") == 1


def test_plain_numbers_have_no_unit() -> None:
    text = made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0).summary()
    assert "y = 1.000 + 2.00 · t" in text
    assert "slope per" not in text
    assert "level at t = 0" in text


def test_far_from_zero_the_equation_is_told_amid_the_data() -> None:
    text = made_trend(np.arange(1970, 2021), np.zeros(51), slope=0.02, level=0.0).summary()
    assert "y = 0.500 + 0.0200 · (t - 1995)" in text
    assert "level at t = 0 " in text
    assert "level at t = 1995 " in text


def test_columns_give_the_equation_its_names() -> None:
    trend = made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0)
    assert describe(trend, time_name="day", value_name="level").equation == "level = 1.000 + 2.00 · day"


def test_the_slope_comes_with_error_interval_and_p_value() -> None:
    row = describe(made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0)).estimates[0]
    # stderr 0.1, Student's t with 8 degrees of freedom: 2.306.
    assert (row.value, row.stderr, row.interval, row.p_value) == ("2.00", "0.10", "[1.77, 2.23]", "3.2e-07")


def test_without_redundancy_there_is_no_error_to_tell() -> None:
    report = describe(made_trend([0.0, 1.0], [1.0, 3.0], slope=2.0, level=1.0, dof=None))
    row = report.estimates[0]
    assert (row.value, row.stderr, row.interval, row.p_value) == ("2", "–", "–", "–")
    assert dict(report.facts)["Intervals"].startswith("none")


def test_inliers_rows_left_out_noise_and_threshold_are_told() -> None:
    facts = dict(
        describe(
            made_trend(range(5), [1.0, 2.0, np.nan, 40.0, 5.0], slope=1.0, level=1.0, outliers=(3,))
        ).facts
    )
    assert facts["Points"] == "3 of 4 follow the trend (75.0 %); 1 more row has no part in it"
    assert facts["Noise"] == "sigma 0.5 (estimated with the inliers and the outliers together)"
    assert facts["Threshold"] == "an inlier is within 1.35 of the trend (2.7 sigma)"
    assert facts["On inliers"] == "R² 0.987, RMSE 0.44"
    assert "3 inliers count as 7.5 independent ones (lag-1 correlation 0.25)" in facts["Intervals"]


def test_a_given_threshold_is_told_as_given() -> None:
    trend = made_trend(
        [0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0, threshold=4.0, threshold_source="given"
    )
    assert dict(describe(trend).facts)["Threshold"] == "an inlier is within 4 of the trend (given)"


def test_sampling_probability_is_the_chance_of_a_clean_pair_and_never_rounds_to_certainty() -> None:
    search = dict(describe(made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0)).facts)[
        "Search"
    ]
    assert search == "500 pairs drawn; chance that a clean pair was among them: > 99.9 %"


@pytest.mark.parametrize(
    ("kind", "told"),
    [
        ("exhaustive", "exhaustive: all 500 pairs were tried"),
        ("certified", "certified: no other model has a better consensus"),
        ("closed", "none: the method draws no samples"),
    ],
)
def test_searches_that_leave_nothing_to_chance_say_so(kind: str, told: str) -> None:
    trend = made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0, search=kind)
    assert dict(describe(trend).facts)["Search"] == told


def test_the_farthest_outliers_are_listed_first_and_the_rest_counted() -> None:
    values = np.arange(10.0)
    values[2:9] += [10, 20, -30, 40, -50, 60, 70]
    report = describe(made_trend(range(10), values, slope=1.0, level=0.0, outliers=tuple(range(2, 9))))
    assert report.outliers_total == 7
    assert [time for time, _, _ in report.outliers] == ["8", "7", "6", "5", "4"]
    assert report.outliers[2] == ("6", "-44", "-50 (-100 sigma)")
    assert "7 outliers, farthest 5" in to_text(report)


def test_a_runner_up_is_told_in_the_unit_of_the_slope() -> None:
    other = RunnerUp({"slope": 4.0 / DAY, "intercept": 7.0}, 12, 0.25, True)
    trend = made_trend(daily(10), np.zeros(10), slope=2.0 / DAY, level=0.0, runner_up=other)
    assert dict(describe(trend).facts)["Runner-up"] == (
        "slope 4 per day, level 7 at 2024-01-01: 12 points follow it instead, sigma 0.25; nearly as good"
    )


def test_predictions_name_both_bands_apart() -> None:
    text = made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0, predict=[4.0]).summary()
    assert "95 % of the trend" in text
    assert "95 % of a reading" in text
    assert "lie outside the time span of the data (times 1)." in flat(text)


def test_many_predictions_are_counted_not_all_listed() -> None:
    text = made_trend(
        [0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0, predict=np.linspace(0, 2, 50)
    ).summary()
    assert "First 10 of 50 predictions" in text


ELSEWHERE = POSITION_NOTICES | TRACK_NOTICES


@pytest.mark.parametrize("code", [code for code in NoticeCode if code not in ELSEWHERE])
def test_every_notice_says_what_it_means_and_what_to_do(code: NoticeCode) -> None:
    trend = made_trend(
        [0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0, notices=(notice(code, count=4),)
    )
    message, advice = describe(trend).notices[0]
    assert message == NOTICE_MEANINGS[code].rstrip(".") + " (count 4)."
    assert advice.endswith(".")


def test_a_notice_of_fit_and_prediction_is_told_once() -> None:
    outside = notice(NoticeCode.extrapolation, times=1)
    trend = made_trend(
        [0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0, notices=(outside,), predict=[9.0]
    )
    assert len(describe(trend).notices) == 1


def test_the_summary_fits_80_columns() -> None:
    values = np.zeros(400)
    values[::7] = 1e3
    trend = made_trend(
        daily(400),
        values,
        slope=-1.23456e-9,
        level=12.3,
        outliers=tuple(range(0, 400, 7)),
        runner_up=RunnerUp({"slope": 1e-9, "intercept": 7.0}, 12, 0.25, False),
        notices=tuple(notice(code, count=12) for code in NoticeCode),
        predict=daily(3, "2030-01-01"),
    )
    assert max(map(len, trend.summary().splitlines())) <= WIDTH


class _Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.seen: set[str] = set()

    def handle_starttag(self, tag: str, _attrs: list[tuple[str, str | None]]) -> None:
        self.seen.add(tag)
        if tag != "br":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def test_html_is_one_balanced_table_without_scripts() -> None:
    trend = made_trend(
        range(5), [1.0, 2.0, 3.0, 40.0, 5.0], slope=1.0, level=1.0, outliers=(3,), predict=[9.0]
    )
    tags = _Tags()
    tags.feed(trend._repr_html_())
    assert tags.open == []
    assert tags.seen == {"table", "caption", "b", "br", "code", "tr", "th", "td"}


def test_html_escapes_the_names_of_columns() -> None:
    trend = made_trend([0.0, 1.0, 2.0], [1.0, 3.0, 5.0], slope=2.0, level=1.0)
    page = to_html(describe(trend, time_name="<script>alert(1)</script>"))
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


def test_html_and_text_say_the_same() -> None:
    report = describe(made_trend(range(5), [1.0, 2.0, 3.0, 40.0, 5.0], slope=1.0, level=1.0, outliers=(3,)))
    for label, sentence in report.facts:
        assert escape(sentence) in to_html(report)
        assert flat(f"{label} {sentence}") in flat(to_text(report))
