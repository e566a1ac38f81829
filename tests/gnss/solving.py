"""Skies handed to the solver and to methods of fault exclusion."""

from __future__ import annotations

import numpy as np
from scipy.special import chdtri

from estimators import Fix, PositionOptions, locate
from estimators.gnss.observations import as_epoch
from estimators.gnss.snapshot.problem import Problem, solve_problem
from tests.gnss.skies import Sky

OPTIONS = PositionOptions()


def problem_of(sky: Sky, system: list[str] | None = None) -> Problem:
    epoch = as_epoch(sky.satellites_m, sky.ranges_m, sky.sigma_m, system, sky.names, rotated=True)
    solved = solve_problem(epoch.table)
    assert solved is not None
    return solved


def squares_of(problem: Problem, kept: np.ndarray) -> float:
    """Sum of squares of least squares over some satellites, solved anew."""
    state, *_ = np.linalg.lstsq(problem.A[kept], problem.z[kept], rcond=None)
    return float(np.sum((problem.z[kept] - problem.A[kept] @ state) ** 2))


def limit(freedom: int) -> float:
    return float(chdtri(freedom, OPTIONS.false_alarm))


def located(sky: Sky, method: str, **options: object) -> Fix:
    found = locate(
        sky.satellites_m,
        sky.ranges_m,
        sigma_m=sky.sigma_m,
        satellite=sky.names,
        method=method,
        options=PositionOptions(**options),  # type: ignore[arg-type]
    )
    assert isinstance(found, Fix)
    return found
