"""M-estimates by reweighting."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from estimators.regression.bisquare import BISQUARE, bisquare
from estimators.regression.huber import HUBER, huber
from estimators.regression.least_squares import least_squares
from estimators.regression.loss import Loss, LossKind
from estimators.regression.reweighting import reweight


def contaminated(seed: int, n: int = 80, share: float = 0.2) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1, 1, n))
    y = 1.0 + 2.0 * t + 0.3 * rng.normal(size=n)
    bad = rng.random(n) < share
    y[bad] += rng.uniform(-8, 8, int(bad.sum()))
    return np.vstack([np.ones(n), t]), y


@pytest.mark.parametrize("seed", range(5))
def test_huber_with_the_mad_of_residuals_is_what_statsmodels_fits(seed: int) -> None:
    sm = pytest.importorskip("statsmodels.api", reason="statsmodels comes with the extra [bench]")
    columns, y = contaminated(seed)
    model = sm.RLM(y, columns.T, M=sm.robust.norms.HuberT(1.345))
    theirs = model.fit(scale_est="mad", maxiter=2000, tol=1e-13, conv="coefs")
    ours = huber(columns, y, floor=1e-12)
    assert ours.theta == pytest.approx(theirs.params, rel=1e-8)
    assert ours.sigma == pytest.approx(theirs.scale, rel=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_the_bisquare_at_a_fixed_scale_is_what_statsmodels_fits(seed: int) -> None:
    sm = pytest.importorskip("statsmodels.api", reason="statsmodels comes with the extra [bench]")
    columns, y = contaminated(seed)
    model = sm.RLM(y, columns.T, M=sm.robust.norms.TukeyBiweight(4.685))
    theirs = model.fit(scale_est="mad", update_scale=False, maxiter=2000, tol=1e-13, conv="coefs")
    start, _, _ = least_squares(columns, y)
    ours = bisquare(columns, y, start=start, sigma=float(theirs.scale), rounds=2000)
    assert ours.theta == pytest.approx(theirs.params, rel=1e-8)


def test_huber_solves_its_two_equations() -> None:
    columns, y = contaminated(7)
    fit = huber(columns, y, floor=1e-12)
    psi = HUBER.psi(fit.residual / fit.sigma)
    assert columns @ psi == pytest.approx(np.zeros(2), abs=1e-7)
    assert fit.sigma == pytest.approx(1.482602218505602 * np.median(np.abs(fit.residual)), rel=1e-9)


def test_weights_are_precisions_for_huber() -> None:
    columns, y = contaminated(3)
    weights = np.where(columns[1] < 0, 0.5, 1.5)
    weights /= weights.mean()
    fit = huber(columns, y, weights, floor=1e-12)
    psi = HUBER.psi(fit.residual * np.sqrt(weights) / fit.sigma)
    assert columns @ (np.sqrt(weights) * psi) == pytest.approx(np.zeros(2), abs=1e-7)


def test_the_bisquare_forgets_far_outliers_completely() -> None:
    columns, y = contaminated(1, share=0.0)
    near = y.copy()
    near[::7] += 100.0
    far = y.copy()
    far[::7] += 1e6
    start = np.array([1.0, 2.0])
    assert (
        bisquare(columns, near, start=start, sigma=0.3).theta.tolist()
        == bisquare(columns, far, start=start, sigma=0.3).theta.tolist()
    )


def test_reweighting_never_raises_the_bisquare_objective() -> None:
    columns, y = contaminated(5, share=0.4)
    theta = np.array([0.0, 0.0])
    losses = []
    for rounds in range(1, 12):
        fit = bisquare(columns, y, start=theta, sigma=0.5, rounds=rounds)
        u = np.clip(np.abs(fit.residual) / 0.5 / BISQUARE.tuning, 0, 1)
        losses.append(float(np.sum(1 - (1 - u**2) ** 3)))
    assert all(later <= earlier + 1e-12 for earlier, later in pairwise(losses))
    assert losses[-1] < losses[0]


@pytest.mark.parametrize("kind", [LossKind.square, LossKind.sign])
def test_losses_without_weights_are_refused(kind: LossKind) -> None:
    columns, y = contaminated(0)
    with pytest.raises(ValueError, match=kind.name):
        reweight(columns, y, None, start=np.zeros(2), loss=Loss(kind), sigma=1.0, floor=1e-12, rounds=3)


@pytest.mark.parametrize(
    "y", [np.full(6, 3.0), 1.0 + 2.0 * np.linspace(-1, 1, 6), np.zeros(6)], ids=["constant", "line", "zeros"]
)
def test_values_without_noise_are_fitted_exactly(y: np.ndarray) -> None:
    columns = np.vstack([np.ones(6), np.linspace(-1, 1, 6)])
    fit = huber(columns, y, floor=1e-15)
    assert np.abs(fit.residual).max() <= 1e-14
    assert fit.converged
