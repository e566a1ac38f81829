from functools import partial

import numpy as np
import pytest

from benchmarks.bed import make_series
from benchmarks.cells import Cell, Outcomes, measure, measure_all, pool
from benchmarks.contenders import AUTO, Answer, Contender
from estimators.arrays import FloatArray

CELL = Cell("uniform", 50, 0.2, 6)


def _least_squares(t: FloatArray, y: FloatArray, _threshold: float | None) -> Answer:
    slope, intercept = np.polyfit(t, y, 1)
    return Answer(
        intercept + slope * t[[0, -1]], np.abs(y - intercept - slope * t) > 5.0, slope - 0.1, slope + 0.1
    )


def _gives_up(_t: FloatArray, _y: FloatArray, _threshold: float | None) -> Answer:
    raise ValueError("no consensus")


LEAST_SQUARES = Contender("least squares", False, _least_squares)


def _same(left: Outcomes, right: Outcomes) -> bool:
    return all(
        np.array_equal(getattr(left, name), getattr(right, name), equal_nan=True)
        for name in Outcomes.__dataclass_fields__
    )


def test_the_same_draws_are_measured_in_one_piece_or_in_several() -> None:
    whole = measure((LEAST_SQUARES,), CELL, seed=1)[0]
    parts = [measure((LEAST_SQUARES,), CELL._replace(draws=2), seed=1, first=first)[0] for first in (0, 2, 4)]
    assert _same(whole, pool(parts))


def test_the_number_of_processes_does_not_change_the_outcome() -> None:
    cells = [CELL, Cell("burst", 60, 0.4, 3)]
    alone = measure_all((AUTO,), cells, seed=1, jobs=1)
    together = measure_all((AUTO,), cells, seed=1, jobs=2)
    assert all(_same(alone[cell][0], together[cell][0]) for cell in cells)


def test_a_contender_that_gives_up_has_failed() -> None:
    outcome = measure((Contender("none", False, _gives_up),), CELL, seed=1)[0]
    assert outcome.fail_percent() == 100.0
    assert np.isnan(outcome.coverage())


def test_the_oracle_itself_never_fails_and_has_an_error_ratio_of_one() -> None:
    measured = measure((LEAST_SQUARES,), Cell("uniform", 50, 0.0, 20), seed=1)[0]
    assert measured.fail_percent() == 0.0
    assert measured.rms_over_oracle() == pytest.approx(1.0)


def test_a_threshold_is_given_only_to_those_who_ask_for_it() -> None:
    told: list[float | None] = []

    def listen(t: FloatArray, y: FloatArray, threshold: float | None) -> Answer:
        told.append(threshold)
        return _least_squares(t, y, threshold)

    draw = make_series("uniform", 20, 0.0, np.random.default_rng(0))
    for knows in (False, True):
        Contender("listener", knows, partial(listen)).fit(draw.t, draw.y, 2.0)
    assert told == [None, pytest.approx(5.4)]
