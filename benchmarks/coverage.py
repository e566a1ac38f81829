"""How honest the inference is: ``python -m benchmarks.coverage`` measures it and rewrites its tables.

Three tables of ``docs/uncertainty.md``: how often 95 % intervals of the slope hold the truth, how often
each kind of p-value falls below 1, 5 and 10 % where there is no trend, and how far stated inlier
probabilities are from what comes true (expected calibration error). The noise of the first two is an AR(1)
process in time, so that irregular sampling thins its correlation as it would in nature.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks import metrics
from benchmarks.bed import KINDS, draw_rng, make_series
from benchmarks.kinds import BOX
from estimators import RobustOptions, Trend, fit_trend
from estimators.arrays import BoolArray, FloatArray

PAGE = Path(__file__).resolve().parent.parent / "docs" / "uncertainty.md"
METHODS = ("effective-n", "hac", "bootstrap", "permutation")
RESAMPLES = 99
"""Series per fit of the resampling methods: the least that a 1 % level needs, to keep the run short."""
FORMULAS = ("effective-n", "hac")
MOST_RESAMPLED = 80
"""Points of the largest series that the resampling methods are measured on, for the same reason."""
LEVELS = (0.01, 0.05, 0.10)
SHARES = (0.0, 0.2, 0.4, 0.6)
SIZES = {50: 6, 200: 3, 1000: 1}
"""Draws per size in a cell of the calibration table, relative to one another."""
BINS = 15


class Noise(NamedTuple):
    """One series to draw: size, correlation of neighbours one unit of time apart, outliers, times."""

    n: int
    phi: float
    outliers: float
    times: str

    @property
    def title(self) -> str:
        """Row of a table."""
        return f"{self.n} | {self.phi:g} | {100 * self.outliers:g} % | {self.times}"


CELLS = tuple(
    Noise(n, phi, outliers, times)
    for n in (80, 200)
    for phi in (0.0, 0.5, 0.8)
    for outliers, times in ((0.0, "regular"), (0.2, "irregular"))
)


def draw_times(n: int, times: str, rng: np.random.Generator) -> FloatArray:
    """Draw times: ``regular`` ones a unit apart, or ``irregular`` with exponential gaps of mean 1."""
    if times == "regular":
        return np.arange(float(n))
    return np.concatenate(([0.0], np.cumsum(rng.exponential(size=n - 1))))


def correlated_noise(t: FloatArray, phi: float, rng: np.random.Generator) -> FloatArray:
    """Noise with standard deviation 1 and correlation phi^|t - t'| between two times.

    Examples
    --------
    >>> noise = correlated_noise(np.arange(20000.0), 0.5, np.random.default_rng(0))
    >>> bool(abs(np.corrcoef(noise[1:], noise[:-1])[0, 1] - 0.5) < 0.03)
    True
    """
    fresh = rng.normal(size=t.size)
    kept = phi ** np.diff(t)
    noise = np.empty(t.size)
    noise[0] = fresh[0]
    for i in range(1, t.size):
        noise[i] = kept[i - 1] * noise[i - 1] + np.sqrt(1.0 - kept[i - 1] ** 2) * fresh[i]
    return noise


def draw_noise(cell: Noise, index: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """Draw a series without a trend."""
    key = [seed, cell.n, round(100 * cell.phi), round(100 * cell.outliers), len(cell.times), index]
    rng = np.random.default_rng(key)
    t = draw_times(cell.n, cell.times, rng)
    y = correlated_noise(t, cell.phi, rng)
    hit = rng.choice(cell.n, size=round(cell.outliers * cell.n), replace=False)
    y[hit] = rng.uniform(-BOX, BOX, size=hit.size)
    return t, y


@dataclass(frozen=True, slots=True)
class Inference:
    """What a method answered on the draws of a cell.

    Attributes
    ----------
    p_values : ndarray of float64, shape (draws,)
    covered : ndarray of float64, shape (draws,)
        1 where the slope's interval holds the truth, 0.
    stability : ndarray of float64, shape (draws,)
        NaN where the method does not tell.
    """

    p_values: FloatArray
    covered: FloatArray
    stability: FloatArray

    def rejected(self, level: float) -> float:
        """Share of p-values below a level."""
        return float(np.mean(self.p_values < level))


def infer(cell: Noise, method: str, draws: int, seed: int) -> Inference:
    """Fit the draws of a cell."""
    options = RobustOptions(resamples=RESAMPLES)
    table = np.full((3, draws), np.nan)
    for index in range(draws):
        t, y = draw_noise(cell, index, seed)
        trend = fit_trend(t, y, uncertainty=method, options=options)
        assert isinstance(trend, Trend)
        slope = trend.parameters["slope"]
        assert slope.low is not None
        assert slope.high is not None
        assert trend.p_value is not None
        stability = trend.uncertainty.stability
        table[:, index] = (
            trend.p_value,
            slope.low <= 0.0 <= slope.high,
            np.nan if stability is None else stability,
        )
    return Inference(*table)


def calibration_error(stated: FloatArray, truth: BoolArray) -> float:
    """Average |stated - true share| over bins of probabilities, weighted by points: the expected error.

    Examples
    --------
    >>> calibration_error(np.array([0.9, 0.9, 0.1, 0.1]), np.array([True, True, False, False]))
    0.1
    """
    place = np.minimum((stated * BINS).astype(np.int64), BINS - 1)
    off = np.bincount(place, weights=stated, minlength=BINS) - np.bincount(
        place, weights=truth.astype(np.float64), minlength=BINS
    )
    return float(np.round(np.abs(off).sum() / stated.size, 12))


def calibrate(kind: str, share: float, method: str, draws: int, seed: int) -> float:
    """Calibration error of a kind of contamination, sizes pooled, on fits that did not fail."""
    stated: list[FloatArray] = []
    truth: list[BoolArray] = []
    for n, weight in SIZES.items():
        for index in range(weight * draws):
            drawn = make_series(kind, n, share, draw_rng(seed, kind, n, share, index))
            sigma = drawn.sigma if method == "msac" else None
            trend = fit_trend(drawn.t, drawn.y, method=method, sigma=sigma)
            if not isinstance(trend, Trend):
                continue
            slope, intercept = trend.parameters["slope"].value, trend.parameters["intercept"].value
            errors = metrics.line_errors(slope, intercept, drawn)
            if not metrics.failed(errors[None], metrics.oracle(drawn).stderr[None])[0]:
                stated.append(trend.points.probability)
                truth.append(drawn.inlier_mask)
    return calibration_error(np.concatenate(stated), np.concatenate(truth))


def _percent(value: float) -> str:
    return f"{100.0 * value:.1f}"


def _coverage(found: Inference) -> str:
    return _percent(float(found.covered.mean()))


def _rejections(found: Inference) -> str:
    return " / ".join(_percent(found.rejected(level)) for level in LEVELS)


def _row(
    cell: Noise,
    methods: Sequence[str],
    found: Mapping[tuple[Noise, str], Inference],
    words: Callable[[Inference], str],
) -> str:
    told = [words(found[cell, method]) if (cell, method) in found else "" for method in methods]
    return " | ".join([cell.title, *told])


def _markdown(header: str, rows: Sequence[str]) -> str:
    columns = header.count("|") + 1
    return "\n".join([f"| {header} |", "| --- " * columns + "|", *(f"| {row} |" for row in rows)])


def measure(draws: int, *, seed: int, jobs: int) -> dict[str, str]:
    """Measure everything and write the tables, by the names that the page gives them."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as workers:
        inferred = {
            (cell, method): workers.submit(infer, cell, method, draws, seed)
            for cell in CELLS
            for method in METHODS
            if method in FORMULAS or cell.n <= MOST_RESAMPLED
        }
        calibrated = {
            (method, kind, share): workers.submit(calibrate, kind, share, method, max(1, draws // 50), seed)
            for method in ("auto", "msac")
            for kind in KINDS
            for share in SHARES
        }
        found = {key: future.result() for key, future in inferred.items()}
        errors = {key: future.result() for key, future in calibrated.items()}
    covered = [_row(cell, METHODS[:3], found, _coverage) for cell in CELLS]
    rejected = [_row(cell, METHODS, found, _rejections) for cell in CELLS]
    calibration = [
        f"`{method}` | {kind} | " + " | ".join(f"{errors[method, kind, share]:.3f}" for share in SHARES)
        for method in ("auto", "msac")
        for kind in KINDS
    ]
    setting = "points | AR(1) | outliers | times"
    return {
        "coverage": _markdown(f"{setting} | `effective-n` | `hac` | `bootstrap`", covered),
        "p-values": _markdown(f"{setting} | `effective-n` | `hac` | `bootstrap` | `permutation`", rejected),
        "calibration": _markdown("method | kind | " + " | ".join(f"{s:.0%}" for s in SHARES), calibration),
    }


def write_tables(text: str, tables: dict[str, str]) -> str:
    """Page with its measured tables replaced.

    Raises
    ------
    ValueError
        If the page has no place for a table.
    """
    for name, table in tables.items():
        place = re.search(rf"<!-- measured: {name} -->\n(.*?)<!-- end of measured -->", text, re.DOTALL)
        if place is None:
            raise ValueError(f"the page has no place for the table {name}")
        text = f"{text[: place.start(1)]}\n{table}\n\n{text[place.end(1) :]}"
    return text


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.coverage", description=__doc__)
    parser.add_argument("--draws", type=int, default=1000, help="series per cell (default 1000)")
    parser.add_argument("--seed", type=int, default=3, help="seed of the draws (default 3)")
    parser.add_argument("--jobs", type=int, default=2, help="processes (default 2)")
    parser.add_argument(
        "--page", type=Path, default=PAGE, help="page to rewrite (default docs/uncertainty.md)"
    )
    chosen = parser.parse_args(arguments)
    tables = measure(chosen.draws, seed=chosen.seed, jobs=chosen.jobs)
    chosen.page.write_text(write_tables(chosen.page.read_text(), tables))
    return 0


if __name__ == "__main__":
    sys.exit(main())
