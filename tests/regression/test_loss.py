"""The losses that inference knows."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate, stats

from estimators.regression.loss import Loss, LossKind

SMOOTH = [
    Loss(LossKind.square),
    Loss(LossKind.huber, 1.345),
    Loss(LossKind.bisquare, 4.685),
    Loss(LossKind.rank),
]


@pytest.mark.parametrize("loss", SMOOTH, ids=lambda loss: loss.kind.name)
def test_psi_slope_is_the_derivative_of_psi(loss: Loss) -> None:
    u = np.array([-6.0, -2.0, -0.7, 0.1, 1.0, 3.0, 4.6])
    step = 1e-6
    difference = (loss.psi(u + step) - loss.psi(u - step)) / (2 * step)
    assert loss.psi_slope(u) == pytest.approx(difference, abs=1e-7)


def normal_mean(function: object) -> float:
    value, _ = integrate.quad(
        lambda u: float(function(np.array([u]))[0]) * stats.norm.pdf(u),
        -12,
        12,
        points=[-2.7, 0, 2.7],
        limit=200,  # type: ignore[operator]
    )
    return float(value)


@pytest.mark.parametrize(
    ("loss", "variance"),
    [
        (Loss(LossKind.square), 1.0),
        (Loss(LossKind.huber, 1.345), 1 / 0.95),
        (Loss(LossKind.bisquare, 4.685), 1 / 0.95),
        (Loss(LossKind.sign), np.pi / 2),
        (Loss(LossKind.rank), np.pi / 3),
        (Loss(LossKind.truncated, 2.5), 1.111),
    ],
    ids=lambda item: item.kind.name if isinstance(item, Loss) else "",
)
def test_the_sandwich_of_each_loss_has_its_published_variance_at_the_normal_law(
    loss: Loss, variance: float
) -> None:
    squared = normal_mean(lambda u: loss.psi(u) ** 2)
    slope = normal_mean(loss.psi_slope)
    assert squared / slope**2 == pytest.approx(variance, rel=1e-3)
