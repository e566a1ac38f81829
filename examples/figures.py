"""The pictures of the documentation: ``make figures`` draws them.

They are what ``plot()`` draws of ``examples/disk_usage.csv``, of the weekly carbon dioxide at Mauna Loa that
statsmodels brings along, of ``examples/pseudoranges.csv``, and of the track with which
``docs/trajectories.md`` begins; nothing is retouched.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import pandas as pd
from statsmodels.datasets import co2

from estimators import Fix, Track, Trend, clean_trajectory, fit_trend, locate
from estimators.adapters.plotting import Theme, render

if TYPE_CHECKING:
    from estimators.result import NoFit

IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
THEMES: dict[str, Theme] = {"": "light", "_dark": "dark"}
Answer = TypeVar("Answer", Trend, Fix, Track)


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


def locate_receiver() -> Fix:
    """Locate the receiver between tall buildings.

    Raises
    ------
    ValueError
        If there is no position.
    """
    ranges = pd.read_csv(Path(__file__).with_name("pseudoranges.csv"))
    return _found(
        locate(
            ranges[["x_m", "y_m", "z_m"]].to_numpy(),
            ranges["pseudorange_m"].to_numpy(),
            system=ranges["system"].to_list(),
            satellite=ranges["satellite"].to_list(),
        )
    )


def clean_ride() -> Track:
    """Clean the track of the page on trajectories: two fixes far off, twenty by way of a wall.

    Raises
    ------
    ValueError
        If there is no track.
    """
    random = np.random.RandomState(4)
    t = np.arange(300.0)
    lat = 48.1 + 9e-5 * t + 3e-5 * random.standard_normal(300)
    lon = 11.5 + 4e-4 * np.sin(t / 60) + 4e-5 * random.standard_normal(300)
    lat[[40, 90]] += [0.02, -0.004]
    lat[150:170] += 0.0006
    return _found(clean_trajectory(t, lat, lon))


def _found(answer: Answer | NoFit) -> Answer:
    if isinstance(answer, Trend | Fix | Track):
        return answer
    raise ValueError(answer.summary())


def draw(directory: Path) -> list[Path]:
    """Write every picture into a directory; their paths."""
    disk, carbon, sky, ride = fit_disk(), fit_carbon_dioxide(), locate_receiver(), clean_ride()
    paths = []
    for suffix, theme in THEMES.items():
        figures = {
            "disk_usage": disk.plot(width_px=800, height_px=420, theme=theme, value_label="GB used"),
            "carbon_dioxide": carbon.plot(width_px=800, height_px=420, theme=theme, value_label="ppm"),
            "sky": sky.plot(width_px=480, height_px=480, theme=theme),
            "ride": ride.plot("error", width_px=800, height_px=450, theme=theme),
        }
        for name, figure in figures.items():
            path = directory / f"{name}{suffix}.svg"
            path.write_bytes(render(figure, "svg"))
            paths.append(path)
    return paths


if __name__ == "__main__":
    IMAGES.mkdir(parents=True, exist_ok=True)
    for drawn in draw(IMAGES):
        print(f"{drawn.relative_to(IMAGES.parents[1])}: {drawn.stat().st_size // 1000} kB", file=sys.stderr)
