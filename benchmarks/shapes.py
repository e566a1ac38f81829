"""``python -m benchmarks.shapes``: how often ``model="auto"`` answers with the shape a series was made of.

Noise has scale 1. A line rises or falls by 10 noise scales over the span; a parabola's ends are 10 from its
middle; an exponential grows or falls by a factor of e to e^3 and is 40 where it is largest, its noise the
same everywhere or 10 % of the level; a season has an amplitude of 3 about a line, and its period is to be
found. Times are those of the bed of lines, one long gap included; outliers are uniform within
±60 noise scales or err to one side.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from benchmarks.bed import draw_rng
from benchmarks.kinds import KINDS, SPAN
from estimators import Trend, fit_trend
from estimators.arrays import FloatArray

SHARES = (0.0, 0.2, 0.4)
DRAWS: Mapping[int, int] = {30: 100, 100: 60, 300: 40, 1000: 20}
OUTLIERS = ("uniform", "shift")
RISE, BEND, LARGEST, AMPLITUDE = 10.0, 5.0, 40.0, 3.0
CYCLES = 9.0
CLEAN_DRAWS = 4
"""Times as many draws of a clean level, whose share of false trends has a limit."""
_CORRELATION = 0.6
_NEAR = 0.02


@dataclass(frozen=True, slots=True)
class Shape:
    """A shape of series.

    Attributes
    ----------
    name : str
        As the page has it.
    model : str
        What ``auto`` should answer.
    seasonal : bool
        Whether it has a season, which is to be found.
    """

    name: str
    model: str
    seasonal: bool = False


SHAPES = (
    Shape("level", "constant"),
    Shape("level, AR(1) noise of 0.6", "constant"),
    Shape("line", "line"),
    Shape("parabola", "linear"),
    Shape("exponential", "exponential"),
    Shape("exponential, multiplicative noise", "exponential"),
    Shape("line with a season", "line", seasonal=True),
)


def make_series(
    shape: Shape, kind: str, n: int, share: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Draw a series.

    Parameters
    ----------
    shape : Shape
    kind : str
        Of the outliers, one of ``OUTLIERS``.
    n : int
    share : float
        Of outliers.
    rng : numpy.random.Generator

    Returns
    -------
    t, y : ndarray of float64, shape (n,)

    Examples
    --------
    >>> t, y = make_series(SHAPES[2], "uniform", 50, 0.0, np.random.default_rng(1))
    >>> 5.0 < abs(np.polyfit(t, y, 1)[0]) * SPAN < 15.0
    True
    """
    made = KINDS[kind](n, round(share * n), rng)
    t, u, sign = made.t, 2.0 * made.t / SPAN - 1.0, float(rng.choice([-1.0, 1.0]))
    if shape.name.startswith("exponential"):
        rate = sign * rng.uniform(1.0, 3.0) / SPAN
        curve = LARGEST * np.exp(rate * t - max(rate * SPAN, 0.0))
        multiplicative = shape.name != "exponential"
        return t, curve * np.exp(0.1 * made.offset) if multiplicative else curve + made.offset
    offset = made.offset
    if shape.name.startswith("level,"):
        offset = offset + _wander(offset.size, rng) * made.inlier
    curve = {
        "constant": np.zeros(n),
        "line": 0.5 * sign * RISE * u,
        "linear": sign * BEND * (2.0 * u**2 - 1.0),
    }[shape.model]
    if shape.seasonal:
        curve = curve + AMPLITUDE * np.cos(2.0 * np.pi * CYCLES * t / SPAN + rng.uniform(0.0, 2.0 * np.pi))
    return t, curve + offset


def _wander(n: int, rng: np.random.Generator) -> FloatArray:
    """First-order autoregression of scale 1."""
    made = rng.normal(size=n)
    for i in range(1, n):
        made[i] = _CORRELATION * made[i - 1] + np.sqrt(1.0 - _CORRELATION**2) * made[i]
    return made


def is_told(shape: Shape, t: FloatArray, y: FloatArray) -> bool:
    """Whether ``auto`` answers with the shape, and with its season."""
    trend = fit_trend(t, y, model="auto", seasonal="auto" if shape.seasonal else None)
    if not isinstance(trend, Trend) or trend.model != shape.model:
        return False
    periods = [season.period for season in trend.seasons]
    return not shape.seasonal or (len(periods) == 1 and abs(periods[0] * CYCLES / SPAN - 1.0) < _NEAR)


Table: TypeAlias = dict[tuple[str, int, float], float]


def measure(scale: float, seed: int, shapes: Sequence[Shape] = SHAPES) -> Table:
    """Percent of the series whose shape is told, by shape, size and share of outliers.

    Parameters
    ----------
    scale : float
        Multiplies the draws.
    seed : int
    shapes : sequence of Shape
    """
    table: Table = {}
    for shape in shapes:
        for n, draws in DRAWS.items():
            for share in SHARES:
                many = CLEAN_DRAWS if shape.model == "constant" and share == 0.0 else 1
                count = max(2, round(scale * draws * many))
                told = 0
                for index in range(count):
                    kind = OUTLIERS[index % len(OUTLIERS)]
                    rng = draw_rng(seed, f"{shape.name} {kind}", n, share, index)
                    told += is_told(shape, *make_series(shape, kind, n, share, rng))
                table[shape.name, n, share] = 100.0 * told / count
    return table


_PAGE = """# Benchmarks: shapes

Every figure on this page was measured by `python -m benchmarks.shapes`, which rewrites it.

Percent of the series for which `model="auto"` answers with the shape they were made of, by the number of
points and the share of outliers. Noise has scale 1. A line rises or falls by 10 noise scales over the span;
a parabola's ends are 10 from its middle; an exponential grows or falls by a factor of e to e^3 and is 40
where it is largest, its noise the same everywhere or a tenth of the level; a season has an amplitude of 3,
and counts when its period is found to 2 %. Outliers are uniform within ±60 noise scales or err to one side
(those of the [line's bed](benchmarks.md)), and multiply where the noise does.

What a level lacks to 100 % are trends seen where there is none.
"""


def to_markdown(table: Table, shapes: Sequence[Shape] = SHAPES) -> str:
    """Page of the results."""
    sizes = " | ".join(f"N = {n}, {100 * share:.0f} %" for n in DRAWS for share in SHARES)
    lines = [*_PAGE.splitlines(), "", f"| series | {sizes} |"]
    lines.append("| --- |" + " ---: |" * (len(DRAWS) * len(SHARES)))
    for shape in shapes:
        cells = (f"{table[shape.name, n, share]:.0f}" for n in DRAWS for share in SHARES)
        lines.append(f"| {shape.name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Command line."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.shapes", description=__doc__)
    docs = Path(__file__).resolve().parent.parent / "docs"
    parser.add_argument("--quick", action="store_true", help="a smoke run: two draws per cell")
    parser.add_argument("--out", type=Path, default=docs, help="folder of benchmarks_shapes.md")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draws (default 1)")
    chosen = parser.parse_args(arguments)
    table = measure(0.01 if chosen.quick else 1.0, chosen.seed)
    (chosen.out / "benchmarks_shapes.md").write_text(to_markdown(table), encoding="utf-8")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
