"""Numeric traps: the same easy series in the units that people have, which must not change the answer.

Each series (uniform outliers, 20 %, N = 200) is fitted as it is, with its times as epoch seconds,
milliseconds and nanoseconds, and with its values times 1e9 and 1e-9.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks import metrics
from benchmarks.bed import draw_rng, make_series
from benchmarks.contenders import Contender
from estimators.arrays import FloatArray

EPOCH_S = 1.7e9
"""A time of our days, in seconds since 1970."""
DAY_S = 86_400.0
KIND, N, SHARE = "uniform", 200, 0.2


@dataclass(frozen=True, slots=True)
class Units:
    """How a series is written down: times ``shift + stretch * t``, values ``scale * y``."""

    shift: float = 0.0
    stretch: float = 1.0
    scale: float = 1.0


TRAPS: Mapping[str, Units] = {
    "plain": Units(),
    "epoch s": Units(EPOCH_S, DAY_S),
    "epoch ms": Units(1e3 * EPOCH_S, 1e3 * DAY_S),
    "epoch ns": Units(1e9 * EPOCH_S, 1e9 * DAY_S),
    "y * 1e9": Units(scale=1e9),
    "y * 1e-9": Units(scale=1e-9),
}


def measure_traps(contenders: Sequence[Contender], *, seed: int, draws: int) -> FloatArray:
    """Failures in percent, shape (contenders, traps)."""
    wrong = np.zeros((len(contenders), len(TRAPS)))
    for index in range(draws):
        draw = make_series(KIND, N, SHARE, draw_rng(seed, KIND, N, SHARE, index))
        allowed = metrics.oracle(draw).stderr
        true_ends = draw.truth_intercept + draw.truth_slope * draw.t[[0, -1]]
        for column, units in enumerate(TRAPS.values()):
            t, y = units.shift + units.stretch * draw.t, units.scale * draw.y
            for row, contender in enumerate(contenders):
                ends = contender.fit(t, y, units.scale * draw.sigma).ends / units.scale
                wrong[row, column] += bool(metrics.failed(ends - true_ends, allowed))
    return np.asarray(100.0 * wrong / draws)
