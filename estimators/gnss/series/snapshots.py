"""Epochs solved each on its own: where the joint solutions start, and what they are judged against."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.gnss.options import PositionOptions
from estimators.gnss.series.observed import Observations
from estimators.gnss.series.places import score_places
from estimators.gnss.snapshot.epochs import MOST_CLOCKS
from estimators.gnss.snapshot.one_epoch import SOLVED
from estimators.gnss.snapshot.solved import SCALE_RATE, SCALE_SHAPE, Solved, solve_epochs
from estimators.gnss.table import EpochTable

START_SCALE = 0.5
"""Noise in units of the sigmas of customary weight models (METHODS_GNSS, "Settings")."""


@dataclass(frozen=True, slots=True)
class Scores:
    """What the ranges of each epoch say to a place.

    Attributes
    ----------
    clock_m : ndarray, shape (epochs, MOST_CLOCKS)
        NaN where there are no ranges.
    likelihood : ndarray, shape (epochs,)
    residual_m, healthy : ndarray, shape (rows,)
    """

    clock_m: FloatArray
    likelihood: FloatArray
    residual_m: FloatArray
    healthy: FloatArray


@dataclass(frozen=True, slots=True)
class Snapshots:
    """Single-epoch answers.

    Attributes
    ----------
    epochs : ndarray of int64
        Those of the series that were solved.
    table : EpochTable
        Of these.
    solved : Solved
    position_m : ndarray, shape (m, 3)
    reliable : ndarray of bool, shape (m,)
        Whether no other fault set leads elsewhere.
    """

    epochs: IntArray
    table: EpochTable
    solved: Solved
    position_m: FloatArray
    reliable: BoolArray

    @property
    def scale(self) -> float:
        """Noise in units of the sigmas, by the ranges that the epochs used; as in a fix."""
        scores = score_at(self.table, self.position_m, START_SCALE, 0.1)
        used = ~self.solved.excluded
        z = scores.residual_m[used] / self.table.sigma_m[used]
        freedom = max(int(used.sum()) - sum(3 + len(x) for x in self.table.letters), 0)
        # Epochs that use no more satellites than they need say nothing of the noise.
        return math.sqrt((SCALE_RATE + 0.5 * float(z @ z)) / (SCALE_SHAPE + 0.5 * freedom - 1.0))


def count_clocks(table: EpochTable) -> IntArray:
    """Receiver clocks of each epoch."""
    return np.array([len(letters) for letters in table.letters], dtype=np.int64)


def solvable(observations: Observations) -> IntArray:
    """Epochs that have as many satellites as unknowns."""
    table = observations.table
    return np.flatnonzero(np.diff(table.offsets) >= 3 + count_clocks(table)).astype(np.int64)


def spread_evenly(epochs: IntArray, most: int) -> IntArray:
    """At most so many, evenly spaced."""
    if epochs.size <= most:
        return epochs
    return epochs[np.unique(np.linspace(0, epochs.size - 1, most).round().astype(np.int64))]


def take_snapshots(observations: Observations, epochs: IntArray, options: PositionOptions) -> Snapshots:
    """Solve some epochs each on its own.

    Parameters
    ----------
    observations : Observations
    epochs : ndarray of int64
    options : PositionOptions
    """
    table = observations.pick(epochs)
    solved = solve_epochs(table, options)
    good = np.flatnonzero((solved.status == SOLVED) & np.isfinite(solved.state[:, :3]).all(axis=1))
    if good.size < epochs.size:
        epochs = epochs[good]
        table = observations.pick(epochs)
        solved = solve_epochs(table, options)
    return Snapshots(
        epochs=epochs,
        table=table,
        solved=solved,
        position_m=np.ascontiguousarray(solved.state[:, :3]),
        reliable=solved.far_probability < options.ambiguity,
    )


def score_at(table: EpochTable, places_m: FloatArray, scale: float, fault_prior: float) -> Scores:
    """Score a place per epoch.

    Parameters
    ----------
    table : EpochTable
    places_m : ndarray, shape (epochs, 3) or (3,)
    scale, fault_prior : float
    """
    rows = table.pseudoranges_m.size
    scores = Scores(
        np.full((len(table), MOST_CLOCKS), np.nan), np.zeros(len(table)), np.zeros(rows), np.zeros(rows)
    )
    score_places(
        table.satellites_m,
        table.pseudoranges_m,
        table.sigma_m,
        table.clock,
        table.offsets,
        count_clocks(table),
        table.rotated,
        fault_prior,
        scale,
        np.ascontiguousarray(np.broadcast_to(places_m, (len(table), 3))),
        scores.clock_m,
        scores.likelihood,
        scores.residual_m,
        scores.healthy,
    )
    return scores
