import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.bed import ALL_KINDS, FAMILIES, KINDS, Draw, draw_rng, make_series, true_inliers
from benchmarks.families import ar1_noise
from benchmarks.kinds import excursion_levels

KIND_NAMES = sorted(ALL_KINDS)


def _draw(kind: str, n: int = 200, share: float = 0.4, index: int = 0) -> Draw:
    return make_series(kind, n, share, draw_rng(3, kind, n, share, index))


def _offsets(draw: Draw) -> np.ndarray:
    return draw.y - draw.truth_intercept - draw.truth_slope * draw.t


def _outlier_runs(draw: Draw) -> int:
    return int(np.count_nonzero(np.diff(np.concatenate(([True], draw.inlier_mask)).astype(int)) == -1))


@given(
    kind=st.sampled_from(sorted(set(KIND_NAMES) - {"step"})),
    n=st.integers(10, 300),
    share=st.floats(0.0, 0.9),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_series_has_exactly_the_asked_share_of_outliers(kind: str, n: int, share: float, seed: int) -> None:
    draw = make_series(kind, n, share, np.random.default_rng(seed))
    assert np.count_nonzero(~draw.inlier_mask) == round(share * n)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.8])
@pytest.mark.parametrize("kind", ["uniform", "step"])
def test_the_number_of_true_inliers_is_known_beforehand(kind: str, share: float) -> None:
    counts = [_draw(kind, n=500, share=share, index=index).inlier_mask.sum() for index in range(40)]
    assert np.mean(counts) == pytest.approx(true_inliers(kind, 500, share), abs=5.0)


@given(kind=st.sampled_from(KIND_NAMES), n=st.integers(10, 300), share=st.floats(0.0, 0.9))
def test_times_ascend_over_the_whole_span_and_values_are_finite(kind: str, n: int, share: float) -> None:
    draw = make_series(kind, n, share, np.random.default_rng(n))
    assert np.all(np.diff(draw.t) >= 0)
    assert draw.t[0] == 0.0
    assert draw.t[-1] == pytest.approx(100.0)
    assert np.all(np.isfinite(draw.y))


@pytest.mark.parametrize("kind", KIND_NAMES)
def test_a_draw_depends_on_its_cell_and_index_alone(kind: str) -> None:
    first, again, other = _draw(kind), _draw(kind), _draw(kind, index=1)
    assert first.y.tobytes() == again.y.tobytes()
    assert first.y.tobytes() != other.y.tobytes()


@pytest.mark.parametrize("kind", sorted(set(KIND_NAMES) - {"t2"}))
def test_inliers_scatter_about_the_truth_with_sigma_one(kind: str) -> None:
    noise = np.concatenate([_offsets(d)[d.inlier_mask] for d in (_draw(kind, index=i) for i in range(40))])
    # Rounding to 3 sigma adds 9/12 to the variance of 1.
    wanted = np.sqrt(1.75) if kind == "quantised3" else 1.0
    assert np.sqrt(np.mean(noise**2)) == pytest.approx(wanted, rel=0.1)


def test_the_trend_climbs_or_falls_at_most_forty_sigma() -> None:
    rises = [100.0 * _draw("uniform", index=i).truth_slope for i in range(300)]
    assert max(np.abs(rises)) <= 40.0
    assert min(rises) < -30.0
    assert max(rises) > 30.0


def test_one_gap_is_much_longer_than_the_others() -> None:
    gaps = np.diff(_draw("uniform", n=1000).t)
    assert gaps.max() == pytest.approx(15.0)
    assert np.sort(gaps)[-2] < 2.0


def test_uniform_outliers_stay_within_sixty_sigma() -> None:
    draw = _draw("uniform", n=1000)
    assert np.abs(_offsets(draw)[~draw.inlier_mask]).max() <= 60.0


