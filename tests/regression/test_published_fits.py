"""Lines published for well-known data sets, computed with R robustbase 0.95."""

from __future__ import annotations

import csv
import itertools
from pathlib import Path

import numpy as np
import pytest

from estimators.noise import scale_floor
from estimators.regression.least_squares import least_squares
from estimators.regression.minimal_fits import solve_samples
from estimators.regression.mm import mm_estimate

SETS = {
    "starsCYG": ("starsCYG", "log.Te", "log.light", False),
    "telef": ("telef", "Year", "Calls", False),
    "Animals2_log10": ("Animals2", "body", "brain", True),
    "pilot": ("pilot", "X", "Y", False),
    "exAM": ("exAM", "x", "y", False),
    "SiegelsEx": ("SiegelsEx", "x", "y", False),
    "stackloss_airflow": ("stackloss", "Air.Flow", "stack.loss", False),
    "kootenay": ("kootenay", "Libby", "Newgate", False),
}


def read_line(folder: Path, name: str) -> tuple[np.ndarray, np.ndarray, float, float]:
    """Columns and values in a frame with t in [-1, 1], and its center and half width."""
    file, x_name, y_name, logarithmic = SETS[name]
    with (folder / "robustbase" / f"{file}.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    x = np.array([float(row[x_name]) for row in rows])
    y = np.array([float(row[y_name]) for row in rows])
    if logarithmic:
        x, y = np.log10(x), np.log10(y)
    center, half = 0.5 * (x.max() + x.min()), 0.5 * (x.max() - x.min())
    t = (x - center) / half
    return np.vstack([np.ones_like(t), t]), y, center, half


def published(folder: Path, name: str, method: str) -> dict[str, float]:
    with (folder / "robustbase" / "reference_fits_R_robustbase_0.95.csv").open() as stream:
        for row in csv.DictReader(stream):
            if (row["set"], row["method"]) == (name, method):
                return {key: float(row[key]) for key in ("slope", "intercept", "scale")}
    raise LookupError(f"{name} by {method}")


@pytest.mark.parametrize("name", SETS)
def test_mm_estimates_are_the_published_ones(name: str, trend_data: Path) -> None:
    columns, y, center, half = read_line(trend_data, name)
    pairs = np.array(list(itertools.combinations(range(y.size), 2)))
    fit = mm_estimate(columns, y, starts=solve_samples(columns, y, pairs), floor=scale_floor(y))
    expected = published(trend_data, name, "lmrob_MM")
    slope = fit.theta[1] / half
    assert slope == pytest.approx(expected["slope"], rel=1e-5, abs=1e-9)
    assert fit.theta[0] - slope * center == pytest.approx(expected["intercept"], rel=1e-5, abs=1e-9)
    assert fit.sigma == pytest.approx(expected["scale"], rel=5e-5, abs=1e-9)


@pytest.mark.parametrize("name", SETS)
def test_least_squares_fits_are_the_published_ones(name: str, trend_data: Path) -> None:
    columns, y, center, half = read_line(trend_data, name)
    theta, residual, _ = least_squares(columns, y)
    expected = published(trend_data, name, "ols")
    slope = theta[1] / half
    assert slope == pytest.approx(expected["slope"], rel=1e-12)
    assert theta[0] - slope * center == pytest.approx(expected["intercept"], rel=1e-12)
    assert np.sqrt(np.sum(residual**2) / (y.size - 2)) == pytest.approx(expected["scale"], rel=1e-12)
