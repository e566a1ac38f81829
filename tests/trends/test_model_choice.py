"""``model="auto"``: the shape told from the data, with the evidence for each."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from estimators import InputError, NoFit, Trend, fit_trend
from estimators.arrays import FloatArray

T = np.linspace(0.0, 100.0, 150)
SHAPES = {
    "constant": np.full(150, 5.0),
    "line": 5.0 + 0.2 * T,
    "linear": 5.0 + 0.1 * T + 0.01 * (T - 50.0) ** 2,
    "exponential": 2.0 * np.exp(0.035 * T),
}


def contaminated(truth: FloatArray, seed: int, *, multiplicative: bool = False) -> FloatArray:
    rng = np.random.default_rng([seed, 4])
    noise = rng.normal(size=truth.size)
    y = truth * np.exp(0.1 * noise) if multiplicative else truth + noise
    outlier = rng.permutation(truth.size)[: truth.size // 4]
    y[outlier] += rng.uniform(-60.0, 60.0, outlier.size)
    return y


def chosen(y: FloatArray, **arguments: object) -> Trend:
    trend = fit_trend(T, y, model="auto", **arguments)  # type: ignore[arg-type]
    assert isinstance(trend, Trend)
    return trend


@pytest.mark.parametrize("shape", list(SHAPES))
def test_the_true_shape_is_told_from_contaminated_data(shape: str) -> None:
    told = [chosen(contaminated(SHAPES[shape], seed)).model for seed in range(6)]
    assert told.count(shape) >= 5


def test_a_clean_level_is_hardly_ever_called_a_trend() -> None:
    for n in (30, 120):
        t = np.arange(float(n))
        levels = [np.random.default_rng([seed, n]).normal(size=n) for seed in range(40)]
        told = [fit_trend(t, y, model="auto") for y in levels]
        assert sum(trend.model != "constant" for trend in told if isinstance(trend, Trend)) <= 3


def test_growth_with_noise_that_grows_along_is_an_exponential() -> None:
    growth = 5.0 * np.exp(0.02 * T)
    trend = chosen(contaminated(growth, 1, multiplicative=True))
    assert trend.model == "exponential"


def test_the_evidence_names_every_candidate_and_marks_the_one_chosen() -> None:
    trend = chosen(contaminated(SHAPES["line"], 0))
    assert {row.model for row in trend.evidence} == {"constant", "line", "linear", "exponential"}
    assert [row.chosen for row in trend.evidence] == [True, False, False, False]
    assert trend.evidence[0].model == trend.model
    assert trend.evidence[0].margin == 0.0
    margins = [row.margin for row in trend.evidence]
    assert margins == sorted(margins)
    assert [row.degree for row in trend.evidence if row.model == "linear"] == [2]


def test_the_answer_is_that_of_the_shape_chosen() -> None:
    y = contaminated(SHAPES["line"], 0)
    auto, line = chosen(y, predict=[120.0]), fit_trend(T, y, predict=[120.0])
    assert isinstance(line, Trend)
    told, asked = auto.to_dict(), line.to_dict()
    assert told.pop("evidence")
    assert told == asked


def test_the_summary_says_how_the_shape_was_chosen() -> None:
    assert "line, told from the data" in chosen(contaminated(SHAPES["line"], 0)).summary()


def test_seasons_are_part_of_every_candidate_and_an_exponential_has_none() -> None:
    y = contaminated(SHAPES["line"] + 4.0 * np.sin(T), 2)
    for seasonal in (2.0 * np.pi, "auto"):
        trend = chosen(y, seasonal=seasonal)
        assert trend.model == "line"
        assert {row.model for row in trend.evidence} == {"constant", "line", "linear"}
        assert trend.seasons[0].period == pytest.approx(2.0 * np.pi, rel=0.01)
        assert trend.seasons[0].chosen is (seasonal == "auto")


def test_the_choice_does_not_depend_on_the_unit_of_the_values() -> None:
    y = contaminated(SHAPES["linear"], 3)
    one, other = chosen(y), chosen(y * 1e-9)
    assert other.model == one.model
    assert [row.margin for row in other.evidence] == pytest.approx(
        [row.margin for row in one.evidence], abs=1.0
    )


def test_values_that_are_all_equal_are_a_level() -> None:
    assert chosen(np.full(150, 3.0)).model == "constant"


def test_negative_values_can_be_weighed() -> None:
    assert chosen(contaminated(-SHAPES["line"], 5)).model == "line"


def test_one_point_is_a_level_and_none_is_no_fit() -> None:
    assert isinstance(fit_trend([1.0], [np.nan], model="auto"), NoFit)
    one = fit_trend([1.0], [2.0], model="auto")
    assert isinstance(one, Trend)
    assert one.model == "constant"


def test_what_only_one_shape_takes_is_refused() -> None:
    with pytest.raises(InputError, match="no meaning for the model auto"):
        chosen(T, degree=3)


def test_three_readings_far_apart_overflow_nothing() -> None:
    assert fit_trend(np.array([1.0, 1026.0, 0.0]), np.array([2.0, 0.0, 1.0]), model="auto")


def test_readings_far_below_an_exponential_divide_to_no_zero() -> None:
    y = np.array([1.0689072e-58, 1.0, 0.0, 0.0, 0.0, 1.892320036e-92])
    assert fit_trend(np.arange(6.0), y, model="auto")


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(-1e60, 1e60), min_size=2, max_size=6))
def test_no_reading_however_small_breaks_the_choice(values: list[float]) -> None:
    assert fit_trend(np.arange(float(len(values))), np.array(values), model="auto") is not None
