"""The pictures of the documentation: ``make figures`` draws them.

They are what ``trend.plot()`` draws of ``examples/disk_usage.csv``, and of the weekly carbon dioxide at Mauna
Loa that statsmodels brings along; nothing is retouched.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd
from statsmodels.datasets import co2

from estimators import Trend, fit_trend
from estimators.adapters.plotting import Theme, render

if TYPE_CHECKING:
    from estimators.result import NoFit

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
THEMES: dict[str, Theme] = {"": "light", "_dark": "dark"}


def fit_disk() -> Trend:
    """Fit the line through the disk's readings.

    Raises
    ------
    ValueError
        If there is no trend in them.
    """
    file = Path(__file__).with_name("disk_usage.csv")
    return _found(fit_trend(pd.read_csv(file, parse_dates=["time"], index_col="time")["value"]))


def fit_carbon_dioxide() -> Trend:
    """Fit line and season to the last years of the carbon dioxide at Mauna Loa, with two years ahead.

    Raises
    ------
    ValueError
        If there is no trend in them.
    """
    weekly = co2.load_pandas().data["co2"]["1995":]
    ahead = pd.date_range(weekly.index[-1], periods=9, freq="91D")[1:]
    return _found(fit_trend(weekly, seasonal="auto", predict=ahead))


def _found(answer: Trend | NoFit) -> Trend:
    if isinstance(answer, Trend):
        return answer
    raise ValueError(answer.summary())


def draw(directory: Path) -> list[Path]:
    """Write every picture into a directory; their paths."""
    paths = []
    for name, trend, label in (
        ("disk_usage", fit_disk(), "GB used"),
        ("carbon_dioxide", fit_carbon_dioxide(), "ppm"),
    ):
        for suffix, theme in THEMES.items():
            path = directory / f"{name}{suffix}.svg"
            figure = trend.plot(width_px=800, height_px=420, theme=theme, value_label=label)
            path.write_bytes(render(figure, "svg"))
            paths.append(path)
    return paths


if __name__ == "__main__":
    IMAGES.mkdir(parents=True, exist_ok=True)
    for drawn in draw(IMAGES):
        print(f"{drawn.relative_to(IMAGES.parents[1])}: {drawn.stat().st_size // 1000} kB", file=sys.stderr)
