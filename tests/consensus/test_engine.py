"""The readable engine on a model that is not linear: a circle through points of the plane."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from estimators.arrays import FloatArray, IntArray
from estimators.consensus import engine
from estimators.consensus.outcome import Outcome
from estimators.consensus.protocols import Model, Solved
from estimators.consensus.search.sampling import SamplingSearch
from estimators.options import RobustOptions
from tests.consensus.contaminated import SAMPLING

CENTRE_AND_RADIUS = np.array([0.4, -1.2, 2.0])


class Circle:
    """Centre and radius; residuals are distances from the circle, outwards positive."""

    p = 3
    sample_size = 3
    resolution = 1e-12

    def __init__(self, x: FloatArray, y: FloatArray) -> None:
        self.x, self.y, self.n = x, y, x.size

    def solve(self, samples: IntArray) -> Solved:
        models, owners = [], []
        for k, chosen in enumerate(samples):
            design = np.column_stack((2.0 * self.x[chosen], 2.0 * self.y[chosen], np.ones(3)))
            if abs(np.linalg.det(design)) < 1e-9:
                continue
            a, b, c = np.linalg.solve(design, self.x[chosen] ** 2 + self.y[chosen] ** 2)
            models.append([a, b, np.sqrt(c + a * a + b * b)])
            owners.append(k)
        theta = np.array(models).reshape(len(models), 3)
        return Solved(theta, np.array(owners, dtype=np.int64), len(samples) - len(models), 0)

    def residuals(self, theta: FloatArray, start: int, stop: int) -> FloatArray:
        x, y = self.x[start:stop], self.y[start:stop]
        return np.hypot(x - theta[:, :1], y - theta[:, 1:2]) - theta[:, 2:]

    def residuals_at(self, theta: FloatArray, points: IntArray) -> FloatArray:
        return np.hypot(self.x[points] - theta[0], self.y[points] - theta[1]) - theta[2]

    def fit(self, members: IntArray, theta: FloatArray) -> FloatArray | None:
        for _ in range(3):
            dx, dy = self.x[members] - theta[0], self.y[members] - theta[1]
            distance = np.hypot(dx, dy)
            jacobian = np.column_stack((-dx / distance, -dy / distance, -np.ones(members.size)))
            step, _, rank, _ = np.linalg.lstsq(jacobian, theta[2] - distance, rcond=None)
            if rank < 3:
                return None
            theta = theta + step
        return theta


def points_near_a_circle(n: int, seed: int) -> Model:
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, 2.0 * np.pi, n)
    radius = CENTRE_AND_RADIUS[2] + rng.normal(0.0, 0.01, n)
    x, y = CENTRE_AND_RADIUS[0] + radius * np.cos(angle), CENTRE_AND_RADIUS[1] + radius * np.sin(angle)
    wild = rng.uniform(size=n) < 0.3
    x[wild], y[wild] = rng.uniform(-4.0, 4.0, (2, int(wild.sum())))
    return Circle(x, y)


def outcome(model: Model, search: SamplingSearch, **options: int) -> Outcome:
    result = engine.search(model, search, 0.03, RobustOptions(**options), seed=0)
    assert result is not None
    return result


@pytest.mark.parametrize("search", SAMPLING.values(), ids=SAMPLING.keys())
def test_every_sampling_preset_finds_the_circle(search: SamplingSearch) -> None:
    result = outcome(points_near_a_circle(150, 1), search)
    np.testing.assert_allclose(result.theta, CENTRE_AND_RADIUS, rtol=0, atol=0.01)
    assert not result.exhaustive
    assert result.inlier.sum() == result.value.inliers


def test_few_points_are_searched_exhaustively() -> None:
    model = points_near_a_circle(16, 2)
    result = outcome(model, SAMPLING["ransac"])
    subsets = list(itertools.combinations(range(16), 3))
    residual = model.residuals(model.solve(np.array(subsets)).theta, 0, 16)
    assert result.exhaustive
    assert result.ledger.drawn == len(subsets)
    assert result.value.inliers >= (np.abs(residual) <= 0.03).sum(axis=1).max() - 1


def test_collinear_points_have_no_circle() -> None:
    x = np.linspace(0.0, 1.0, 12)
    assert engine.search(Circle(x, 2.0 * x), SAMPLING["msac"], 0.03, RobustOptions(), seed=0) is None
