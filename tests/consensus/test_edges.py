"""Data at the edge: no noise, no variation, hardly any points, repeated points, extreme magnitudes."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from estimators.arrays import InputError
from estimators.consensus.cancellation import Cancelled, cancel_flag, cancelled_by
from estimators.consensus.found import LinearData, Scale
from estimators.consensus.search.sampling import SamplingSearch
from estimators.options import RobustOptions
from estimators.regression.loss import LossKind
from estimators.result import NoFit, NoFitReason
from tests.consensus.contaminated import SAMPLING, contaminated, found, given

every_sampling_preset = pytest.mark.parametrize("search", SAMPLING.values(), ids=SAMPLING.keys())
both_searches = pytest.mark.parametrize("budget", [0, 10**7], ids=["sampled", "enumerated"])


def line(t: list[float] | np.ndarray, y: list[float] | np.ndarray) -> LinearData:
    times = np.asarray(t, dtype=float)
    return LinearData(np.array([np.ones_like(times), times]), np.asarray(y, dtype=float), times, None)


@every_sampling_preset
@both_searches
def test_without_noise_the_line_is_found_exactly(search: SamplingSearch, budget: int) -> None:
    t = np.linspace(-1.0, 1.0, 60)
    y = np.where(np.arange(60) % 3 == 0, 7.0, 0.1 + 0.3 * t)
    result = found(search.run(line(t, y), given(1e-6), RobustOptions(work_budget=budget), 0))
    np.testing.assert_allclose(result.theta, [0.1, 0.3], rtol=0, atol=1e-15)
    assert (result.inlier == (y < 7.0)).all()
    assert result.sigma <= 1e-12
    assert result.sigma_source in ("floor", "residuals")


@every_sampling_preset
def test_a_threshold_of_zero_still_accepts_what_rounding_leaves(search: SamplingSearch) -> None:
    t = np.linspace(-1.0, 1.0, 50)
    result = found(search.run(line(t, 0.1 + t / 3.0), given(0.0), RobustOptions(), 0))
    assert result.inlier.all()
    assert 0.0 < result.threshold < 1e-14


@every_sampling_preset
@both_searches
@pytest.mark.parametrize("level", [0.0, 1.0, -3e7])
def test_equal_values_give_a_level_line(search: SamplingSearch, budget: int, level: float) -> None:
    data = line(np.linspace(-1.0, 1.0, 30), np.full(30, level))
    result = found(search.run(data, given(0.0), RobustOptions(work_budget=budget), 0))
    assert result.theta.tolist() == [level, 0.0]
    assert result.inlier.all()


@every_sampling_preset
def test_two_points_determine_the_line(search: SamplingSearch) -> None:
    result = found(search.run(line([-1.0, 1.0], [0.0, 1.0]), given(0.1), RobustOptions(), 0))
    assert result.theta.tolist() == [0.5, 0.5]
    assert result.inlier.all()
    assert result.sigma == 1e-12


@every_sampling_preset
def test_of_three_points_two_can_outvote_one(search: SamplingSearch) -> None:
    result = found(search.run(line([-1.0, 0.0, 1.0], [0.0, 0.0, 5.0]), given(0.1), RobustOptions(), 0))
    assert int(result.inlier.sum()) == 2


@every_sampling_preset
@pytest.mark.parametrize("n", [0, 1])
def test_fewer_points_than_coefficients_are_no_fit(search: SamplingSearch, n: int) -> None:
    result = search.run(line(np.zeros(n), np.ones(n)), given(0.1), RobustOptions(), 0)
    assert isinstance(result, NoFit)
    assert result.reason is NoFitReason.too_few_points
    assert result.points.inlier.shape == (n,)


@every_sampling_preset
@both_searches
def test_points_that_do_not_determine_a_line_are_no_fit(search: SamplingSearch, budget: int) -> None:
    data = line(np.zeros(20), np.arange(20.0))
    result = search.run(data, given(0.1), RobustOptions(max_hypotheses=300, work_budget=budget), 0)
    assert isinstance(result, NoFit)
    assert result.reason is NoFitReason.no_consensus


@every_sampling_preset
@both_searches
def test_repeated_points_are_degenerate_samples_and_count_as_draws(
    search: SamplingSearch, budget: int
) -> None:
    t = np.repeat(np.linspace(-1.0, 1.0, 10), 6)
    result = found(search.run(line(t, 0.5 * t), given(0.01), RobustOptions(work_budget=budget), 0))
    assert result.inlier.all()
    assert result.ledger.degenerate + result.ledger.scored == result.ledger.drawn
    if result.search == "exhaustive":
        assert result.ledger.degenerate == 10 * 15


@every_sampling_preset
@pytest.mark.parametrize("magnitude", [1e-140, 1e-9, 1e9, 1e150, 1e300])
def test_extreme_magnitudes_change_the_units_and_nothing_else(
    search: SamplingSearch, magnitude: float
) -> None:
    data = contaminated(200, 4)
    scaled = LinearData(data.columns, magnitude * data.y, data.t, None)
    plain = found(search.run(data, given(0.03), RobustOptions(), 0))
    moved = found(search.run(scaled, given(magnitude * 0.03), RobustOptions(), 0))
    np.testing.assert_allclose(moved.theta / magnitude, plain.theta, rtol=1e-12)
    assert (moved.inlier == plain.inlier).all()


@pytest.mark.parametrize("name", ["ransac", "fischler-bolles", "msac", "lo-ransac"])
@pytest.mark.parametrize("seed", range(5))
def test_a_weight_multiplies_the_residual_of_its_point_by_its_root(name: str, seed: int) -> None:
    data = contaminated(250, seed, weighted=True)
    assert data.weights is not None
    root = np.sqrt(data.weights)
    whitened = LinearData(data.columns * root, data.y * root, data.t, None)
    a = found(SAMPLING[name].run(data, given(0.03), RobustOptions(), seed))
    b = found(SAMPLING[name].run(whitened, given(0.03), RobustOptions(), seed))
    np.testing.assert_allclose(a.theta, b.theta, rtol=0, atol=1e-12)
    assert (a.inlier == b.inlier).all()


def test_a_known_sigma_is_kept_and_sets_the_cut_of_the_loss() -> None:
    scale = Scale(0.02, "given", 0.05, "sigma", 1e-12)
    result = found(SAMPLING["msac"].run(contaminated(150, 2), scale, RobustOptions(), 0))
    assert (result.sigma, result.sigma_source, result.threshold_source) == (0.02, "given", "sigma")
    assert result.loss.kind is LossKind.truncated
    assert result.loss.tuning == pytest.approx(2.5)


@pytest.mark.parametrize("cut", [1.5, 2.0, 2.7, 4.0])
def test_the_scale_of_the_inliers_is_corrected_for_the_cut(cut: float) -> None:
    data = contaminated(20_000, 5, outliers=0.0, sigma=0.01)
    result = found(SAMPLING["msac"].run(data, given(cut * 0.01), RobustOptions(), 0))
    assert result.sigma == pytest.approx(0.01, rel=0.04)
    assert result.sigma_source == "residuals"


def test_a_method_that_counts_inliers_asks_for_a_threshold() -> None:
    with pytest.raises(InputError, match="threshold"):
        SAMPLING["ransac"].run(contaminated(30, 0), Scale(None, "", None, "sigma", 1e-12), RobustOptions(), 0)


@every_sampling_preset
@pytest.mark.parametrize("execution", ["compiled", "readable"])
def test_a_set_flag_ends_the_search(search: SamplingSearch, execution: str) -> None:
    import dataclasses

    running = dataclasses.replace(search, execution=execution)
    with cancelled_by(np.ones(1, dtype=np.uint8)), pytest.raises(Cancelled):
        running.run(contaminated(300, 0), given(0.03), RobustOptions(), 0)


def test_a_flag_set_from_another_thread_ends_a_search_that_would_take_hours() -> None:
    endless = RobustOptions(min_hypotheses=10**7, max_hypotheses=10**7)
    flag = np.zeros(1, dtype=np.uint8)
    data = contaminated(200_000, 0)
    SAMPLING["ransac"].run(contaminated(300, 0), given(0.03), RobustOptions(), 0)
    timer = threading.Timer(0.05, flag.fill, args=(1,))
    timer.start()
    with cancelled_by(flag), pytest.raises(Cancelled):
        SAMPLING["ransac"].run(data, given(0.03), endless, 0)
    timer.join()


def test_outside_the_context_nothing_is_cancelled() -> None:
    with cancelled_by(np.ones(1, dtype=np.uint8)):
        assert cancel_flag()[0] == 1
    assert cancel_flag()[0] == 0
