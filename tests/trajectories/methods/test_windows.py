"""RANSAC in windows: the motion of a window, the votes of windows, and labels that hang together."""

import doctest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimators.arrays import FloatArray
from estimators.trajectories.estimation import Measured, from_spans
from estimators.trajectories.hypotheses import steady_motion
from estimators.trajectories.hypotheses.coherent import cut_in_time, find_coherent_motion
from estimators.trajectories.hypotheses.steady_motion import SteadyMotion
from estimators.trajectories.hypotheses.windows import GATE, ballot, closeness, find_motion
from tests.trajectories.drives import drive, f1, with_bursts, with_spikes

WINDOWED = ("ransac", "gc-ransac")


def steady(seed: int, n: int = 20, faulty: int = 0) -> tuple[SteadyMotion, FloatArray, FloatArray]:
    rng = np.random.default_rng(seed)
    t = np.sort(rng.uniform(0.0, 30.0, n))
    fixes = np.column_stack([5.0 * t, -2.0 * t]) + rng.normal(size=(n, 2))
    fixes[:faulty] += rng.uniform(50.0, 500.0, (faulty, 2))
    return SteadyMotion(t, fixes, np.ones(n), np.inf), t, fixes


def test_the_example_of_the_model_is_true() -> None:
    found = doctest.testmod(steady_motion, extraglobs={"np": np})
    assert found.attempted > 0
    assert found.failed == 0


@given(st.integers(0, 100), st.integers(0, 18), st.integers(1, 19))
def test_a_hypothesis_goes_through_its_two_fixes(seed: int, first: int, gap: int) -> None:
    model, _, _ = steady(seed)
    pair = np.array([[first, min(first + gap, 19)]])
    theta = model.solve(pair).theta[0]
    np.testing.assert_allclose(model.residuals_at(theta, pair[0]), 0.0, atol=1e-9)


def test_residuals_of_chosen_fixes_are_the_same_bits() -> None:
    model, _, _ = steady(1)
    theta = model.solve(np.array([[2, 9]])).theta
    chosen = np.array([0, 3, 19])
    assert (
        model.residuals_at(theta[0], chosen).tobytes() == model.residuals(theta, 0, 20)[0][chosen].tobytes()
    )


def test_hypotheses_of_one_time_are_degenerate_and_too_fast_ones_invalid() -> None:
    model = SteadyMotion(
        np.array([0.0, 0.0, 1.0]), np.array([[0.0, 0.0], [9.0, 0.0], [90.0, 0.0]]), np.ones(3), 85.0
    )
    solved = model.solve(np.array([[0, 1], [0, 2], [1, 2]]))
    assert (solved.degenerate, solved.invalid, solved.owner.tolist()) == (1, 1, [2])


def test_fixes_of_one_time_fit_no_motion() -> None:
    model = SteadyMotion(np.zeros(3), np.eye(3)[:, :2], np.ones(3), np.inf)
    assert model.fit(np.arange(3), np.zeros(4)) is None


@pytest.mark.parametrize("find", [find_motion, find_coherent_motion])
def test_the_motion_of_a_window_is_found_among_faults(find: object) -> None:
    model, t, _ = steady(3, faulty=8)
    theta = find(model, t)  # type: ignore[operator]
    np.testing.assert_allclose(theta[2:], [5.0, -2.0], atol=0.3)
    assert (closeness(model, theta)[8:] > 0.5).all()


def test_alternating_cuts_and_fits_do_not_make_a_motion_worse() -> None:
    for seed in range(20):
        model, t, _ = steady(seed, faulty=9)
        first, better = find_motion(model, t), find_coherent_motion(model, t)
        assert first is not None
        assert better is not None

        def loss(theta: FloatArray, model: SteadyMotion = model) -> float:
            return float(np.minimum((model.residuals(theta[None], 0, 20)[0] / GATE) ** 2, 1.0).sum())

        assert loss(better) <= loss(first)


@pytest.mark.parametrize("method", WINDOWED)
def test_lone_faults_are_found(method: str) -> None:
    made = with_spikes(drive(0), share=0.2)
    assert f1(made.clean(method=method), made.faulty) > 0.95


@pytest.mark.parametrize("method", WINDOWED)
def test_a_burst_that_fills_its_windows_passes_as_windows_cannot_tell(method: str) -> None:
    made = with_bursts(drive(1), length=40)
    assert f1(made.clean(method=method), made.faulty) < 0.5 < f1(made.clean(), made.faulty)


@pytest.mark.parametrize("method", WINDOWED)
@pytest.mark.parametrize("fixes", [1, 2, 3, 5])
def test_few_fixes_are_good_for_want_of_others(method: str, fixes: int) -> None:
    assert drive(2, n=fixes).clean(method=method).points.inlier.all()


@pytest.mark.parametrize("method", WINDOWED)
def test_the_same_track_gives_the_same_bytes(method: str) -> None:
    made = with_spikes(drive(4))
    first, second = made.clean(method=method), made.clean(method=method)
    assert first.lat_deg.tobytes() == second.lat_deg.tobytes()
    assert first.points.probability.tobytes() == second.points.probability.tobytes()


def test_the_ballot_does_not_look_across_gaps() -> None:
    made = drive(5, n=80)
    t = made.t + np.where(made.t >= 40.0, 5000.0, 0.0)
    moved = made.fixes + np.where(made.t >= 40.0, 90_000.0, 0.0)[:, None]
    measured = Measured(t, np.ascontiguousarray(moved), None)
    assert (ballot(measured, from_spans(measured), find_motion, None) > 0.5).mean() > 0.97


@pytest.mark.parametrize(("top", "speed"), [(np.inf, 60.0), (30.0, 1.0)])
def test_the_motion_that_most_agree_to_must_not_be_too_fast(top: float, speed: float) -> None:
    t = np.arange(20.0)
    east = np.where(t % 9 < 5, 60.0 * t + 700.0, t)
    model = SteadyMotion(t, np.column_stack([east, 0.0 * t]), np.ones(20), top)
    theta = find_motion(model, t)
    assert theta is not None
    assert theta[2] == pytest.approx(speed, abs=0.1)


def test_labels_hang_together_less_the_longer_the_time_between() -> None:
    near = np.array([1.0, 1.0, 0.47, 1.0, 1.0])
    assert cut_in_time(np.arange(5.0), near).all()
    assert not cut_in_time(1000.0 * np.arange(5.0), near)[2]
