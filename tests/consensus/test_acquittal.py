"""Contamination has to pay for itself."""

from __future__ import annotations

import numpy as np
import pytest

from estimators.arrays import FloatArray
from estimators.consensus.labelling.chance import gain_of_search
from estimators.consensus.structure.acquittal import acquit
from estimators.consensus.structure.criterion import CORRELATION_PRICE
from estimators.consensus.structure.mixture import CORRELATION, HELD_COUNT, INLIERS, LIKELIHOOD, SIZE, UNIFORM

N = 100


def _structure(gain: float, inliers: float = 60.0) -> tuple[FloatArray, FloatArray]:
    params, alone = np.full(SIZE, 0.5), np.full(SIZE, 0.25)
    params[INLIERS], params[CORRELATION], alone[CORRELATION] = inliers, 0.0, 0.0
    params[LIKELIHOOD], alone[LIKELIHOOD] = -50.0 + gain, -50.0
    return params, alone


def _price(inliers: float, coefficients: int = 2) -> float:
    return float(coefficients * (0.7 + 1.1 * (1.0 - inliers / N)) + 1.5 * np.log(N))


def test_a_structure_that_gains_less_than_its_price_is_clean_noise() -> None:
    params, alone = _structure(_price(60.0) - 0.01)
    assert acquit(params, alone, 2, N)
    assert (params[INLIERS], params[UNIFORM], params[HELD_COUNT]) == (N, 1.0, 0.0)
    assert params[LIKELIHOOD] == alone[LIKELIHOOD]


def test_a_structure_that_gains_more_stays_as_it_is() -> None:
    params, alone = _structure(_price(60.0) + 0.01)
    before = params.copy()
    assert not acquit(params, alone, 2, N)
    np.testing.assert_array_equal(params, before)


@pytest.mark.parametrize(("correlated", "sign"), [("params", 1.0), ("alone", -1.0)])
def test_correlated_neighbours_are_paid_for_by_whoever_uses_them(correlated: str, sign: float) -> None:
    for off, replaced in ((-0.01, True), (0.01, False)):
        params, alone = _structure(_price(60.0) + sign * CORRELATION_PRICE + off)
        (params if correlated == "params" else alone)[CORRELATION] = 0.4
        assert acquit(params, alone, 2, N) == replaced


def test_fewer_followers_and_more_coefficients_gain_more_by_having_been_searched_for() -> None:
    assert gain_of_search(2, 10.0, N) > gain_of_search(2, 50.0, N) > gain_of_search(2, N, N) > 0.0
    assert gain_of_search(4, 10.0, N) == 2.0 * gain_of_search(2, 10.0, N)
