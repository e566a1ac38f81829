"""``python -m benchmarks.exponential``: exponentials in both kinds of noise, beside peers, in one run.

The bed is that of lines (:mod:`benchmarks.kinds`) about an exponential: noise and contamination are added to
the values (``additive``, sigma = 1), or to their logarithms (``multiplicative``, sigma = 0.1). The curve
grows or falls by a factor of e to e^4 over the span and is 40 where it is largest. ``native`` outliers are
uniform over the values' own range whatever the noise. An answer fails as lines do (METHODS_TRENDS): farther
from the truth than 1 sigma and 5 standard errors of the oracle somewhere, in the domain of the noise.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import scipy
import sklearn
from scipy.optimize import least_squares
from sklearn.linear_model import RANSACRegressor

from benchmarks.bed import draw_rng
from benchmarks.kinds import BOX, KINDS, SPAN, irregular_times, scattered_rows
from estimators import Trend, fit_trend
from estimators.arrays import BoolArray, FloatArray

DOMAINS = ("additive", "multiplicative")
ALL_KINDS = (*KINDS, "native")
SHARES = (0.0, 0.2, 0.4, 0.6)
DRAWS: Mapping[int, int] = {50: 60, 200: 40, 1000: 25}
LARGEST = 40.0
SIGMAS: Mapping[str, float] = {"additive": 1.0, "multiplicative": 0.1}
FAIL_ORACLE_ERRORS = 5.0

Curve: TypeAlias = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class Growth:
    """A random exponential series and the truth about it."""

    domain: str
    t: FloatArray
    y: FloatArray
    level: float
    rate: float
    inlier: BoolArray

    def truth(self) -> FloatArray:
        """Curve without noise at the times of the series."""
        return np.asarray(self.level * np.exp(self.rate * self.t))


def make_growth(domain: str, kind: str, n: int, share: float, rng: np.random.Generator) -> Growth:
    """Draw a series.

    Examples
    --------
    >>> growth = make_growth("additive", "uniform", 50, 0.4, np.random.default_rng(7))
    >>> int(growth.inlier.sum()), float(np.abs(growth.truth()).max()) <= LARGEST + 1e-9
    (30, True)
    """
    rate = float(rng.choice([-1, 1]) * rng.uniform(1.0, 4.0)) / SPAN
    level = LARGEST * float(np.exp(-max(rate * SPAN, 0.0)))
    hit = np.empty(0, dtype=np.int64)
    if kind == "native":
        t, offset = irregular_times(n, rng), rng.normal(size=n)
        hit = scattered_rows(n, round(share * n), rng)
        inlier = np.ones(n, dtype=bool)
        inlier[hit] = False
    else:
        made = KINDS[kind](n, round(share * n), rng)
        t, offset, inlier = made.t, made.offset, made.inlier
    curve = level * np.exp(rate * t)
    sigma = SIGMAS[domain]
    y = curve + sigma * offset if domain == "additive" else curve * np.exp(sigma * offset)
    # Values that the noise could have made as well as values that it could not.
    y[hit] = rng.uniform(-0.5 * LARGEST, 2.0 * BOX, size=hit.size)
    return Growth(domain, t, y, level, rate, inlier)


def oracle_stderr(growth: Growth) -> FloatArray:
    """Compute standard errors, at the times, of the curve that knows the inliers (linearised)."""
    weight = growth.truth() if growth.domain == "additive" else np.ones(growth.t.size)
    columns = np.stack([weight, weight * growth.t], axis=1)
    inside = columns[growth.inlier]
    covariance = np.linalg.inv(inside.T @ inside) * SIGMAS[growth.domain] ** 2
    return np.asarray(np.sqrt(np.einsum("ij,jk,ik->i", columns, covariance, columns)))


def failed(curve: FloatArray, growth: Growth) -> bool:
    """Whether a curve misses the truth somewhere in the range."""
    truth = growth.truth()
    with np.errstate(all="ignore"):
        off = curve - truth if growth.domain == "additive" else np.log(curve / truth)
    allowed = np.maximum(SIGMAS[growth.domain], FAIL_ORACLE_ERRORS * oracle_stderr(growth))
    return not bool(np.all(np.abs(off) <= allowed))


def fit_cauchy(growth: Growth) -> FloatArray:
    """Fit by scipy: Cauchy loss at the true scale, from the line through positive values' logarithms."""
    t, y = growth.t / SPAN, growth.y
    slope, intercept = _log_line(t, y)
    scale = 1.0 if growth.domain == "additive" else SIGMAS[growth.domain] * float(np.median(np.abs(y)))

    def residual(parameters: Any) -> Any:
        return np.exp(np.clip(parameters[0] + parameters[1] * t, -700.0, 300.0)) - y

    found = least_squares(residual, [intercept, slope], loss="cauchy", f_scale=scale)
    return np.asarray(np.exp(found.x[0] + found.x[1] * t))


def fit_log_ransac(growth: Growth) -> FloatArray:
    """Fit by scikit-learn: RANSAC, 1000 trials, on the logarithms of positive values."""
    positive = growth.y > 0.0
    model = RANSACRegressor(max_trials=1000, random_state=0)
    model.fit(growth.t[positive, None], np.log(growth.y[positive]))
    return np.asarray(np.exp(model.predict(growth.t[:, None])))


