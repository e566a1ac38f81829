"""A trend put together by hand, so that what is said about it can be checked against known numbers."""

from __future__ import annotations

from typing import Any

import numpy as np

from estimators.arrays import Reason
from estimators.inference.intervals import student_quantile
from estimators.notices import Notice
from estimators.result import Consensus, Estimate, Ledger, Points, Uncertainty
from estimators.time_axis import TimeAxis
from estimators.trends.curve import LineGeometry
from estimators.trends.trend import RunnerUp, Trend


def made_trend(
    time: Any,
    values: Any,
    *,
    slope: float,
    level: float,
    sigma: float = 0.5,
    outliers: tuple[int, ...] = (),
    dof: float | None = 8.0,
    notices: tuple[Notice, ...] = (),
    runner_up: RunnerUp | None = None,
    predict: Any = None,
    **consensus: Any,
) -> Trend:
    """Trend ``level + slope * (time - first time)``, with standard errors of sigma / 10 and slope / 20.

    Rows without a time or a value are missing; ``outliers`` are rows. Further arguments replace fields of
    the consensus.
    """
    time, values = np.asarray(time), np.asarray(values, dtype=np.float64)
    dates = time.dtype.kind == "M"
    known = ~np.isnat(time) if dates else np.isfinite(time)
    first = time[known].min()
    axis = TimeAxis("datetime" if dates else "number", np.datetime64(first, "ns") if dates else first.item())
    internal = axis.to_internal(time)
    used = known & np.isfinite(values)
    codes = np.where(used, Reason.ok, Reason.missing).astype(np.uint8)
    codes[list(outliers)] = Reason.outlier
    inlier = codes == Reason.ok
    residual = np.where(used, values - level - slope * internal, np.nan)
    center = float(internal[inlier].mean())
    level_error, slope_error = (sigma / 10, abs(slope) / 20) if dof is not None else (None, None)
    quantile = student_quantile(0.95, dof)
    origin = axis.origin if dates else 0.0
    intercept = level if dates else level - slope * float(axis.origin)

    def estimate(value: float, stderr: float | None) -> Estimate:
        if stderr is None:
            return Estimate(value, None, None, None)
        return Estimate(value, stderr, value - quantile * stderr, value + quantile * stderr)

    facts: dict[str, Any] = {
        "method": "auto",
        "n": int(used.sum()),
        "inliers": int(inlier.sum()),
        "inlier_ratio": float(inlier.sum() / used.sum()),
        "threshold": 2.7 * sigma,
        "threshold_source": "sigma",
        "sigma": sigma,
        "sigma_source": "mixture",
        "ledger": Ledger(drawn=500, scored=490, degenerate=10),
        "sampling_probability": 0.9999999,
        "search": "sampled",
        "seed": 0,
    }
    trend = Trend(
        model="line",
        parameters={"slope": estimate(slope, slope_error), "intercept": estimate(intercept, level_error)},
        origin=origin,
        points=Points(inlier, np.where(used, np.where(inlier, 0.97, 0.01), np.nan), residual, codes),
        consensus=Consensus(**(facts | consensus)),
        uncertainty=Uncertainty("none" if dof is None else "effective-n", 0.95, 7.5, 0.25, dof),
        p_value=None if dof is None else 3.2e-7,
        r2=0.987,
        rmse=0.44,
        runner_up=runner_up,
        notices=notices,
        axis=axis,
        geometry=LineGeometry(
            center=center,
            level=level + slope * center,
            slope=slope,
            level_stderr=np.nan if level_error is None else level_error,
            slope_stderr=np.nan if slope_error is None else slope_error,
            sigma=sigma,
            span=(0.0, float(internal[used].max())),
        ),
        time=time,
        values=values,
    )
    if predict is None:
        return trend
    from dataclasses import replace

    return replace(trend, prediction=trend.predict(predict))


def daily(count: int, start: str = "2024-01-01") -> np.ndarray[Any, np.dtype[np.datetime64]]:
    """Midnights, one per day."""
    return np.datetime64(start, "ns") + np.arange(count) * np.timedelta64(1, "D")
