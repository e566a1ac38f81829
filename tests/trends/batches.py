"""Batches of awkward series, and the comparison of a table with fits one by one, to the bit."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import strategies as st

from estimators import NoFit, Trend, TrendTable, fit_trend

KINDS = ("plain", "gaps", "unsorted", "repeats", "rounded", "constant", "exact", "tiny", "short", "empty")


def awkward(kind: str, n: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of one kind."""
    n = {"short": int(rng.integers(1, 4)), "empty": 0}.get(kind, n)
    t = np.sort(rng.uniform(-20.0, 100.0, n))
    y = 3.0 + 0.5 * t + rng.normal(size=n)
    outlier = rng.random(n) < rng.choice([0.0, 0.3, 0.6])
    y[outlier] += rng.uniform(-40.0, 60.0, int(outlier.sum()))
    if kind == "gaps":
        y[rng.random(n) < 0.3] = np.nan
        t[rng.random(n) < 0.1] = np.nan
        y[rng.random(n) < 0.05] = np.inf
    elif kind == "unsorted":
        order = rng.permutation(n)
        t, y = t[order], y[order]
    elif kind == "repeats":
        t = np.round(t / 8.0) * 8.0
        y = np.round(y)
    elif kind == "rounded":
        y = np.round(y)
    elif kind == "constant":
        y = np.full(n, 7.0) if rng.random() < 0.5 else y
        t = t if y.size and y[0] == 7.0 else np.full(n, 2.0)
    elif kind == "exact":
        y = 2.0 - 0.25 * t
    elif kind == "tiny":
        y *= 1e-200
    return t, y


@st.composite
def batches(draw: st.DrawFn) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.random.Generator]:
    """Times, values and offsets of up to six series of any kinds, and the generator that made them."""
    kinds = draw(st.lists(st.sampled_from(KINDS), min_size=0, max_size=6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    series = [awkward(kind, int(rng.integers(2, 60)), rng) for kind in kinds]
    offsets = np.concatenate([[0], np.cumsum([t.size for t, _ in series])]).astype(np.int64)
    times = np.concatenate([t for t, _ in series]) if series else np.empty(0)
    values = np.concatenate([y for _, y in series]) if series else np.empty(0)
    return times, values, offsets, rng


def assert_same_as_alone(
    table: TrendTable, t: Any, y: Any, offsets: Any, weights: Any = None, **settings: Any
) -> None:
    """Every column, every row and every field of ``table`` is that of :func:`fit_trend`."""
    for k, (a, b) in enumerate(zip(offsets[:-1].tolist(), offsets[1:].tolist(), strict=True)):
        alone = fit_trend(t[a:b], y[a:b], weights=None if weights is None else weights[a:b], **settings)
        assert_row(table, k, alone)
        assert_equal(table[k], alone)


def assert_row(table: TrendTable, k: int, alone: Trend | NoFit) -> None:
    """Row k of the columns is that of an answer."""
    rows = slice(int(table.offsets[k]), int(table.offsets[k + 1]))
    for name in ("inlier", "probability", "residual", "reason_codes"):
        np.testing.assert_array_equal(getattr(table.points, name)[rows], getattr(alone.points, name), name)
    assert table.notices[k] == tuple(item.code.value for item in alone.notices)
    row: dict[str, Any] = {}
    if isinstance(alone, NoFit):
        assert (table.fitted[k], table.reason[k], table.message[k]) == (False, alone.reason, alone.message)
        assert np.isnat(table.origin[k]) if table.origin.dtype.kind == "M" else np.isnan(table.origin[k])
        row |= {"n": 0, "inliers": 0}
    else:
        assert (table.fitted[k], table.reason[k], table.message[k]) == (True, "", "")
        assert table.origin[k] == alone.origin
        consensus, uncertainty = alone.consensus, alone.uncertainty
        row |= {name: getattr(consensus, name) for name in ("n", "inliers", "inlier_ratio")}
        row |= {"sigma": consensus.sigma, "threshold": consensus.threshold}
        row |= {"p_value": alone.p_value, "r2": alone.r2, "rmse": alone.rmse}
        row |= {name: getattr(uncertainty, name) for name in ("effective_n", "lag1", "dof")}
    numbers = ("inlier_ratio", "sigma", "threshold", "p_value", "r2", "rmse", "effective_n", "lag1", "dof")
    for name in ("n", "inliers", *numbers):
        assert_same_number(getattr(table, name)[k], row.get(name), name)
    for name, columns in table.parameters.items():
        estimate = None if isinstance(alone, NoFit) else alone.parameters[name]
        for part in ("value", "stderr", "low", "high"):
            assert_same_number(getattr(columns, part)[k], getattr(estimate, part, None), f"{name} {part}")


def assert_same_number(number: Any, expected: Any, what: str) -> None:
    """Two numbers are equal to the bit; NaN stands for None."""
    if expected is None:
        assert np.isnan(number), what
    else:
        assert number == expected, (what, number, expected)


def assert_equal(one: Trend | NoFit, other: Trend | NoFit) -> None:
    """Two answers are equal in every field."""
    assert one.to_dict() == other.to_dict()
    if isinstance(one, Trend) and isinstance(other, Trend):
        assert repr(one.geometry) == repr(other.geometry)
        assert one.axis == other.axis
        np.testing.assert_array_equal(one.time, other.time)
        np.testing.assert_array_equal(one.values, other.values)
