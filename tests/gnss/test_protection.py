"""Protection levels: where they hold, where nothing bounds the error, and how both are told."""

from __future__ import annotations

import json

import numpy as np
import pytest

from benchmarks.positions.answers import horizontal_error
from benchmarks.positions.faults import inject
from benchmarks.positions.sky import STATIONS, Sky, as_table, read_station, simulate_sky
from estimators import NoticeCode, PositionOptions
from estimators.gnss.snapshot.one_epoch import SOLVED
from estimators.gnss.snapshot.solved import solve_epochs
from tests.gnss.skies import make_sky
from tests.gnss.solving import located


def of_size(n: int, count: int, noise: float) -> list[Sky]:
    """Random parts of simulated skies."""
    rng = np.random.default_rng((n, count))
    found: list[Sky] = []
    while len(found) < count:
        sky = simulate_sky(rng, float(rng.uniform(0.0, 80.0)), noise)
        if len(sky.name) >= n:
            rows = np.sort(rng.choice(len(sky.name), n, replace=False))
            found.append(
                Sky(
                    sky.time_s,
                    tuple(sky.name[row] for row in rows),
                    tuple(sky.system[row] for row in rows),
                    np.ascontiguousarray(sky.satellites_m[rows]),
                    sky.ranges_m[rows],
                    sky.sigma_m[rows],
                    sky.raw_m[rows],
                    sky.truth_m,
                )
            )
    return found


@pytest.mark.parametrize("n", [4, 5, 6, 7, 8])
@pytest.mark.parametrize("faults", [0, 1, 2])
def test_errors_of_sparse_skies_stay_within_their_levels(n: int, faults: int) -> None:
    rng = np.random.default_rng(faults)
    given = [inject(sky, faults, "20-2000", rng) for sky in of_size(n, 300, 0.6)]
    table, options = as_table([one.sky for one in given]), PositionOptions()
    solved = solve_epochs(table, options)
    beyond = [
        horizontal_error(solved.state[k, :3], one.sky.truth_m) > solved.hpl_m[k]
        for k, one in enumerate(given)
        if solved.status[k] == SOLVED and (faults == 0 or solved.far_probability[k] < options.ambiguity)
    ]
    # One in a thousand is promised; two of 300 would be seven times that.
    assert sum(beyond) <= 1


@pytest.mark.parametrize("n", [4, 5])
def test_where_a_second_fault_would_pass_nothing_bounds_the_error(n: int) -> None:
    fix = located(make_sky(n, 1), "auto")
    assert np.isinf(fix.hpl_m)
    assert np.isinf(fix.vpl_m)
    assert NoticeCode.unbounded_error in [item.code for item in fix.notices]
    assert "none" in fix.summary()


def test_a_level_that_is_infinite_is_null_on_the_wire() -> None:
    for method in ("auto", "araim"):
        fix = located(make_sky(4, 3), method)
        answer = json.loads(json.dumps(fix.to_dict(), allow_nan=False))
        feature = json.loads(json.dumps(fix.to_geojson(), allow_nan=False))
        assert answer["integrity"]["hpl_m"] is None
        assert answer["integrity"]["vpl_m"] is None
        assert feature["properties"]["hpl_m"] is None


def test_a_risk_that_covers_the_unseen_faults_gives_a_level() -> None:
    sky = make_sky(6, 3)
    assert np.isinf(located(sky, "auto", integrity_risk=1e-9).hpl_m)
    assert np.isfinite(located(sky, "auto", integrity_risk=0.05).hpl_m)


def test_levels_grow_as_the_risk_shrinks() -> None:
    sky = make_sky(12, 5).with_faults({3: 200.0})
    levels = [located(sky, "auto", integrity_risk=risk).hpl_m for risk in (1e-2, 1e-3, 1e-5)]
    assert levels == sorted(levels)
    assert levels[0] < levels[-1] < np.inf


def test_levels_under_an_open_sky_are_small_and_hold(gnss_data) -> None:
    skies = read_station(STATIONS[0], gnss_data)
    solved = solve_epochs(as_table(skies), PositionOptions())
    errors = np.array([horizontal_error(solved.state[k, :3], sky.truth_m) for k, sky in enumerate(skies)])
    assert np.all(errors <= solved.hpl_m)
    assert np.median(solved.hpl_m) < 10.0
