"""What a search by sampling found, before it is put into the terms of an answer."""

from __future__ import annotations

from dataclasses import dataclass

from estimators.arrays import BoolArray, FloatArray
from estimators.consensus.scan import Value
from estimators.result import Ledger


@dataclass(frozen=True, slots=True)
class Outcome:
    """Best model of a search.

    Attributes
    ----------
    theta : ndarray of float64, shape (p,)
    inlier : ndarray of bool, shape (n,)
    threshold : float
        As used: the wanted one, or what the arithmetic can tell from zero if that is larger.
    scatter : float
        Standard deviation of the inliers' whitened residuals, with n - p degrees of freedom; 0 without any.
    value : Value
        Of the final model under the truncated quadratic.
    ledger : Ledger
    sampling_probability : float
        1 - exp(log-probability that no draw was clean, for the inliers above); 1 if exhaustive.
    exhaustive : bool
    """

    theta: FloatArray
    inlier: BoolArray
    threshold: float
    scatter: float
    value: Value
    ledger: Ledger
    sampling_probability: float
    exhaustive: bool