def test_shifted_outliers_lie_on_one_side_at_least_four_sigma_away() -> None:
    draws = [_draw("shift", index=i) for i in range(20)]
    for draw in draws:
        away = _offsets(draw)[~draw.inlier_mask]
        assert np.all(np.sign(away) == np.sign(away[0]))
        assert np.abs(away).min() >= 4.0
    assert {float(np.sign(_offsets(d)[~d.inlier_mask][0])) for d in draws} == {-1.0, 1.0}


@pytest.mark.parametrize("share", [0.2, 0.4, 0.6, 0.8])
def test_bursts_are_at_most_three_runs(share: float) -> None:
    assert max(_outlier_runs(_draw("burst", share=share, index=i)) for i in range(50)) <= 3


def test_the_levels_of_bursts_are_their_own() -> None:
    for index in range(100):
        levels = np.sort(excursion_levels(3, np.random.default_rng(index), nearest=8.0, apart=15.0))
        assert np.abs(levels).min() >= 8.0
        assert np.abs(levels).max() <= 60.0
        assert np.diff(levels).min() >= 15.0


def test_a_single_burst_has_one_level_and_the_noise_of_an_inlier() -> None:
    draw = _draw("burst", n=3000, share=0.3)
    rows = np.flatnonzero(~draw.inlier_mask)
    longest = max(np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1), key=len)
    inside = _offsets(draw)[longest]
    assert np.std(inside) == pytest.approx(1.0, rel=0.15)
    assert 7.0 < abs(inside.mean()) < 61.0


def test_the_competing_line_has_sixty_percent_as_many_points_as_the_trend() -> None:
    draw = _draw("line2", n=1000, share=0.5)
    hit = ~draw.inlier_mask
    t, away = draw.t[hit], _offsets(draw)[hit]
    support = 0
    for first in range(0, t.size, 7):
        for second in range(first + 1, t.size, 11):
            if abs(t[second] - t[first]) < 40.0:
                continue
            slope = (away[second] - away[first]) / (t[second] - t[first])
            support = max(support, int(np.sum(np.abs(away - away[first] - slope * (t - t[first])) < 3.0)))
    assert 290 <= support <= 340


def test_the_competing_line_takes_all_outliers_when_they_are_few() -> None:
    draw = _draw("line2", n=1000, share=0.2)
    hit = ~draw.inlier_mask
    away = _offsets(draw)[hit]
    assert np.std(away - np.polyval(np.polyfit(draw.t[hit], away, 1), draw.t[hit])) == pytest.approx(
        1.0, rel=0.2
    )


def test_the_level_steps_at_forty_percent_of_span_and_points() -> None:
    draw = _draw("step", share=0.0)
    assert np.flatnonzero(~draw.inlier_mask).tolist() == list(range(80))
    assert draw.t[79] < 40.0 < draw.t[80]
    jump = _offsets(draw)[:80].mean()
    assert 7.0 < abs(jump) < 31.0


@pytest.mark.parametrize(("kind", "quantum"), [("quantised1", 1.0), ("quantised3", 3.0)])
def test_quantised_values_are_multiples_of_the_quantum(kind: str, quantum: float) -> None:
    assert np.all(np.mod(_draw(kind).y, quantum) == 0.0)


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.8])
def test_correlated_noise_has_its_lag_one_correlation_and_unit_variance(phi: float) -> None:
    noise = ar1_noise(20_000, phi, np.random.default_rng(11))
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(phi, abs=0.03)
    assert noise.std() == pytest.approx(1.0, abs=0.06)


def test_outliers_at_the_ends_leave_the_inliers_in_one_piece() -> None:
    for index in range(20):
        rows = np.flatnonzero(_draw("ends", index=index).inlier_mask)
        assert np.all(np.diff(rows) == 1)


def test_every_kind_belongs_to_the_bed_or_to_the_unseen_families_and_not_to_both() -> None:
    assert set(KINDS) | set(FAMILIES) == set(ALL_KINDS)
    assert not set(KINDS) & set(FAMILIES)
