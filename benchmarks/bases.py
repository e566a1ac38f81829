"""Models of many columns: polynomials and seasons beside scikit-learn's RANSAC and statsmodels' RLM.

``python -m benchmarks.bases`` prints a table: failures in percent over shapes, kinds of outliers and sizes. A
fit fails where it is off the truth by more than one noise scale, or by five of the standard errors of least
squares on the true inliers if those are larger.
"""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import statsmodels.api as sm
from sklearn.linear_model import LinearRegression, RANSACRegressor

from benchmarks.contenders import KNOWN_THRESHOLD
from benchmarks.kinds import (
    Contaminated,
    add_runs,
    all_but,
    contiguous_runs,
    excursion_levels,
    scattered_rows,
    with_uniform,
)
from estimators import Trend, fit_trend
from estimators.arrays import BoolArray, FloatArray
from estimators.trends.bases.design import polynomial_columns, season_columns

SHARES = (0.0, 0.2, 0.4, 0.6)
SIZES = (100, 400)
PERIOD = 25.0
SPAN = 200.0
REACH = 20.0
"""Largest coefficient of a column, in noise scales."""
TRIALS = 2000
"""Most trials of the sampling peer (its default is 100)."""


@dataclass(frozen=True, slots=True)
class Shape:
    """A polynomial with a season; as many columns as ``degree + 1 + 2 * harmonics``."""

    degree: int
    harmonics: int

    def columns(self, t: FloatArray) -> FloatArray:
        """Design, shape (p, n)."""
        season = season_columns(2.0 * np.pi * t / PERIOD, self.harmonics)
        return np.vstack([polynomial_columns(2.0 * t / SPAN - 1.0, self.degree), season])


SHAPES = (Shape(2, 0), Shape(4, 0), Shape(1, 1), Shape(1, 2), Shape(1, 3))


def _shift(t: FloatArray, noise: FloatArray, outliers: int, rng: np.random.Generator) -> Contaminated:
    """Outliers to one side: 4 + Exp(15) sigma above the trend."""
    hit = scattered_rows(t.size, outliers, rng)
    offset = noise.copy()
    offset[hit] += 4.0 + rng.exponential(15.0, hit.size)
    return Contaminated(t, offset, all_but(t.size, hit))


def _burst(t: FloatArray, noise: FloatArray, outliers: int, rng: np.random.Generator) -> Contaminated:
    """At most three runs in time, each at a level of its own."""
    runs = contiguous_runs(t.size, outliers, 3, 0.3, rng)
    return add_runs(noise.copy(), runs, excursion_levels(len(runs), rng, nearest=8.0, apart=15.0), t)


Kind = Callable[[FloatArray, FloatArray, int, np.random.Generator], Contaminated]
KINDS: Mapping[str, Kind] = {"uniform": with_uniform, "shift": _shift, "burst": _burst}
Fit = Callable[[Shape, FloatArray, FloatArray], FloatArray]


def fit_plumbline(shape: Shape, t: FloatArray, y: FloatArray) -> FloatArray:
    """Fit by ``auto``; nothing is told of threshold and noise."""
    seasonal = {"seasonal": PERIOD, "harmonics": shape.harmonics} if shape.harmonics else {}
    trend = fit_trend(t, y, model="linear", degree=shape.degree, **seasonal)  # type: ignore[arg-type]
    return trend.predict(t).value if isinstance(trend, Trend) else np.full(t.size, np.nan)


def _sklearn(shape: Shape, t: FloatArray, y: FloatArray, threshold: float | None) -> FloatArray:
    columns = shape.columns(t)
    model = RANSACRegressor(
        LinearRegression(fit_intercept=False),
        min_samples=columns.shape[0],
        residual_threshold=threshold,
        max_trials=TRIALS,
        random_state=0,
    )
    try:
        return np.asarray(model.fit(columns.T, y).predict(columns.T))
    except ValueError:  # its way of saying that no consensus was found
        return np.full(t.size, np.nan)


