from __future__ import annotations

import re
import struct
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

from estimators import fit_trend
from estimators.adapters.figure_sheet import PALETTES, Sheet
from estimators.adapters.plotting import render, trend_figure
from estimators.arrays import InputError
from estimators.trends.trend import RunnerUp, Trend
from tests.trends.made import daily, made_trend


def noisy(count: int = 60, outliers: tuple[int, ...] = (5, 20, 41), far: float = 20.0, **extra: Any) -> Trend:
    time = np.arange(float(count))
    values = 2.0 + 0.5 * time + np.random.default_rng(1).normal(0, 0.5, count)
    values[list(outliers)] += far
    return made_trend(time, values, slope=0.5, level=2.0, outliers=outliers, **extra)


def texts(svg: bytes) -> list[str]:
    root = ET.fromstring(svg)
    return ["".join(node.itertext()) for node in root.iter("{http://www.w3.org/2000/svg}text")]


def labels(trend: Trend, **style: Any) -> list[str]:
    return texts(render(trend_figure(trend, **style), "svg"))


def png_size(png: bytes) -> tuple[int, int]:
    return struct.unpack(">II", png[16:24])


@pytest.mark.parametrize("size", [(800, 450), (401, 251), (200, 150), (1999, 1001)])
def test_a_png_has_the_pixels_asked_for(size: tuple[int, int]) -> None:
    assert png_size(render(trend_figure(noisy(), width_px=size[0], height_px=size[1]), "png")) == size


def test_an_svg_has_the_css_size_asked_for() -> None:
    root = ET.fromstring(render(trend_figure(noisy(), width_px=800, height_px=400), "svg"))
    # 1 pt is 4/3 CSS pixels.
    assert (root.attrib["width"], root.attrib["height"]) == ("600pt", "300pt")


@pytest.mark.parametrize("kind", ["svg", "png"])
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_two_renders_are_byte_equal(kind: Any, theme: Any) -> None:
    first, second = (render(trend_figure(noisy(predict=[80.0]), theme=theme), kind) for _ in range(2))
    assert first == second


def test_the_users_matplotlib_settings_change_nothing() -> None:
    plain = render(trend_figure(noisy()), "svg")
    with mpl.rc_context(
        {"font.size": 30, "lines.linewidth": 9, "axes.facecolor": "red", "svg.fonttype": "path"}
    ):
        assert render(trend_figure(noisy()), "svg") == plain


def test_drawing_leaves_the_users_matplotlib_settings_alone() -> None:
    before = dict(mpl.rcParams)
    render(trend_figure(noisy()), "svg")
    assert dict(mpl.rcParams) == before


def test_threads_draw_the_same_bytes() -> None:
    trends = [noisy(far=far) for far in (10.0, 20.0, 30.0)]
    alone = [render(trend_figure(trend), "svg") for trend in trends]
    with ThreadPoolExecutor(3) as pool:
        together = list(pool.map(lambda trend: render(trend_figure(trend), "svg"), trends))
    assert together == alone


def test_pyplot_is_not_involved() -> None:
    import matplotlib.pyplot as plt

    open_before = plt.get_fignums()
    trend_figure(noisy())
    assert plt.get_fignums() == open_before


def test_the_legend_names_points_trend_and_both_bands() -> None:
    shown = labels(noisy())
    for label in ("inliers (57)", "outliers (3)", "trend", "confidence band, 95 %", "prediction band, 95 %"):
        assert label in shown


def test_the_title_is_the_slope_with_its_interval_unless_given() -> None:
    assert "Slope 0.500 (95 %: 0.442 to 0.558)" in labels(noisy())
    assert "Disk use" in labels(noisy(), title="Disk use")
    assert not any(text.startswith("Slope") for text in labels(noisy(), title=""))


def test_the_title_of_a_curve_is_its_mean_slope_and_that_of_a_level_the_level() -> None:
    time = np.arange(60.0)
    values = 3.0 + 0.5 * time + 0.02 * (time - 30.0) ** 2 + np.random.default_rng(1).normal(0, 0.5, 60)
    curve, level = (
        fit_trend(time, values, model="linear", degree=2),
        fit_trend(time, values, model="constant"),
    )
    assert isinstance(curve, Trend)
    assert isinstance(level, Trend)
    assert any(text.startswith("Mean slope 0.4") for text in labels(curve))
    assert any(text.startswith("Level ") for text in labels(level))


def test_a_title_too_long_for_the_picture_is_broken_into_lines_of_about_equal_length() -> None:
    title = "The slope of a very long title that says more than a small picture has room for"
    lines = [text for text in labels(noisy(), title=title, width_px=400) if text and text in title]
    assert len(lines) >= 2
    assert " ".join(lines) == title
    assert title in labels(noisy(), title=title, width_px=1600)


def test_dollars_in_a_callers_text_stay_dollars() -> None:
    assert "Cost in $, sum of $x_1$" in labels(noisy(), title="Cost in $, sum of $x_1$")


@pytest.mark.parametrize("kind", ["svg", "png"])
def test_letters_that_the_font_lacks_do_not_keep_a_picture_from_being_drawn(kind: Any) -> None:
    assert render(trend_figure(noisy(), title="温度 \x80"), kind)


def test_names_of_the_axes_are_shown_and_escaped() -> None:
    shown = labels(noisy(), time_label="day <1>", value_label="level & more")
    assert "day <1>" in shown
    assert "level & more" in shown


