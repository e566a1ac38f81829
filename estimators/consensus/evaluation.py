"""How the readable engine values models: chunk by chunk, with the sums of the compiled path."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numba import types

from estimators.arrays import BoolArray, FloatArray, IntArray
from estimators.consensus.protocols import Model, Score, Verifier
from estimators.consensus.scan import CHUNK, NOTHING, Value, score_chunk
from estimators.kernels import kernel


@kernel(
    types.void(
        types.int64,
        types.float64[:, ::1],
        types.float64,
        types.float64[::1],
        types.int64[::1],
        types.float64[::1],
    )
)
def score_rows(
    score: int, residual: FloatArray, T: float, loss: FloatArray, inliers: IntArray, squares: FloatArray
) -> None:
    """Entry to :func:`score_chunk` for several models; the residuals are overwritten."""
    for k in range(residual.shape[0]):
        part = score_chunk(score, residual[k], residual.shape[1], T)
        loss[k] = part.loss
        inliers[k] = part.inliers
        squares[k] = part.squares


class Values(NamedTuple):
    """Values of several models.

    Attributes
    ----------
    loss, squares : ndarray of float64, shape (m,)
    inliers : ndarray of int64, shape (m,)
    alive : ndarray of bool, shape (m,)
        False for models that the verifier refused.
    evaluations : int
        Residuals computed.
    """

    loss: FloatArray
    inliers: IntArray
    squares: FloatArray
    alive: BoolArray
    evaluations: int

    def at(self, k: int) -> Value:
        """Value of one model; that of nothing if it was refused."""
        if not self.alive[k]:
            return NOTHING
        return Value(float(self.loss[k]), int(self.inliers[k]), float(self.squares[k]))

    def best(self) -> int:
        """Index of the best model, the earliest among equals; -1 if none lives."""
        living = np.flatnonzero(self.alive).tolist()
        return min(living, key=lambda k: rank(self.at(k)), default=-1)


def rank(value: Value) -> tuple[float, int, float]:
    """Sort key of the tie rule: loss, then more inliers, then smaller squares (METHODS.md 13.7)."""
    return value.loss, -value.inliers, 1.0 + value.squares


@dataclass(frozen=True, slots=True)
class Evaluation:
    """One way of valuing models on one data set.

    Attributes
    ----------
    model : Model
    score : Score
    verifier : Verifier
    threshold : float
    """

    model: Model
    score: Score
    verifier: Verifier
    threshold: float

    def values(self, theta: FloatArray, best_loss: float = math.inf) -> Values:
        """Values of models of shape (m, p), refusing those that cannot come below ``best_loss``."""
        m = theta.shape[0]
        bound = self.verifier.bound(best_loss)
        loss, squares, inliers = np.zeros(m), np.zeros(m), np.zeros(m, dtype=np.int64)
        alive = np.ones(m, dtype=np.bool_)
        evaluations = 0
        for start in range(0, self.model.n, CHUNK):
            stop = min(start + CHUNK, self.model.n)
            living = np.flatnonzero(alive)
            part = np.empty(living.size), np.empty(living.size, dtype=np.int64), np.empty(living.size)
            residual = self.model.residuals(np.ascontiguousarray(theta[living]), start, stop)
            score_rows(self.score.code, residual, self.threshold, *part)
            loss[living] += part[0]
            inliers[living] += part[1]
            squares[living] += part[2]
            evaluations += int(living.size) * (stop - start)
            alive[living] = ~(loss[living] > bound)
        return Values(loss, inliers, squares, alive, evaluations)

    def value(self, theta: FloatArray) -> tuple[Value, int]:
        """Value of one model, on every point, and the residuals computed."""
        values = self.values(theta[None, :])
        return values.at(0), values.evaluations

    def members(self, theta: FloatArray, threshold: float) -> IntArray:
        """Points within a threshold, ascending."""
        residual = self.model.residuals(theta[None, :], 0, self.model.n)[0]
        return np.flatnonzero(np.abs(residual) <= threshold).astype(np.int64)
