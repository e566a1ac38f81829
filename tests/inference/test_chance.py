"""Whether chance alone would have shown as good a line."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.inference.chance import chance_of_line


def test_the_bound_holds_for_scattered_points() -> None:
    """Share of scattered series that have some pair with so many followers, against the bound."""
    rng = np.random.default_rng(0)
    n, threshold, wanted = 20, 0.5, 8
    first, second = np.triu_indices(n, 1)
    t = np.arange(float(n))
    hits, bounds = 0, []
    for _ in range(300):
        y = rng.uniform(-10.0, 10.0, n)
        slope = (y[second] - y[first]) / (t[second] - t[first])
        off = np.abs(y[None, :] - y[first, None] - slope[:, None] * (t[None, :] - t[first, None]))
        hits += bool(((off <= threshold).sum(axis=1) >= wanted).any())
        bounds.append(chance_of_line(y, wanted, threshold))
    assert hits / 300 <= np.mean(bounds) + 0.02


@pytest.mark.parametrize("inliers", [40, 50])
def test_where_nearly_all_points_follow_no_choice_was_made(inliers: int) -> None:
    assert chance_of_line(np.linspace(-3.0, 3.0, 50), inliers, 3.0) == 0.0


def test_more_followers_are_less_likely_chance() -> None:
    values = np.random.default_rng(1).uniform(-60.0, 60.0, 100)
    chances = [chance_of_line(values, inliers, 2.7) for inliers in (10, 20, 30, 60)]
    assert chances[0] == 1.0
    assert chances[0] >= chances[1] > chances[2] > chances[3]


def test_one_gross_error_does_not_make_a_chance_line_credible() -> None:
    values = np.random.default_rng(2).normal(size=80)
    values[0] = 1e6
    assert chance_of_line(values, 8, 0.03) > 0.5
