from __future__ import annotations

import itertools

import numpy as np
import pytest

from estimators.gnss.fix import Fix
from estimators.gnss.locate import locate
from estimators.gnss.snapshot.fault_sets import enumerated_size
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from examples import pseudoranges
from tests.gnss.fault_weights import weighed, weight_of
from tests.gnss.skies import Sky, make_sky
from tests.gnss.solving import problem_of

N, FAULTS = 13, 5


def agreeing(seed: int) -> Sky:
    """Thirteen satellites of which five agree about a place 60 m away."""
    sky = make_sky(N, seed)
    rng = np.random.default_rng(seed)
    rows = rng.choice(N, FAULTS, replace=False).tolist()
    away = rng.normal(size=3)
    elsewhere = sky.truth_m + sky.axes.T @ (60.0 / np.linalg.norm(away) * away)
    longer = np.linalg.norm(sky.satellites_m - elsewhere, axis=1) - np.linalg.norm(
        sky.satellites_m - sky.truth_m, axis=1
    )
    return sky.with_faults({row: float(longer[row]) for row in rows})


# Growing sets satellite by satellite does not lead to the best one of the first.
@pytest.mark.parametrize("seed", [10, 1])
def test_the_heaviest_set_is_found_where_not_all_can_be_weighed(seed: int) -> None:
    problem = problem_of(agreeing(seed))
    found = weighed(problem)
    assert enumerated_size(N, problem.freedom) < FAULTS
    heaviest = max(
        (members for size in range(8) for members in itertools.combinations(range(N), size)),
        key=lambda members: weight_of(problem, members),
    )
    assert max(found, key=found.__getitem__) == heaviest
    assert found[heaviest] - found[()] == pytest.approx(
        weight_of(problem, heaviest) - weight_of(problem, ()), abs=1e-6
    )


def test_satellites_that_agree_about_a_mirror_image_are_excluded_together() -> None:
    rows, reflected = pseudoranges.simulate()
    fix = locate(
        np.array([row[2:5] for row in rows]),
        np.array([row[5] for row in rows]),
        system=[row[1] for row in rows],
        satellite=[row[0] for row in rows],
    )
    assert isinstance(fix, Fix)
    assert list(fix.excluded) == reflected
    assert np.linalg.norm(fix.position_ecef_m - pseudoranges.truth_m()) < 5.0
    assert not fix.ambiguous


def test_sampled_sets_know_no_order_of_satellites_and_no_clock() -> None:
    lying = (1, 4, 7, 9, 12, 16)
    sky = make_sky(20, seed=5).with_faults(dict.fromkeys(lying, 60.0))
    fix = locate(sky.satellites_m, sky.ranges_m, sigma_m=sky.sigma_m, satellite=sky.names)
    shuffled = sky.taken(np.random.default_rng(1).permutation(20).tolist())
    late = shuffled.ranges_m + 0.5e-3 * SPEED_OF_LIGHT
    other = locate(shuffled.satellites_m, late, sigma_m=shuffled.sigma_m, satellite=shuffled.names)
    assert isinstance(fix, Fix)
    assert isinstance(other, Fix)
    assert np.linalg.norm(fix.position_ecef_m - other.position_ecef_m) < 1e-4
    assert fix.hpl_m == pytest.approx(other.hpl_m, rel=1e-4)
    assert set(fix.excluded) == {sky.names[row] for row in lying}