def fit_sklearn_told(shape: Shape, t: FloatArray, y: FloatArray) -> FloatArray:
    """Fit by scikit-learn's RANSAC, told the threshold."""
    return _sklearn(shape, t, y, KNOWN_THRESHOLD)


def fit_sklearn(shape: Shape, t: FloatArray, y: FloatArray) -> FloatArray:
    """Fit by scikit-learn's RANSAC with its own threshold, the median absolute deviation of the values."""
    return _sklearn(shape, t, y, None)


def fit_statsmodels(shape: Shape, t: FloatArray, y: FloatArray) -> FloatArray:
    """Fit by statsmodels' RLM with Tukey's bisquare."""
    design = shape.columns(t).T
    return np.asarray(sm.RLM(y, design, M=sm.robust.norms.TukeyBiweight()).fit().fittedvalues)


CONTENDERS: Mapping[str, Fit] = {
    "Plumbline auto": fit_plumbline,
    "scikit-learn RANSACRegressor, threshold told": fit_sklearn_told,
    "scikit-learn RANSACRegressor": fit_sklearn,
    "statsmodels RLM, Tukey": fit_statsmodels,
}


def draw(
    shape: Shape, kind: str, n: int, share: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray, FloatArray, BoolArray]:
    """Draw times, values, the true curve and the true inliers; the noise has scale 1."""
    t = np.sort(rng.uniform(0.0, SPAN, n))
    columns = shape.columns(t)
    truth = np.asarray(rng.uniform(-REACH, REACH, columns.shape[0]) @ columns)
    made = KINDS[kind](t, rng.normal(size=n), round(share * n), rng)
    return t, truth + made.offset, truth, made.inlier


def has_failed(shape: Shape, t: FloatArray, fit: FloatArray, truth: FloatArray, inlier: BoolArray) -> bool:
    """Whether a fit is off by more than one noise scale, or by five standard errors of the oracle."""
    columns = shape.columns(t)
    covariance = np.linalg.inv(columns[:, inlier] @ columns[:, inlier].T)
    oracle = np.sqrt(np.max(np.sum((covariance @ columns) * columns, axis=0)))
    return not bool(np.max(np.abs(fit - truth)) <= max(1.0, 5.0 * oracle))


def measure(draws: int, seed: int) -> dict[str, list[float]]:
    """Failures in percent by contender, one per share."""
    failures = {name: [0] * len(SHARES) for name in CONTENDERS}
    for place, share in enumerate(SHARES):
        for s, shape in enumerate(SHAPES):
            for k, kind in enumerate(KINDS):
                for n in SIZES:
                    for one in range(draws):
                        rng = np.random.default_rng([seed, place, s, k, n, one])
                        t, y, truth, inlier = draw(shape, kind, n, share, rng)
                        for name, fit in CONTENDERS.items():
                            failed = has_failed(shape, t, fit(shape, t, y), truth, inlier)
                            failures[name][place] += failed
    cells = len(SHAPES) * len(KINDS) * len(SIZES) * draws
    return {name: [100.0 * count / cells for count in row] for name, row in failures.items()}


def main(arguments: list[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.bases", description=__doc__)
    parser.add_argument("--draws", type=int, default=20, help="draws per shape, kind and size (default 20)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    chosen = parser.parse_args(arguments)
    with warnings.catch_warnings():
        # Peers warn of fits that did not converge; those count by what they answer.
        warnings.simplefilter("ignore")
        table = measure(chosen.draws, chosen.seed)
    heading = " | ".join(f"{100 * share:.0f} %" for share in SHARES)
    lines = [f"| fail %, p = 3 to 8 | {heading} |", "|---|" + "---|" * len(SHARES)]
    lines += [f"| {name} | {' | '.join(f'{value:.1f}' for value in row)} |" for name, row in table.items()]
    sys.stdout.write("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