def test_two_points_have_no_bands_to_show() -> None:
    shown = labels(made_trend([0.0, 1.0], [1.0, 3.0], slope=2.0, level=1.0, dof=None))
    assert "trend" in shown
    assert not any("band" in text for text in shown)


def test_an_extrapolation_is_dashed_and_named() -> None:
    shown = labels(noisy(predict=[70.0, 80.0]))
    assert "extrapolated" in shown
    assert "predicted (2)" in shown
    assert "extrapolated" not in labels(noisy(predict=[30.0]))


def test_a_runner_up_is_drawn_only_if_nearly_as_good() -> None:
    def shown(equally_good: bool) -> list[str]:
        other = RunnerUp({"slope": -0.5, "intercept": 30.0}, 25, 0.5, equally_good)
        return labels(noisy(runner_up=other))

    assert "runner-up (25)" in shown(True)
    assert "runner-up (25)" not in shown(False)


def test_extreme_outliers_leave_the_trend_its_share_of_the_height_and_are_counted() -> None:
    trend = noisy(far=1e6)
    sheet = Sheet.of(trend, PALETTES["light"], 800, 450)
    inliers = sheet.y[sheet.inlier]
    assert inliers.max() - inliers.min() > 0.4 * (sheet.high - sheet.low)
    assert "beyond the frame (3)" in labels(trend)


def test_outliers_nearby_are_inside_the_frame() -> None:
    assert not any("beyond" in text for text in labels(noisy(far=8.0)))


def test_points_on_either_side_of_the_frame_are_all_counted() -> None:
    values = np.arange(30.0)
    values[[3, 9]] = 1e5, -1e5
    assert "beyond the frame (2)" in labels(
        made_trend(np.arange(30.0), values, slope=1.0, level=0.0, outliers=(3, 9))
    )


def test_rows_that_are_missing_are_not_drawn() -> None:
    trend = made_trend([0.0, 1.0, np.nan, 3.0, 4.0], [0.0, np.nan, 2.0, 3.0, 4.0], slope=1.0, level=0.0)
    assert "inliers (3)" in labels(trend)


def test_labels_that_are_less_sure_are_paler_and_the_legend_says_so() -> None:
    trend = noisy()
    assert "paler: less sure" not in labels(trend)
    trend.points.probability[3] = 0.5
    assert "paler: less sure" in labels(trend)


def test_dates_get_a_date_axis() -> None:
    shown = labels(made_trend(daily(40), np.zeros(40), slope=1e-6, level=0.0))
    assert "Feb" in shown


def test_a_series_of_microseconds_is_drawn_in_seconds_since_its_start() -> None:
    time = np.datetime64("2024-05-01T12:00", "ns") + np.arange(5) * np.timedelta64(1, "us")
    assert "seconds since 2024-05-01 12:00" in labels(made_trend(time, np.zeros(5), slope=1e5, level=0.0))


def test_huge_integer_times_are_drawn_since_their_start() -> None:
    start = 1_700_000_000_000_000_000
    trend = made_trend(np.arange(5) + start, np.arange(5.0), slope=1.0, level=0.0)
    assert f"since {start}" in labels(trend)
    sheet = Sheet.of(trend, PALETTES["light"], 800, 450)
    np.testing.assert_allclose(np.unique(sheet.x), np.arange(5.0))
    np.testing.assert_allclose(sheet.curves.value, sheet.curves.time)


def test_very_many_points_stay_a_small_svg_with_all_of_them_counted() -> None:
    count = 200_000
    values = np.random.default_rng(5).normal(size=count)
    outliers = tuple(range(0, count, 20))
    values[list(outliers)] += 8
    svg = render(
        trend_figure(made_trend(np.arange(float(count)), values, slope=1e-9, level=0.0, outliers=outliers)),
        "svg",
    )
    assert len(svg) < 1_000_000
    assert b"data:image/png;base64" in svg
    assert "inliers (190,000)" in texts(svg)
    assert "outliers (10,000)" in texts(svg)


def test_inliers_and_outliers_differ_in_shape_and_not_only_in_colour() -> None:
    svg = render(trend_figure(noisy()), "svg").decode()
    colors = [PALETTES["light"].inlier, PALETTES["light"].outlier]
    shapes = {color: re.findall(rf'<path id="\w+" d="([^"]+)"[^>]*{color}', svg) for color in colors}
    assert all(shapes.values())
    assert not set(shapes[colors[0]]) & set(shapes[colors[1]])


def test_the_themes_differ_in_paper() -> None:
    assert (
        trend_figure(noisy(), theme="light").get_facecolor()
        != trend_figure(noisy(), theme="dark").get_facecolor()
    )


def test_constant_values_get_a_frame_around_them() -> None:
    sheet = Sheet.of(
        made_trend([0.0, 1.0, 2.0], [5.0, 5.0, 5.0], slope=0.0, level=5.0, sigma=1e-15),
        PALETTES["light"],
        800,
        450,
    )
    assert sheet.low < 4.9
    assert sheet.high > 5.1


@pytest.mark.parametrize("style", [{"width_px": 10}, {"height_px": 100_000}, {"theme": "pink"}])
def test_what_cannot_be_drawn_is_refused(style: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        trend_figure(noisy(), **style)


def test_an_unknown_format_is_refused() -> None:
    with pytest.raises(InputError, match="svg, png"):
        render(trend_figure(noisy()), "gif")  # type: ignore[arg-type]


def test_plot_of_a_trend_is_this_picture() -> None:
    assert render(noisy().plot(theme="dark"), "svg") == render(trend_figure(noisy(), theme="dark"), "svg")