def _log_line(t: FloatArray, y: FloatArray) -> tuple[float, float]:
    positive = y > 0.0
    slope, intercept = np.polyfit(t[positive], np.log(y[positive]), 1)
    return float(slope), float(intercept)


PEERS: Mapping[str, Callable[[Growth], FloatArray]] = {
    "scipy least_squares, Cauchy, told sigma": fit_cauchy,
    "log + scikit-learn RANSAC": fit_log_ransac,
}
OURS = "Plumbline auto"


@dataclass(slots=True)
class Tally:
    """Counts of one domain and share."""

    draws: int = 0
    undetermined: int = 0
    mistaken: int = 0
    covered: int = 0
    fails: dict[str, int] | None = None

    def count(self, name: str, growth: Growth, curve: FloatArray | None) -> None:
        """Count a curve that fails, or is none."""
        self.fails = self.fails if self.fails is not None else {}
        self.fails.setdefault(name, 0)
        self.fails[name] += curve is None or failed(curve, growth)

    def percent(self, name: str) -> float:
        """Failures of a method."""
        return 100.0 * (self.fails or {}).get(name, 0) / max(self.draws, 1)


Table: TypeAlias = dict[tuple[str, float], Tally]


def measure(scale: float, seed: int, kinds: Sequence[str] = ALL_KINDS) -> Table:
    """Fit every draw by every method.

    Parameters
    ----------
    scale : float
        Multiplies the draws; 1 gives 60, 40 and 25 per kind at N = 50, 200 and 1000.
    seed : int
    kinds : sequence of str
    """
    table: Table = {(domain, share): Tally() for domain in DOMAINS for share in SHARES}
    for domain, share in table:
        for kind in kinds:
            for n, draws in DRAWS.items():
                for index in range(max(1, round(scale * draws))):
                    rng = draw_rng(seed, f"{domain} {kind}", n, share, index)
                    _count(table[domain, share], make_growth(domain, kind, n, share, rng))
    return table


def _count(tally: Tally, growth: Growth) -> None:
    tally.draws += 1
    trend = fit_trend(growth.t, growth.y, model="exponential")
    if isinstance(trend, Trend) and trend.noise is not None:
        curve = trend.geometry.value(growth.t - growth.t[0])
        tally.count(OURS, growth, curve)
        rate = trend.parameters["rate"]
        tally.covered += (
            rate.low is not None and rate.high is not None and rate.low <= growth.rate <= rate.high
        )
        tally.undetermined += trend.noise.selection == "undetermined"
        tally.mistaken += trend.noise.selection == "selected" and trend.noise.domain != growth.domain
    else:
        tally.count(OURS, growth, None)
    for name, fit in PEERS.items():
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            try:
                tally.count(name, growth, fit(growth))
            except (ValueError, TypeError, ArithmeticError, np.linalg.LinAlgError):
                tally.count(name, growth, None)


_OPENING = """# Benchmarks: exponentials

Every figure on this page was measured by `python -m benchmarks.exponential`, which rewrites it: all methods
on the same series in the same run (scipy {scipy}, scikit-learn {sklearn}).

The curve grows or falls by a factor of e to e^4 over the span and is 40 where it is largest. Noise and
outliers (the kinds of the [line's bed](benchmarks.md), and values uniform over the range whatever the noise)
are added to the values, sigma 1, or to their logarithms, sigma 0.1; a figure pools N = 50, 200 and 1000 and
all kinds. An answer **fails** when it is farther from the truth than 1 sigma and than 5 standard errors of
the oracle somewhere in the range, in the domain of the noise. Percent of failures over the share of outliers:
"""
_NOISE = """## The noise, told from the data

Percent of the series whose noise was taken for the other one, and of those where the answer says that the
data prefer neither and holds both; and how often the 95 % interval of the rate held the truth.
"""


def to_markdown(table: Table) -> str:
    """Page of the results."""
    header = "| --- | --- |" + " ---: |" * len(SHARES)
    shares = " | ".join(f"{100 * share:.0f} %" for share in SHARES)
    opening = _OPENING.format(scipy=scipy.__version__, sklearn=sklearn.__version__)
    lines = [*opening.splitlines(), "", f"| noise | method | {shares} |", header]
    for domain in DOMAINS:
        for name in (OURS, *PEERS):
            cells = (f"{table[domain, share].percent(name):.1f}" for share in SHARES)
            lines.append(f"| {domain} | {name} | " + " | ".join(cells) + " |")
    lines += ["", *_NOISE.splitlines(), "", f"| noise | | {shares} |", header]
    for domain in DOMAINS:
        for title, field in (
            ("mistaken", "mistaken"),
            ("undetermined", "undetermined"),
            ("coverage", "covered"),
        ):
            tallies: Iterable[Tally] = (table[domain, share] for share in SHARES)
            parts = (100.0 * getattr(tally, field) / max(tally.draws, 1) for tally in tallies)
            lines.append(f"| {domain} | {title} | " + " | ".join(f"{value:.1f}" for value in parts) + " |")
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.exponential", description=__doc__)
    docs = Path(__file__).resolve().parent.parent / "docs"
    parser.add_argument("--quick", action="store_true", help="a smoke run: one draw per cell")
    parser.add_argument("--out", type=Path, default=docs, help="folder of benchmarks_exponential.md")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    chosen = parser.parse_args(arguments)
    table = measure(0.01 if chosen.quick else 1.0, chosen.seed)
    (chosen.out / "benchmarks_exponential.md").write_text(to_markdown(table), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
