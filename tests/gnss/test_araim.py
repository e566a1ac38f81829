"""Solution separation: what it bounds, what it excludes, and the faults that it watches."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.special import ndtr

from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.methods.araim import Araim
from estimators.gnss.methods.fault_modes import list_fault_modes
from estimators.gnss.methods.separation import protection_levels, separate
from estimators.gnss.snapshot.problem import solve_problem
from tests.gnss.skies import make_sky
from tests.gnss.solving import OPTIONS, located, problem_of


def test_the_protection_level_of_an_axis_holds_the_risk_it_was_given() -> None:
    problem = problem_of(make_sky(10, 3))
    present = np.ones(10, dtype=np.bool_)
    modes = list_fault_modes(present, problem.table.clock, 1e-5, 1e-4, 1e-5)
    found = separate(problem, enu_axes(0.0, 0.0), present, modes, 0.75, 1e-3)
    assert found is not None
    _, level = protection_levels(found, 1e-5)

    def tail(x: np.ndarray) -> np.ndarray:
        return np.asarray(ndtr(-x))

    risk = 2 * tail((level - found.bias[0, 2]) / found.sigma[0, 2]) + np.sum(
        1e-5 * tail((level - found.threshold[:, 2] - found.bias[1:, 2]) / found.sigma[1:, 2])
    )
    assert float(risk) == pytest.approx(0.5e-5 * (1 - modes.unmonitored / 1e-5), rel=1e-6)


def test_separations_are_those_of_solutions_without_the_satellite() -> None:
    problem = problem_of(make_sky(9, 1).with_faults({4: 50.0}))
    present = np.ones(9, dtype=np.bool_)
    modes = list_fault_modes(present, problem.table.clock, 1e-5, 1e-4, 1e-5)
    axes = enu_axes(10.0, 20.0)
    found = separate(problem, axes, present, modes, 0.75, 1e-3)
    assert found is not None
    for row in range(9):
        kept = ~found.modes.faulty[row]
        state, *_ = np.linalg.lstsq(problem.A[kept], problem.z[kept], rcond=None)
        np.testing.assert_allclose(found.distance[row], np.abs(axes @ state[:3]), atol=1e-6)


def test_araim_answers_with_protection_levels_of_its_own() -> None:
    sky = make_sky(10, 3)
    fix, auto = located(sky, "araim"), located(sky, "auto")
    assert fix.integrity.method == "solution-separation"
    assert auto.integrity.method == "posterior"
    assert fix.integrity.fault_prior == OPTIONS.satellite_fault
    assert (
        located(sky, "araim", integrity_risk=1e-7).hpl_m
        > fix.hpl_m
        > located(sky, "araim", nominal_bias_m=0.0).hpl_m
    )


def test_araim_bounds_nothing_where_a_fault_cannot_be_watched() -> None:
    assert np.isinf(located(make_sky(4, 3), "araim").hpl_m)


def test_more_faults_are_watched_where_they_are_likelier() -> None:
    present, clock = np.ones(10, dtype=np.bool_), np.zeros(10, dtype=np.int64)
    rare = list_fault_modes(present, clock, 1e-5, 1e-4, 1e-5)
    common = list_fault_modes(present, clock, 1e-2, 1e-4, 1e-5)
    assert rare.faulty.sum(axis=1).max() == 1
    assert common.faulty.sum(axis=1).max() > 2
    assert common.unmonitored <= 1e-6


def test_araim_excludes_a_constellation_that_lies_as_one() -> None:
    sky = make_sky(18, 7)
    elsewhere = sky.truth_m + 400.0 * sky.axes[0]
    lies = np.linalg.norm(sky.satellites_m - elsewhere, axis=1) - np.linalg.norm(
        sky.satellites_m - sky.truth_m, axis=1
    )
    system = ["G"] * 12 + ["E"] * 6
    faulty = dataclasses.replace(sky, ranges_m=sky.ranges_m + np.where(np.arange(18) < 12, 0.0, lies))
    problem = problem_of(faulty, system)
    verdict = Araim().judge(problem, OPTIONS)
    assert not verdict.excluded[:12].any()
    assert int(verdict.excluded[12:].sum()) >= 4
    # Whoever stays sets the constellation's clock and hardly moves the position.
    kept = solve_problem(problem.table, ~verdict.excluded)
    assert kept is not None
    assert np.linalg.norm(problem.state[:3] - sky.truth_m) > 50.0
    assert np.linalg.norm(kept.state[:3] - sky.truth_m) < 10.0
