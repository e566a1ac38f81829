"""The posterior over fault sets: weights as the formula says, sets that nothing can judge, small faults."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from estimators import PositionOptions
from estimators.gnss.snapshot.untested import untested_weight
from tests.gnss.fault_weights import PRIOR, weighed, weight_of
from tests.gnss.skies import make_sky
from tests.gnss.solving import located, problem_of


@pytest.mark.parametrize("n", [5, 7, 9])
def test_every_set_that_can_be_judged_weighs_what_dense_algebra_says(n: int) -> None:
    problem = problem_of(make_sky(n, 2).with_faults({1: 120.0, 3: -60.0}))
    found = weighed(problem)
    sets = [F for size in range(n - 3) for F in itertools.combinations(range(n), size)]
    assert set(found) == set(sets)
    empty = weight_of(problem, ())
    for members in sets:
        assert found[members] - found[()] == pytest.approx(weight_of(problem, members) - empty, abs=1e-7)


def test_a_beam_finds_the_faults_of_thirty_satellites_at_the_weight_they_have() -> None:
    rows = (1, 4, 8, 13, 17, 20, 26)
    problem = problem_of(make_sky(30, 1).with_faults({row: 90.0 + 10.0 * row for row in rows}))
    found = weighed(problem)
    best = max(found, key=found.__getitem__)
    assert best == rows
    assert found[best] - found[()] == pytest.approx(
        weight_of(problem, best) - weight_of(problem, ()), abs=1e-6
    )


@pytest.mark.parametrize("seed", range(20))
def test_what_no_range_can_judge_weighs_about_what_dense_algebra_says(seed: int) -> None:
    n, faults = 4 + seed % 5, seed % 4
    rng = np.random.default_rng(seed)
    sky = make_sky(n, seed).with_faults(
        {int(row): float(rng.uniform(50, 1000)) for row in rng.choice(n, min(faults, n - 4), replace=False)}
    )
    problem = problem_of(sky)
    found = weighed(problem)
    sizes = np.array([len(members) for members in found])
    weights = np.array(list(found.values()))
    largest = float(weights.max())
    held = untested_weight(n, problem.freedom, PRIOR, sizes, weights, sizes.size, largest)
    shift = weight_of(problem, ()) - found[()]
    exact = sum(
        math.exp(weight_of(problem, members) - shift - largest)
        for size in range(problem.freedom + 1, n + 1)
        for members in itertools.combinations(range(n), size)
    )
    assert 0.4 * exact <= held <= 20.0 * exact


def test_many_satellites_betray_a_fault_that_chi_square_lets_pass() -> None:
    sky = make_sky(30, 4, noise=0.3).with_faults({6: 15.0})
    fix = located(sky, "auto")
    healthy = located(make_sky(30, 4, noise=0.3), "auto")
    assert located(sky, "ols").global_test.p_value > 1e-3
    assert fix.excluded == ("G07",)
    assert healthy.excluded == ()


def test_a_higher_mean_of_faults_makes_every_satellite_likelier_to_be_faulty() -> None:
    sky = make_sky(8, 3)
    low = located(sky, "auto", fault_prior=0.05).satellites.fault_probability
    high = located(sky, "auto", fault_prior=0.2).satellites.fault_probability
    assert np.all(high > low)
    assert PositionOptions().fault_prior == PRIOR
