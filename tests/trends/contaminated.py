"""Series with a known line and known outliers, for tests of the fit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from estimators import NoFit, Trend, fit_trend


class Contaminated(NamedTuple):
    """Ascending times, values, and which of them are outliers."""

    t: np.ndarray
    y: np.ndarray
    outlier: np.ndarray


def contaminated(n: int = 80, share: float = 0.25, seed: int = 0, slope: float = 0.5) -> Contaminated:
    """Unit noise about ``3 + slope * t`` at uneven times from 0 to 100, outliers up to 60 away."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0.0, 100.0, n))
    y = 3.0 + slope * t + rng.normal(size=n)
    outlier = rng.permutation(n) < round(share * n)
    count = int(outlier.sum())
    y[outlier] += rng.choice([-1.0, 1.0], count) * rng.uniform(8.0, 60.0, count)
    return Contaminated(t, y, outlier)


def two_lines(n: int, share: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """``share`` of the points on ``1 + 0.5 t``, the others on ``60 - 0.4 t``, mixed; noise 0.5."""
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0.0, 100.0, n))
    on_first = rng.permutation(n) < round(share * n)
    return t, np.where(on_first, 1.0 + 0.5 * t, 60.0 - 0.4 * t) + rng.normal(0.0, 0.5, n)


def fitted(*args: object, **kwargs: object) -> Trend:
    """:func:`fit_trend` where a trend is expected."""
    trend = fit_trend(*args, **kwargs)  # type: ignore[arg-type]
    assert isinstance(trend, Trend), trend.summary()
    return trend


def refused(*args: object, **kwargs: object) -> NoFit:
    """:func:`fit_trend` where none is expected."""
    answer = fit_trend(*args, **kwargs)  # type: ignore[arg-type]
    assert isinstance(answer, NoFit)
    return answer
