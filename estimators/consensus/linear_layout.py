"""What the compiled path reads and writes besides the data: policies as numbers, records, working memory."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from estimators.arrays import FloatArray, IntArray
from estimators.consensus.optimizers.local import Bench
from estimators.consensus.optimizers.plan import Plan
from estimators.consensus.scan import CHUNK, Scan
from estimators.kernels import device

DRAWN, DEGENERATE, INVALID, SCORED, EVALUATIONS, OPTIMIZATIONS, INLIERS, EXHAUSTIVE, STATUS = range(9)
"""Columns of the counts of a series."""

LOSS, SQUARES, THRESHOLD, SCATTER, PROBABILITY = range(5)
"""Columns of the numbers of a series."""

NO_MODEL, FOUND, CANCELLED = range(3)
"""What the status of a series says."""


class Row(NamedTuple):
    """A row of policies as compiled code sees it.

    Attributes
    ----------
    sampler, score, bails_out, termination : int
        Codes.
    block : int
        Hypotheses between two looks at the best model.
    minimum, maximum : int
        Bounds on the number of draws.
    budget : int
        Residual evaluations that an enumeration may cost.
    acceptable : int
        Consensus at which ``FIRST_ACCEPTABLE`` stops; 0 for its own rule.
    confidence : float
    seed : int
    """

    sampler: int
    score: int
    bails_out: int
    termination: int
    block: int
    minimum: int
    maximum: int
    budget: int
    acceptable: int
    confidence: float
    seed: int


class Room(NamedTuple):
    """Memory of one search.

    Attributes
    ----------
    samples : ndarray of int64, shape (block, s)
    thetas : ndarray of float64, shape (block, p)
    trial : ndarray of float64, shape (p,)
    bench : Bench
    scan : Scan
    """

    samples: IntArray
    thetas: FloatArray
    trial: FloatArray
    bench: Bench
    scan: Scan


@device
def make_room(longest: int, p: int, block: int, plan: Plan) -> Room:
    """Memory for series of up to ``longest`` points."""
    models = max(block, plan.repetitions, 1)
    bench = Bench(
        np.empty(longest, np.int64),
        np.empty(longest, np.int64),
        np.empty(longest, np.int64),
        np.empty(max(plan.sample, plan.limit, p + 1), np.int64),
        np.empty((max(plan.repetitions, 1), p)),
        np.empty(p),
        np.empty((p, p + 1)),
    )
    scan = Scan(
        np.empty(models, np.uint8),
        np.empty(models),
        np.empty(models, np.int64),
        np.empty(models),
        np.empty(CHUNK),
    )
    return Room(np.empty((block, p), np.int64), np.empty((block, p)), np.empty(p), bench, scan)
