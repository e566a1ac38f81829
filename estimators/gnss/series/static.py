"""A standing receiver: starts from single epochs, each improved on all of them, the likeliest wins.

The starts come from a bounded number of epochs, so that the time of a long series grows with one pass over it
per step and not with the number of starts (METHODS_GNSS: "epochs solved jointly break the snapshot limit").
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import FloatArray
from estimators.geodesy.ellipsoid import to_geodetic
from estimators.geodesy.local_frame import enu_axes
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.clocks import by_system, expect_clocks
from estimators.gnss.series.joint import Elsewhere, Joint
from estimators.gnss.series.observed import Observations
from estimators.gnss.series.snapshots import START_SCALE, Snapshots, count_clocks
from estimators.gnss.series.spread import lag_one, larger_axis, protection, tail, widening
from estimators.gnss.series.standing import climb
from estimators.gnss.series.subsets import starts_of_subsets
from estimators.gnss.snapshot.epochs import MOST_CLOCKS
from estimators.gnss.snapshot.solved import SCALE_SHAPE
from estimators.gnss.table import EpochTable

_STEPS = 12
_SAME_START_M = 2.0
"""Starts as close as this lead to the same place: open-sky fixes are as good."""
_SAME_PLACE_M = 0.5
_MOST_RIVALS = 4
_POOR_SCALE, _POOR_SHARE = 1.0, 0.35
"""Noise above the sigmas, or so many unexplained ranges: a sign that no start led to the right place."""
_NEGLIGIBLE = 1e-12


@dataclass(frozen=True, slots=True)
class Climbed:
    """A position improved on a table of epochs.

    Attributes
    ----------
    position_m : ndarray, shape (3,)
    N : ndarray, shape (3, 3)
        Covariance at unit scale.
    clock_m : ndarray, shape (epochs, MOST_CLOCKS)
    residual_m, healthy : ndarray, shape (rows,)
    likelihood, scale : float
    """

    position_m: FloatArray
    N: FloatArray
    clock_m: FloatArray
    residual_m: FloatArray
    healthy: FloatArray
    likelihood: float
    scale: float

    @property
    def weight(self) -> float:
        """Log likelihood with the volume of positions that share it (Laplace)."""
        sign, volume = np.linalg.slogdet(self.N)
        return self.likelihood + 0.5 * float(volume) + 3.0 * math.log(self.scale) if sign > 0 else -math.inf


def improve(
    table: EpochTable,
    start_m: FloatArray,
    fault_prior: float,
    steps: int = _STEPS,
    expected: tuple[FloatArray, float] | None = None,
    scale: float = START_SCALE,
) -> Climbed | None:
    """Climb from a start; None where the ranges do not determine the position.

    Parameters
    ----------
    table : EpochTable
    start_m : ndarray, shape (3,)
    fault_prior : float
    steps : int
    expected : tuple of ndarray, shape (epochs, MOST_CLOCKS), and float, optional
        Clocks that other epochs lead one to expect, and their spread in metres.
    scale : float
        Where the estimation of the noise starts.
    """
    rows = table.pseudoranges_m.size
    nowhere = np.full((len(table), MOST_CLOCKS), np.nan)
    clocks, spread = (nowhere, 1.0) if expected is None else expected
    position, N = np.array(start_m, dtype=np.float64), np.zeros((3, 3))
    clock_m, residual, healthy = nowhere.copy(), np.zeros(rows), np.zeros(rows)
    likelihood, scale = climb(
        table.satellites_m,
        table.pseudoranges_m,
        table.sigma_m,
        table.clock,
        table.offsets,
        count_clocks(table),
        table.rotated,
        fault_prior,
        scale,
        steps,
        clocks,
        spread,
        position,
        N,
        clock_m,
        residual,
        healthy,
    )
    if not (math.isfinite(likelihood) and np.isfinite(position).all()):
        return None
    return Climbed(position, N, clock_m, residual, healthy, likelihood, scale)


def _climb_all(table: EpochTable, starts: list[FloatArray], fault_prior: float) -> list[Climbed]:
    """Climb from every start; the likeliest first."""
    found = [climbed for start in starts if (climbed := improve(table, start, fault_prior)) is not None]
    found.sort(key=lambda climbed: -climbed.weight)
    return found


def _distinct(positions: FloatArray, apart_m: float) -> list[FloatArray]:
    """Positions without those close to one that came before."""
    kept: list[FloatArray] = []
    for position in positions:
        if np.isfinite(position).all() and all(np.linalg.norm(position - other) > apart_m for other in kept):
            kept.append(position)
    return kept


def stand(snapshots: Snapshots, options: PositionOptions) -> list[Climbed]:
    """Positions that the epochs of some snapshots can share, the likeliest first.

    Parameters
    ----------
    snapshots : Snapshots
    options : PositionOptions
    """
    table, prior = snapshots.table, options.fault_prior
    starts = np.concatenate([snapshots.position_m, snapshots.solved.rival_position_m])
    found = _climb_all(table, _distinct(starts, _SAME_START_M), prior)
    if not found or found[0].scale > _POOR_SCALE or float(np.mean(found[0].healthy < 0.5)) > _POOR_SHARE:
        found += _climb_all(table, starts_of_subsets(table, prior), prior)
        found.sort(key=lambda climbed: -climbed.weight)
    kept: list[Climbed] = []
    for climbed in found:
        if all(np.linalg.norm(climbed.position_m - other.position_m) > _SAME_PLACE_M for other in kept):
            kept.append(climbed)
    return kept


def solve_standing(
    observations: Observations, places: list[Climbed], options: PositionOptions
) -> Joint | None:
    """One position for all epochs.

    Parameters
    ----------
    observations : Observations
    places : list of Climbed
        Candidates, by some of the epochs.
    options : PositionOptions

    Returns
    -------
    Joint or None
        None where the ranges of all epochs together determine no position.
    """
    table, prior = observations.table, options.fault_prior
    first = _on_all(table, places, prior, None)
    if not first:
        return None
    modes = _on_all(table, first, prior, expect_clocks(observations, first[0].clock_m))
    best = modes[0]
    whitened = best.residual_m / table.sigma_m
    correlation = lag_one(whitened, best.healthy, observations.previous)
    epochs = max(1, int((np.diff(table.offsets) > 0).sum()))
    wider = widening(correlation, float(epochs))
    lat, lon, _ = to_geodetic(best.position_m).tolist()
    axes = enu_axes(lat, lon)
    shares = np.array([(mode.weight - best.weight) / wider for mode in modes])
    shares = np.exp(np.maximum(shares, math.log(_NEGLIGIBLE)))
    shares = (shares / shares.sum())[None, :]
    moved = np.array([axes @ (mode.position_m - best.position_m) for mode in modes])
    spreads = np.array([wider * mode.scale**2 * (axes @ mode.N @ axes.T) for mode in modes])
    across, up = larger_axis(spreads)[None, :], spreads[None, :, 2, 2]
    distance = np.hypot(moved[:, 0], moved[:, 1])[None, :]
    nu = max(2.0 * SCALE_SHAPE, 2.0 * SCALE_SHAPE + (float(best.healthy.sum()) - 3.0 - epochs) / wider)
    alert = np.array([options.alert_m])
    far = float(tail(alert, distance, across, nu, shares)[0])
    hpl = float(protection(options.integrity_risk, distance, across, nu, shares)[0])
    vpl = float(protection(options.integrity_risk, np.abs(moved[None, :, 2]), up, nu, shares)[0])
    rivals = tuple(
        Elsewhere(0, len(table) - 1, mode.position_m, float(distance[0, j]), float(shares[0, j]))
        for j, mode in enumerate(modes)
        if j > 0 and distance[0, j] > 0.5 * options.alert_m and shares[0, j] > 1e-9
    )

    def same(value: float) -> FloatArray:
        return np.full(len(table), value)

    return Joint(
        position_m=np.tile(best.position_m, (len(table), 1)),
        velocity_enu_mps=np.zeros((len(table), 3)),
        covariance_enu_m2=np.tile(spreads[0], (len(table), 1, 1)),
        clock_m=by_system(observations, best.clock_m),
        hpl_m=same(hpl),
        vpl_m=same(vpl),
        far_probability=same(far),
        solved=np.ones(len(table), dtype=np.bool_),
        residual_m=best.residual_m,
        healthy=best.healthy,
        sigma_scale=best.scale,
        correlation=correlation,
        rivals=rivals,
    )


def _on_all(
    table: EpochTable, places: list[Climbed], prior: float, expected: tuple[FloatArray, float] | None
) -> list[Climbed]:
    """Improve the likeliest places on all epochs; the likeliest first."""
    found = [
        climbed
        for place in places[:_MOST_RIVALS]
        if (climbed := improve(table, place.position_m, prior, _STEPS, expected, place.scale)) is not None
    ]
    found.sort(key=lambda climbed: -climbed.weight)
    kept: list[Climbed] = []
    for climbed in found:
        if all(np.linalg.norm(climbed.position_m - other.position_m) > _SAME_PLACE_M for other in kept):
            kept.append(climbed)
    return kept
