"""The verb :func:`locate`: from the pseudoranges of an epoch to a :class:`~estimators.gnss.fix.Fix`."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from estimators.arrays import ArrayLike, FloatArray, InputError, Reason, as_vector
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import azimuth_elevation, enu_axes
from estimators.gnss.finish import Ended, make_fix
from estimators.gnss.fix import Fix
from estimators.gnss.methods.registry import POSITION_METHODS
from estimators.gnss.methods.settling import judge_epoch
from estimators.gnss.observations import Observed, as_epoch
from estimators.gnss.options import PositionOptions
from estimators.gnss.rows import on_input_rows
from estimators.gnss.snapshot.one_epoch import SOLVED
from estimators.gnss.snapshot.problem import Problem, problem_at, solve_problem
from estimators.gnss.snapshot.solved import solve_epochs
from estimators.gnss.table import EpochTable
from estimators.gnss.weighting import elevation_sigma, strength_sigma
from estimators.result import NoFit, NoFitReason, Points

_DEEPEST_M, _HIGHEST_M = -20e3, 2000e3
"""Heights of receivers: from the deepest trench to low orbits."""


def locate(
    satellites_m: ArrayLike,
    pseudoranges_m: ArrayLike,
    *,
    sigma_m: ArrayLike | float | None = None,
    system: str | Sequence[str] | None = None,
    satellite: Sequence[str] | None = None,
    cn0_dbhz: ArrayLike | None = None,
    rotated: bool = True,
    method: str = "auto",
    options: PositionOptions | None = None,
) -> Fix | NoFit:
    """Find the position of a receiver, and the satellites whose ranges lie.

    Parameters
    ----------
    satellites_m : array_like, shape (n, 3)
        Satellite positions when they transmitted, Earth-centred and Earth-fixed, in metres.
    pseudoranges_m : array_like, shape (n,)
        Corrected for satellite clock, ionosphere and troposphere; NaN where missing.
    sigma_m : array_like, shape (n,), or float, optional
        Noise of each; a common factor is estimated. Default: by elevation, or by signal strength where
        ``cn0_dbhz`` is given.
    system : str or sequence of str, optional
        Letter or name of each satellite's system; the receiver has a clock for each. Default: one clock.
    satellite : sequence of str, optional
        Names for the answer.
    cn0_dbhz : array_like, shape (n,), optional
        Signal strength; used where ``sigma_m`` is not given.
    rotated : bool
        Whether satellite positions are in the frame of the time of reception (turned for the Earth's
        rotation during the signal's way), as tables of corrected pseudoranges have them. If not, they are
        turned here.
    method : str
        See :func:`estimators.position_methods`.
    options : PositionOptions, optional

    Returns
    -------
    Fix or NoFit
        ``NoFit`` (falsy) where the satellites do not determine a position.

    Raises
    ------
    InputError
        If the input cannot be an epoch: shapes, units, satellites that come twice.

    Notes
    -----
    An answer that says ``ambiguous`` should not be used without another source: see ``rival``.

    Examples
    --------
    >>> import numpy as np
    >>> from estimators.geodesy.ellipsoid import to_cartesian
    >>> here = to_cartesian(np.array([52.5, 13.4, 80.0]))
    >>> sky = [[60, 10], [20, -30], [48, 40], [75, 100], [30, 60], [52, -10], [40, 13], [65, -50]]
    >>> satellites = to_cartesian(np.array([[lat, lon, 20.2e6] for lat, lon in sky]))
    >>> ranges = np.linalg.norm(satellites - here, axis=1) + 1500.0
    >>> ranges[3] += 250.0
    >>> fix = locate(satellites, ranges, satellite=["G1", "G2", "G3", "G4", "G5", "G6", "G7", "G8"])
    >>> fix.excluded, bool(np.linalg.norm(fix.position_ecef_m - here) < 1e-3)
    (('G4',), True)
    """
    settings = PositionOptions() if options is None else options
    row = POSITION_METHODS.get(method)
    if row is None:
        raise InputError("method", f"must be one of: {', '.join(POSITION_METHODS)}")
    observed = as_epoch(satellites_m, pseudoranges_m, sigma_m, system, satellite, rotated)
    table, masked = observed.table, np.zeros(observed.rows.size, dtype=np.bool_)
    if sigma_m is None or settings.elevation_mask_deg is not None:
        elevation = _elevations(table)
        if elevation is not None:
            if sigma_m is None:
                table = _weighted(table, elevation, observed, cn0_dbhz)
            if settings.elevation_mask_deg is not None:
                masked = elevation < settings.elevation_mask_deg
    kept = table.without(masked)
    unknowns = 3 + len(kept.letters[0])
    if kept.pseudoranges_m.size < unknowns:
        return _no_fit(
            observed,
            NoFitReason.too_few_satellites,
            f"{kept.pseudoranges_m.size} usable satellites cannot determine {unknowns} unknowns, a position "
            f"and {unknowns - 3} clock(s); at least {unknowns} are needed",
        )
    verdict = None
    if row.detector is not None:
        start = solve_problem(kept)
        if start is None:
            return _undetermined(observed)
        verdict = judge_epoch(row.detector, start, settings)
    solved = solve_epochs(kept, settings, None if verdict is None else verdict.excluded)
    if solved.status[0] != SOLVED:
        return _undetermined(observed)
    used = ~solved.excluded
    problem: Problem | None
    if verdict is not None and verdict.inflation is not None:
        problem = solve_problem(dataclasses.replace(kept, sigma_m=kept.sigma_m * verdict.inflation), used)
    else:
        problem = problem_at(kept, np.ascontiguousarray(solved.state[0, :unknowns]), used)
    if problem is None:
        return _undetermined(observed)
    height = float(to_geodetic(np.ascontiguousarray(problem.state[:3]))[2])
    if not _DEEPEST_M < height < _HIGHEST_M:
        return _no_fit(
            observed,
            NoFitReason.implausible_position,
            f"the ranges meet {height / 1000.0:.0f} km above the ellipsoid, where no receiver is; check "
            "units, satellite clocks and the frame of the satellite positions",
        )
    return on_input_rows(make_fix(Ended(row.name, problem, solved, verdict, settings)), observed, masked)


def _elevations(table: EpochTable) -> FloatArray | None:
    """Elevations in degrees, as seen from the position that all satellites give."""
    problem = solve_problem(table)
    if problem is None:
        return None
    lat, lon, _ = to_geodetic(np.ascontiguousarray(problem.state[:3])).tolist()
    return azimuth_elevation((table.satellites_m - problem.state[:3]) @ enu_axes(lat, lon).T)[1]


def _weighted(
    table: EpochTable, elevation: FloatArray, observed: Observed, cn0_dbhz: ArrayLike | None
) -> EpochTable:
    if cn0_dbhz is None:
        letters = tuple(table.letters[0][j] for j in table.clock)
        return dataclasses.replace(table, sigma_m=elevation_sigma(elevation, letters))
    strength = as_vector(cn0_dbhz, "cn0_dbhz")
    if strength.size != observed.missing.size:
        raise InputError("cn0_dbhz", f"expected one per pseudorange, {observed.missing.size}")
    known = strength[observed.rows]
    if not np.isfinite(known).all() or np.any((known < 0.0) | (known > 80.0)):
        raise InputError("cn0_dbhz", "must lie between 0 and 80 dB-Hz wherever there is a pseudorange")
    return dataclasses.replace(table, sigma_m=strength_sigma(known, elevation))


def _undetermined(observed: Observed) -> NoFit:
    return _no_fit(
        observed,
        NoFitReason.undetermined_geometry,
        "the directions to the satellites do not determine position and clocks; send satellites "
        "that are spread over the sky, and more than one per system",
    )


def _no_fit(observed: Observed, reason: NoFitReason, message: str) -> NoFit:
    n = observed.missing.size
    codes = np.where(observed.missing, Reason.missing, Reason.ok).astype(np.uint8)
    points = Points(np.zeros(n, dtype=np.bool_), np.full(n, np.nan), np.full(n, np.nan), codes)
    return NoFit(reason, message, points)
