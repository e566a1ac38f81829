"""The closed methods and MM as searches: what they find, and what they say about it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators.arrays import InputError
from estimators.consensus.found import Found, LinearData, Scale, Search
from estimators.consensus.search.closed import HuberRegression, OrdinaryLeastSquares, RepeatedMedian, TheilSen
from estimators.consensus.search.mm import MMSearch
from estimators.noise import scale_floor
from estimators.options import RobustOptions
from estimators.regression import repeated_median as repeated_median_module
from estimators.regression.loss import LossKind
from estimators.result import Ledger, NoFit, NoFitReason

EVERY: dict[str, Search] = {
    "ols": OrdinaryLeastSquares(),
    "huber": HuberRegression(),
    "theil-sen": TheilSen(),
    "siegel": RepeatedMedian(),
    "mm": MMSearch(),
}
ROBUST = {name: search for name, search in EVERY.items() if name != "ols"}
CLOSED = {name: search for name, search in EVERY.items() if name != "mm"}

every = pytest.mark.parametrize("search", EVERY.values(), ids=EVERY.keys())
robust = pytest.mark.parametrize("search", ROBUST.values(), ids=ROBUST.keys())
closed = pytest.mark.parametrize("search", CLOSED.values(), ids=CLOSED.keys())


def line_data(t: np.ndarray, y: np.ndarray, weights: np.ndarray | None = None) -> LinearData:
    return LinearData(np.vstack([np.ones_like(t), t]), y, t, weights)


def estimated(y: np.ndarray) -> Scale:
    return Scale(None, "residuals", None, "sigma", scale_floor(y))


def run(
    search: Search, data: LinearData, scale: Scale | None = None, seed: int = 0, **options: float
) -> Found:
    found = search.run(data, scale or estimated(data.y), RobustOptions(**options), seed)  # type: ignore[arg-type]
    assert isinstance(found, Found)
    return found


def noisy(n: int = 120, share: float = 0.15, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(-1, 1, n))
    y = 1 + 2 * t + 0.1 * rng.normal(size=n)
    bad = rng.random(n) < share
    y[bad] += rng.uniform(3, 6, int(bad.sum()))
    return t, y, bad


@every
def test_residuals_labels_and_threshold_agree(search: Search) -> None:
    t, y, _ = noisy()
    found = run(search, line_data(t, y))
    assert found.residual == pytest.approx(y - found.theta[0] - found.theta[1] * t, abs=1e-14)
    assert found.threshold == pytest.approx(2.7 * found.sigma)
    assert found.threshold_source == "sigma"
    assert found.inlier.tolist() == (np.abs(found.residual) <= found.threshold).tolist()
    assert found.probability is None


@robust
def test_outliers_are_flagged_without_a_threshold(search: Search) -> None:
    t, y, bad = noisy()
    found = run(search, line_data(t, y))
    assert not np.any(found.inlier & bad)
    assert np.mean(found.inlier[~bad]) > 0.95
    assert found.sigma == pytest.approx(0.1, rel=0.35)


@closed
def test_closed_methods_draw_nothing(search: Search) -> None:
    t, y, _ = noisy()
    found = run(search, line_data(t, y))
    assert found.search == "closed"
    assert found.ledger == Ledger()
    assert found.sampling_probability is None
    assert not search.needs_threshold


@every
def test_a_given_sigma_and_threshold_are_kept(search: Search) -> None:
    t, y, _ = noisy()
    found = run(search, line_data(t, y), Scale(0.2, "given", 0.5, "given", 1e-15))
    assert (found.sigma, found.sigma_source) == (0.2, "given")
    assert (found.threshold, found.threshold_source) == (0.5, "given")


@every
@pytest.mark.parametrize("n", [2, 3, 50])
def test_a_line_without_noise_is_found_exactly(search: Search, n: int) -> None:
    t = np.linspace(-1, 1, n)
    found = run(search, line_data(t, 1 + 2 * t))
    assert found.theta == pytest.approx([1.0, 2.0], abs=1e-14)
    assert np.all(found.inlier)
    assert found.sigma_source == "floor"


@every
@pytest.mark.parametrize("value", [0.0, 3.7, -1e-9])
def test_constant_values_are_all_inliers_of_a_level_line(search: Search, value: float) -> None:
    t = np.linspace(-1, 1, 30)
    found = run(search, line_data(t, np.full(30, value)))
    assert found.theta == pytest.approx([value, 0.0], abs=1e-15 * max(1, abs(value)))
    assert np.all(found.inlier)


@every
def test_heavily_tied_times_are_no_obstacle(search: Search) -> None:
    rng = np.random.default_rng(1)
    t = np.repeat([-1.0, 0.0, 1.0], 20)
    y = 1 + 2 * t + 0.1 * rng.normal(size=60)
    assert run(search, line_data(t, y)).theta == pytest.approx([1.0, 2.0], abs=0.1)


@every
def test_repeating_every_point_moves_the_line_hardly(search: Search) -> None:
    t, y, _ = noisy(n=40)
    once = run(search, line_data(t, y))
    twice = run(search, line_data(np.repeat(t, 2), np.repeat(y, 2)), work_budget=10**7)
    assert twice.theta == pytest.approx(once.theta, abs=0.02)


@every
@pytest.mark.parametrize(
    ("t", "reason"),
    [
        (np.empty(0), NoFitReason.no_data),
        (np.zeros(1), NoFitReason.too_few_points),
        (np.full(5, 0.3), NoFitReason.constant_time),
    ],
    ids=["none", "one", "one time"],
)
def test_data_that_determine_no_line_are_refused_with_the_reason(
    search: Search, t: np.ndarray, reason: NoFitReason
) -> None:
    data = line_data(t, np.arange(float(t.size)))
    answer = search.run(data, Scale(None, "residuals", None, "sigma", 1e-15), RobustOptions(), 0)
    assert isinstance(answer, NoFit)
    assert answer.reason is reason
    assert answer.points.inlier.size == t.size


@pytest.mark.parametrize("search", [TheilSen(), RepeatedMedian()], ids=["theil-sen", "siegel"])
def test_median_lines_refuse_weights_and_name_the_methods_that_take_them(search: Search) -> None:
    t, y, _ = noisy()
    data = line_data(t, y, np.ones_like(t))
    with pytest.raises(InputError, match="ols, huber, mm") as caught:
        search.run(data, estimated(y), RobustOptions(), 0)
    assert caught.value.field == "weights"


@pytest.mark.parametrize("search", [TheilSen(), RepeatedMedian()], ids=["theil-sen", "siegel"])
def test_median_lines_refuse_other_models(search: Search) -> None:
    t, y, _ = noisy()
    data = LinearData(np.vstack([np.ones_like(t), t, t**2]), y, t, None)
    with pytest.raises(InputError, match="lines only"):
        search.run(data, estimated(y), RobustOptions(), 0)


@pytest.mark.parametrize(
    "search", [OrdinaryLeastSquares(), HuberRegression(), MMSearch()], ids=["ols", "huber", "mm"]
)
def test_weighted_methods_whiten_their_labels(search: Search) -> None:
    rng = np.random.default_rng(3)
    t = np.linspace(-1, 1, 200)
    weights = np.where(np.arange(200) % 2 == 0, 0.02, 1.98)
    y = 1 + 2 * t + 0.1 * rng.normal(size=200) / np.sqrt(weights)
    found = run(search, line_data(t, y, weights))
    assert found.sigma == pytest.approx(0.1, rel=0.2)
    assert found.inlier.tolist() == (np.abs(found.residual) * np.sqrt(weights) <= found.threshold).tolist()
    assert np.mean(found.inlier) > 0.95


@pytest.mark.parametrize(
    ("search", "kind"),
    [
        (OrdinaryLeastSquares(), LossKind.square),
        (HuberRegression(), LossKind.huber),
        (TheilSen(), LossKind.rank),
        (RepeatedMedian(), LossKind.sign),
        (MMSearch(), LossKind.bisquare),
    ],
    ids=lambda item: item.name if isinstance(item, LossKind) else "",
)
def test_each_search_names_the_loss_that_inference_should_use(search: Search, kind: LossKind) -> None:
    t, y, _ = noisy()
    assert run(search, line_data(t, y)).loss.kind is kind


@pytest.mark.parametrize(
    "search", [OrdinaryLeastSquares(), HuberRegression(), MMSearch()], ids=["ols", "huber", "mm"]
)
def test_the_named_loss_is_stationary_at_the_answer(search: Search) -> None:
    t, y, _ = noisy()
    found = run(search, line_data(t, y))
    gradient = np.vstack([np.ones_like(t), t]) @ found.loss.psi(found.residual / found.sigma)
    assert gradient == pytest.approx([0.0, 0.0], abs=1e-7)


def test_least_squares_has_the_unbiased_variance() -> None:
    t, y, _ = noisy(share=0.0)
    found = run(OrdinaryLeastSquares(), line_data(t, y))
    assert found.sigma == pytest.approx(np.sqrt(np.sum(found.residual**2) / 118))
    assert found.sigma_source == "residuals"


def test_mm_tries_all_pairs_within_the_work_budget_whatever_the_seed() -> None:
    t, y, _ = noisy(n=60)
    first, second = (run(MMSearch(), line_data(t, y), seed=seed) for seed in (1, 2))
    assert first.search == "exhaustive"
    assert first.ledger.drawn == 60 * 59 // 2
    assert first.sampling_probability == 1.0
    assert first.theta.tolist() == second.theta.tolist()
    assert first.sigma_source == "s-estimate"


def test_mm_samples_beyond_the_work_budget_and_reports_the_exact_probability() -> None:
    t, y, _ = noisy(n=300, share=0.4)
    found = run(MMSearch(starts=5), line_data(t, y), seed=7)
    inliers = int(found.inlier.sum())
    clean = inliers * (inliers - 1) / (300 * 299)
    assert found.search == "sampled"
    assert found.ledger.drawn == 5
    assert found.sampling_probability == pytest.approx(1 - (1 - clean) ** 5)


def test_the_same_seed_gives_the_same_bytes() -> None:
    t, y, _ = noisy(n=300, share=0.4)
    first, second = (run(MMSearch(), line_data(t, y), seed=5) for _ in range(2))
    assert first.theta.tobytes() == second.theta.tobytes()
    assert first.residual.tobytes() == second.residual.tobytes()


def test_degenerate_samples_are_counted_as_draws() -> None:
    t = np.repeat([-1.0, 0.5, 1.0], 10)
    found = run(MMSearch(), line_data(t, 1 + 2 * t))
    assert found.ledger.drawn == 435
    assert found.ledger.degenerate == 3 * 45
    assert found.ledger.scored == 435 - 135


def test_mm_fits_models_of_more_coefficients() -> None:
    rng = np.random.default_rng(0)
    t = np.linspace(-1, 1, 100)
    y = 1 + 2 * t - 3 * t**2 + 0.05 * rng.normal(size=100)
    y[::4] = 20.0
    found = run(MMSearch(), LinearData(np.vstack([np.ones_like(t), t, t**2]), y, t, None))
    assert found.theta == pytest.approx([1.0, 2.0, -3.0], abs=0.1)


def test_siegel_beyond_its_reach_is_no_fit_with_advice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(repeated_median_module, "MAX_POINTS", 100)
    t, y, _ = noisy()
    answer = RepeatedMedian().run(line_data(t, y), estimated(y), RobustOptions(), 0)
    assert isinstance(answer, NoFit)
    assert answer.reason is NoFitReason.too_large
    assert "theil-sen" in answer.message


@robust
@given(seed=st.integers(0, 500), power=st.integers(-30, 30))
@settings(deadline=None, max_examples=15)
def test_scaling_the_values_by_a_power_of_two_scales_the_answer_exactly(
    search: Search, seed: int, power: int
) -> None:
    t, y, _ = noisy(n=30, seed=seed)
    once, again = run(search, line_data(t, y)), run(search, line_data(t, 2.0**power * y))
    assert again.theta.tolist() == (2.0**power * once.theta).tolist()
    assert again.sigma == 2.0**power * once.sigma
    assert again.inlier.tolist() == once.inlier.tolist()
