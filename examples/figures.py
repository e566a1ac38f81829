"""The pictures of the documentation: ``make figures`` draws them from ``examples/disk_usage.csv``.

They are what ``trend.plot()`` draws; nothing is retouched.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pandas as pd

from estimators import Trend, fit_trend
from estimators.adapters.plotting import Theme, render

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
PICTURES: dict[str, Theme] = {"disk_usage.svg": "light", "disk_usage_dark.svg": "dark"}


def fit_disk() -> Trend:
    """Fit the line through the disk's readings.

    Raises
    ------
    ValueError
        If there is no trend in them.
    """
    file = Path(__file__).with_name("disk_usage.csv")
    disk = pd.read_csv(file, parse_dates=["time"], index_col="time")["value"]
    answer = fit_trend(disk)
    if isinstance(answer, Trend):
        return answer
    raise ValueError(answer.summary())


def draw(directory: Path) -> list[Path]:
    """Write every picture into a directory; their paths."""
    trend = fit_disk()
    paths = []
    for name, theme in PICTURES.items():
        path = directory / name
        figure = trend.plot(width_px=800, height_px=420, theme=theme, value_label="GB used")
        path.write_bytes(render(figure, "svg"))
        paths.append(path)
    return paths


if __name__ == "__main__":
    IMAGES.mkdir(parents=True, exist_ok=True)
    for drawn in draw(IMAGES):
        print(f"{drawn.relative_to(IMAGES.parents[1])}: {drawn.stat().st_size // 1000} kB", file=sys.stderr)
