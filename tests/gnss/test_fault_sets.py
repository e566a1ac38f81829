from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from estimators.arrays import FloatArray
from estimators.gnss.fix import Fix
from estimators.gnss.locate import locate
from estimators.gnss.snapshot.fault_sets import CAPACITY, enumerated_size, weigh_fault_sets
from estimators.gnss.snapshot.fault_weight import BIASES_M, LARGEST_SET
from estimators.gnss.snapshot.linearise import SPEED_OF_LIGHT
from examples import pseudoranges
from tests.gnss.skies import Sky, make_sky

PRIOR, SHAPE, RATE = 0.1, 3.0, 0.5


def weigh_all(A: FloatArray, sigma: FloatArray, y: FloatArray) -> list[tuple[float, tuple[int, ...]]]:
    """Weights of every set the data can judge, by the equation as it is written down."""
    n, p = A.shape
    S = np.eye(n) - A @ np.linalg.pinv(A)
    z = S @ y
    weighed = []
    for size in range(n - p + 1):
        for chosen in itertools.combinations(range(n), size):
            rows = list(chosen)
            terms = []
            for bias in BIASES_M if size else BIASES_M[:1]:
                inner = S[np.ix_(rows, rows)] + np.diag((sigma[rows] / bias) ** 2)
                if size and np.linalg.det(S[np.ix_(rows, rows)]) < 1e-9:
                    continue
                left = z @ z - z[rows] @ np.linalg.solve(inner, z[rows])
                terms.append(
                    -0.5 * np.linalg.slogdet(inner)[1]
                    - np.log(bias / sigma[rows]).sum()
                    - (SHAPE + 0.5 * (n - p)) * math.log1p(left / (2 * RATE))
                )
            if terms:
                prior = size * math.log(PRIOR) + (n - size) * math.log(1 - PRIOR)
                mean = np.log(np.mean(np.exp(np.array(terms) - max(terms)))) + max(terms)
                weighed.append((float(prior + mean), chosen))
    return sorted(weighed, reverse=True)


def design_of(sky: Sky) -> FloatArray:
    """Whitened design at the truth, one clock."""
    line = sky.satellites_m - sky.truth_m
    unit = line / np.linalg.norm(line, axis=1)[:, None]
    return np.column_stack([-unit, np.ones(len(unit))]) / sky.sigma_m[:, None]


# Growing sets satellite by satellite does not lead to the best set of the last case.
@pytest.mark.parametrize(("n", "seed", "agreeing"), [(13, 1, False), (13, 2, True), (14, 34, True)])
def test_the_heaviest_sets_are_found_where_not_all_can_be_weighed(n: int, seed: int, agreeing: bool) -> None:
    sky = make_sky(n, seed)
    A = design_of(sky)
    rng = np.random.default_rng(seed)
    rows = rng.choice(n, 5, replace=False)
    elsewhere = rng.normal(size=3)
    elsewhere *= 40.0 / np.linalg.norm(elsewhere)
    bias = A @ np.append(elsewhere, 0.0) if agreeing else rng.uniform(-80, 80, n) / sky.sigma_m
    y = 0.4 * rng.standard_normal(n)
    y[rows] += bias[rows]
    S = np.eye(n) - A @ np.linalg.pinv(A)
    members = np.empty((CAPACITY, LARGEST_SET), np.int64)
    sizes, weights = np.empty(CAPACITY, np.int64), np.empty(CAPACITY)
    found = weigh_fault_sets(
        A, S, S @ y, sky.sigma_m, np.zeros(n, np.int64), np.argsort(sky.ranges_m), n - 4, True,
        PRIOR, SHAPE, RATE, members, sizes, weights,
    )  # fmt: skip
    assert enumerated_size(n, n - 4) < 5
    sets = {tuple(members[k, : sizes[k]].tolist()): float(weights[k]) for k in range(found)}
    assert len(sets) == found
    best, *others = weigh_all(A, sky.sigma_m, y)[:4]
    for weight, chosen in [best, *[other for other in others if other[0] > best[0] - 3.0]]:
        assert sets[chosen] == pytest.approx(weight, abs=1e-6)
    assert max(sets.values()) == pytest.approx(best[0], abs=1e-6)


def test_satellites_that_agree_about_a_mirror_image_are_excluded_together() -> None:
    rows, reflected = pseudoranges.simulate()
    fix = locate(
        np.array([row[2:5] for row in rows]),
        np.array([row[5] for row in rows]),
        system=[row[1] for row in rows],
        satellite=[row[0] for row in rows],
    )
    assert isinstance(fix, Fix)
    inner = fix.satellites
    assert [name for name, status in zip(inner.name, inner.status, strict=True) if status == "excluded"] == (
        reflected
    )
    assert np.linalg.norm(fix.position_ecef_m - pseudoranges.truth_m()) < 5.0
    assert not fix.ambiguous


def test_sampled_sets_know_no_order_of_satellites_and_no_clock() -> None:
    sky = make_sky(20, seed=5).with_faults(dict.fromkeys((1, 4, 7, 9, 12, 16), 60.0))
    fix = locate(sky.satellites_m, sky.ranges_m, sigma_m=sky.sigma_m, satellite=sky.names)
    shuffled = sky.taken(np.random.default_rng(1).permutation(20).tolist())
    late = shuffled.ranges_m + 0.5e-3 * SPEED_OF_LIGHT
    other = locate(shuffled.satellites_m, late, sigma_m=shuffled.sigma_m, satellite=shuffled.names)
    assert isinstance(fix, Fix)
    assert isinstance(other, Fix)
    assert np.linalg.norm(fix.position_ecef_m - other.position_ecef_m) < 1e-4
    assert fix.hpl_m == pytest.approx(other.hpl_m, rel=1e-4)
    excluded = {
        name
        for name, status in zip(fix.satellites.name, fix.satellites.status, strict=True)
        if status == "excluded"
    }
    assert excluded == {sky.names[row] for row in (1, 4, 7, 9, 12, 16)}
